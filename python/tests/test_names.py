# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Each public name is used in a test, and the committed stubs are those of the code."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

import partpose

ROOMS = [
    "core", "geometry", "io", "camera", "preprocess", "descriptor", "matching", "registration", "verification",
    "dataset", "pipeline", "synthesis", "evaluation",
]  # fmt: skip


def test_each_name_is_used_in_a_test() -> None:
    files = [f for f in Path(__file__).parent.glob("test_*.py") if f.name != "test_names.py"]
    words = set(re.findall(r"\w+", "\n".join(f.read_text() for f in files)))
    missing = []
    for room in ROOMS:
        module = getattr(partpose, room)
        for name, value in vars(module).items():
            if name.startswith("_"):
                continue
            missing += [f"{room}.{name}"] * (name not in words)
            if isinstance(value, type):
                described = "to_dict" in vars(value)  # their fields are walked through in test_options.py
                for member in vars(value):
                    if not member.startswith("_") and not described and member not in words:
                        missing.append(f"{room}.{name}.{member}")
    assert missing == []


def test_each_name_has_documentation_and_a_home() -> None:
    for room in ROOMS:
        module = getattr(partpose, room)
        for name, value in vars(module).items():
            if isinstance(value, type) and not name.startswith("_"):
                assert value.__doc__, name
                assert value.__module__ == f"partpose.{room}", name


def test_stubs_are_those_of_the_code(root: Path, tmp_path: Path) -> None:
    if importlib.util.find_spec("nanobind") is None:
        pytest.skip("needs nanobind's stubgen")
    subprocess.run(["bash", root / "script" / "make_stubs", sys.executable, tmp_path], check=True)
    for room in ROOMS:
        committed = (root / "python" / "partpose" / f"{room}.pyi").read_text()
        assert (tmp_path / f"{room}.pyi").read_text() == committed, f"{room}.pyi: run script/make_stubs"
