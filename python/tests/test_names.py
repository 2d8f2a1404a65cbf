# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Each public name has documentation and is used in a test, and the committed stubs are those of the code."""

import importlib
import importlib.util
import inspect
import pkgutil
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import partpose

BOUND = [
    "core", "geometry", "io", "camera", "preprocess", "descriptor", "matching", "registration", "verification",
    "dataset", "pipeline", "engine", "synthesis", "evaluation", "report",
]  # fmt: skip
WRITTEN = ["sources", "solution", "live"]


def public_names() -> Iterator[tuple[str, Any]]:
    """`room.name` and `room.Class.member` with what they are."""
    for room in BOUND + WRITTEN:
        module = importlib.import_module(f"partpose.{room}")
        own = getattr(module, "__all__", [n for n in dir(module) if not n.startswith("_")])
        for name in own:
            value = getattr(module, name)
            yield f"{room}.{name}", value
            if inspect.isclass(value) and not issubclass(value, Exception):
                # The fields of bound structs are walked through in test_options.py.
                fields = {n for n, m in vars(value).items() if "to_dict" in vars(value) and getattr(m, "fset", None)}
                for member in vars(value):
                    if not member.startswith("_") and member not in fields and member != "to_dict":
                        yield f"{room}.{name}.{member}", vars(value)[member]


def test_each_room_is_looked_at() -> None:
    modules = {m.name for m in pkgutil.iter_modules(partpose.__path__) if not m.name.startswith("_")}
    assert modules == set(BOUND + WRITTEN)


def test_each_name_is_used_in_a_test() -> None:
    files = [f for f in Path(__file__).parent.glob("test_*.py") if f.name != "test_names.py"]
    words = set(re.findall(r"\w+", "\n".join(f.read_text() for f in files)))
    assert [name for name, _ in public_names() if name.rsplit(".")[-1] not in words] == []


def documentation(value: Any) -> str:
    """Without the signatures that the binding writes before it."""
    text = inspect.getdoc(value) or ""
    if type(value).__name__.startswith("nb_"):
        text = "\n".join(line for line in text.splitlines() if not re.match(r"\w+\(.*\)( -> .*)?$", line))
    return text.strip()


def test_each_name_has_documentation() -> None:
    enums = (partpose.io.PcdEncoding,)
    assert [name for name, value in public_names() if not isinstance(value, enums) and not documentation(value)] == []


def test_each_class_is_at_home_in_its_room() -> None:
    for room in BOUND:
        for name, value in vars(getattr(partpose, room)).items():
            if isinstance(value, type) and not name.startswith("_"):
                assert value.__module__ == f"partpose.{room}", name


def test_stubs_are_those_of_the_code(root: Path, tmp_path: Path) -> None:
    if importlib.util.find_spec("nanobind") is None:
        pytest.skip("needs nanobind's stubgen")
    subprocess.run(["bash", root / "script" / "make_stubs", sys.executable, tmp_path], check=True)
    for room in BOUND:
        committed = (root / "python" / "partpose" / f"{room}.pyi").read_text()
        assert (tmp_path / f"{room}.pyi").read_text() == committed, f"{room}.pyi: run script/make_stubs"
