# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""The code blocks of a Markdown page, and running them one after the other as a reader would.

A comment before a block says what it is where that is not plain:
`<!-- not run: reason -->` nothing is done with it; `<!-- output -->` what the block before prints, numbers aside;
`<!-- file: NAME -->` the block is written into that file."""

import contextlib
import io
import json
import os
import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

MARKER = re.compile(r"<!-- (not run: .+|output|file: \S+) -->$")


@dataclass
class Block:
    line: int  # of its first line, from 1
    language: str
    text: str
    marker: str = ""


def blocks_of(page: str) -> Iterator[Block]:
    """Fenced blocks, and those indented by four spaces after an empty line."""
    lines = page.splitlines()
    marker, i, in_list = "", 0, False
    while i < len(lines):
        line = lines[i]
        fence = re.match(r"(```+)\s*(\S*)", line)
        if fence:
            end = next(j for j in range(i + 1, len(lines)) if lines[j].startswith(fence[1]))
            yield Block(i + 2, fence[2], "\n".join(lines[i + 1 : end]), marker)
            marker, i = "", end + 1
        elif line.startswith("    ") and not in_list and (i == 0 or not lines[i - 1].strip() or marker):
            end = i
            while end < len(lines) and (lines[end].startswith("    ") or not lines[end].strip()):
                end += 1
            text = "\n".join(each[4:] for each in lines[i:end]).rstrip()
            yield Block(i + 1, _guess(text), text, marker)
            marker, i = "", end
        else:
            found = MARKER.match(line)
            if found:
                marker = found[1]
            elif line.strip():
                marker = ""
                in_list = bool(re.match(r"(\s*)([-*]|\d+\.) ", line)) or (in_list and line.startswith(" "))
            i += 1


def _guess(text: str) -> str:
    if text.startswith("{"):
        return "json"
    return "python" if re.match(r"(import|from) \w+|>>> ", text) else "sh"


class Reader:
    """Runs blocks in a folder; what they change (folder, environment, Python names) stays for the next."""

    def __init__(self, folder: Path, environment: dict[str, str]) -> None:
        self.folder, self.environment = folder, environment
        self.names: dict[str, Any] = {"__name__": "__main__"}
        self.printed = ""

    def run(self, page: str, block: Block) -> None:
        where = f"{page}:{block.line}"
        if block.marker.startswith("not run"):
            return
        if block.marker == "output":
            self._compare(where, block)
        elif block.marker.startswith("file: "):
            (self.folder / block.marker[6:]).write_text(block.text + "\n")
        elif block.language in ("sh", "bash", "shell"):
            self._shell(where, block)
        elif block.language == "python":
            self._python(page, block)
        elif block.language == "json":
            json.loads(block.text)
        elif block.language == "cpp":
            self._cpp(where, block)
        else:
            raise AssertionError(f"{where}: a block of {block.language or 'no language'}: say what it is by a marker")

    def _shell(self, where: str, block: Block) -> None:
        after = self.folder / ".after"
        script = f"set -a  # variables stay, as in a terminal\n{block.text}\n{{ pwd; env -0; }} >'{after}'"
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", script], cwd=self.folder, env=self.environment, capture_output=True, text=True
        )
        assert done.returncode == 0, f"{where}: exit code {done.returncode}\n{block.text}\n{done.stdout}{done.stderr}"
        self.printed = done.stdout
        pwd, env = after.read_text().split("\n", 1)
        after.unlink()
        self.folder = Path(pwd)
        self.environment = dict(e.split("=", 1) for e in env.split("\0") if "=" in e)

    def _python(self, page: str, block: Block) -> None:
        before, environment = os.getcwd(), dict(os.environ)
        os.chdir(self.folder)
        os.environ.update(self.environment)
        said = io.StringIO()
        try:
            with contextlib.redirect_stdout(said):
                exec(compile("\n" * (block.line - 1) + block.text, page, "exec"), self.names)
        finally:
            os.chdir(before)
            os.environ.clear()
            os.environ.update(environment)
        self.printed = said.getvalue()

    def _cpp(self, where: str, block: Block) -> None:
        """As a program against the installed library, run where the page is read."""
        project = self.folder / ".cpp"
        project.mkdir(exist_ok=True)
        (project / "main.cpp").write_text(block.text)
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.22)\nproject(page LANGUAGES CXX)\nfind_package(partpose REQUIRED)\n"
            "add_executable(page main.cpp)\ntarget_link_libraries(page PRIVATE partpose::partpose)\n"
        )
        prefix = self.environment["PARTPOSE_PREFIX"]
        steps = (
            ["cmake", "-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={prefix}"],
            ["cmake", "--build", project / "build"],
            [project / "build" / "page"],
        )
        for step in steps:
            done = subprocess.run(step, cwd=self.folder, env=self.environment, capture_output=True, text=True)
            assert done.returncode == 0, f"{where}: {done.stdout}{done.stderr}"
        self.printed = done.stdout

    def _compare(self, where: str, block: Block) -> None:
        actual = iter(_without_numbers(self.printed))
        for line in _without_numbers(block.text):
            assert line in actual, f"{where}: {line!r} is not what is printed:\n{self.printed}"


def _without_numbers(text: str) -> list[str]:
    lines = (re.sub(r"\s*-?\d[\d.,e+-]*", " #", line) for line in text.splitlines())
    return [re.sub(r"\s+", " ", line).strip() for line in lines if line.strip()]
