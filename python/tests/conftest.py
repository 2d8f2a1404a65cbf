# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest

import partpose
from partpose.core import TriangleMesh

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def recognizer(tmp_path_factory: pytest.TempPathFactory) -> partpose.Recognizer:
    """Of two parts, so that its catalogue takes seconds."""
    files = [ROOT / "parts" / f"{name}.stl" for name in ("bracket", "flange")]
    return partpose.Recognizer.from_files(files, cache_folder=tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="session")
def bracket_scene() -> partpose.io.Scene:
    return partpose.read_scene(ROOT / "scenes" / "bracket.png")


@pytest.fixture
def box() -> TriangleMesh:
    """10 x 20 x 40 mm about the origin."""
    x, y, z = 5.0, 10.0, 20.0
    vertices = np.array([[i, j, k] for i in (-x, x) for j in (-y, y) for k in (-z, z)], np.float32)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return TriangleMesh(vertices, np.array(triangles, np.int32))


def pose(x: float = 0, y: float = 0, z: float = 0) -> np.ndarray:
    out = np.eye(4)
    out[:3, 3] = x, y, z
    return out
