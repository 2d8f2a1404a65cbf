# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""docker/Dockerfile is read, not built: what it copies and runs is there, and nothing else installs anything."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest


def instructions(root: Path) -> list[tuple[str, str]]:
    lines = (root / "docker" / "Dockerfile").read_text().splitlines()
    return [tuple(line.split(None, 1)) for line in lines if line and not line.startswith("#")]  # type: ignore[misc]


def test_what_it_runs_is_there(root: Path) -> None:
    runs = [argument for name, argument in instructions(root) if name == "RUN"]
    assert runs == ["script/setup", "script/build"]
    for script in runs:
        assert os.access(root / script, os.X_OK), script
    copied = [argument.split()[0] for name, argument in instructions(root) if name == "COPY"]
    assert copied == ["script/setup", "."] and all((root / c).exists() for c in copied)


def test_setup_needs_nothing_that_comes_later(root: Path) -> None:
    """It is copied and run by itself, so that its layer stays while the source changes."""
    setup = (root / "script" / "setup").read_text()
    assert not re.search(r"\bscript/|source |\.\./", setup.split("set -euo pipefail")[1].split("echo")[0])


def test_the_system_is_one_that_setup_knows(root: Path) -> None:
    first = instructions(root)[0]
    assert first[0] == "FROM" and first[1].startswith("debian:12") and "Debian 12" in (root / "script" / "setup").read_text()
    ignored = (root / "docker" / "Dockerfile.dockerignore").read_text().split()
    assert "build" in ignored and "parts" not in ignored


def test_the_packages_exist(root: Path) -> None:
    """Those that setup installs, by the package lists of this machine."""
    setup = (root / "script" / "setup").read_text()
    packages = setup.split("packages=(")[1].split(")")[0].replace('"$@"', "").split()
    assert len(packages) > 10 and "g++" in packages
    if not shutil.which("apt-cache"):
        pytest.skip("needs apt-cache")
    told = subprocess.run(["apt-cache", "policy", *packages], capture_output=True, text=True).stdout
    candidates = dict(re.findall(r"^(\S+):\n  Installed: .*\n  Candidate: (.*)$", told, re.M))
    assert [p for p in packages if candidates.get(p, "(none)") == "(none)"] == []
