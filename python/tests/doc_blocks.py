# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""The code blocks of a Markdown page, and running them one after the other as a reader would.

Comments before a block say what it is where that is not plain:
`<!-- not run: reason -->` nothing is done with it;
`<!-- checked: reason -->` its programs and the options that it gives them exist, they are not run;
`<!-- before: COMMAND -->` what a reader has, as files of his own, is made by that command;
`<!-- given: CODE -->` the same of C++ code;
`<!-- run with: FROM -> TO -->` it takes long, or changes the system: that is put in another's place;
`<!-- output -->` what the block before prints, numbers aside; `<!-- output: numbers too -->` nearly the same numbers, but for ms;
`<!-- file: NAME -->` the block is written into that file;
`<!-- config: KIND -->` it is a configuration of that kind (`partpose config KIND`)."""

import contextlib
import io
import json
import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

MARKER = re.compile(r"<!-- (not run|checked|before|given|run with|output|file|config)(?:: (.+))? -->$")
PROGRESS = re.compile(r"^[a-z ]+: \d+ of \d+\n", re.M)
NUMBER = re.compile(r"-?\d(?:[\d.,e+-]*\d)?")


@dataclass
class Block:
    line: int  # of its first line, from 1
    language: str
    text: str
    markers: tuple[tuple[str, str], ...] = ()

    def marked(self, kind: str) -> list[str]:
        """What the markers of that kind say."""
        return [said for name, said in self.markers if name == kind]


def blocks_of(page: str) -> Iterator[Block]:
    """Fenced blocks, and those indented by four spaces after an empty line."""
    lines = page.splitlines()
    markers: list[tuple[str, str]] = []
    i, in_list = 0, False
    while i < len(lines):
        line = lines[i]
        fence = re.match(r"(```+)\s*(\S*)", line)
        if fence:
            end = next(j for j in range(i + 1, len(lines)) if lines[j].startswith(fence[1]))
            yield Block(i + 2, fence[2], "\n".join(lines[i + 1 : end]), tuple(markers))
            markers, i = [], end + 1
        elif line.startswith("    ") and not in_list and (i == 0 or not lines[i - 1].strip() or markers):
            end = i
            while end < len(lines) and (lines[end].startswith("    ") or not lines[end].strip()):
                end += 1
            text = "\n".join(each[4:] for each in lines[i:end]).rstrip()
            yield Block(i + 1, _guess(text), text, tuple(markers))
            markers, i = [], end
        else:
            found = MARKER.match(line)
            if found:
                markers.append((found[1], found[2] or ""))
            elif line.strip():
                markers = []
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
        if block.marked("not run"):
            return
        for command in block.marked("before"):
            self._shell(where, command)
        text = block.text
        for change in block.marked("run with"):
            old, new = change.split(" -> ")
            assert old in text, f"{where}: {old!r} is not in the block"
            text = text.replace(old, new)
        for name in block.marked("file"):
            (self.folder / name).write_text(text + "\n")
        if block.marked("output"):
            self._compare(where, block)
        elif block.marked("checked"):
            self._check(where, text)
        elif block.language in ("sh", "bash", "shell"):
            self._shell(where, text)
        elif block.language == "console":
            self._console(where, text)
        elif block.language in ("zsh", "fish"):
            if shutil.which(block.language):
                self._shell(where, text, block.language)
        elif block.language == "python":
            self._python(page, block.line, text)
        elif block.language == "json":
            json.loads(text)
            for kind in block.marked("config"):
                (self.folder / ".config.json").write_text(text)
                self._shell(where, f"partpose config {kind} --config .config.json >.config.out")
        elif block.language == "cpp":
            self._cpp(where, "\n".join([*block.marked("given"), text]))
        elif block.language != "text" and not block.marked("file"):
            raise AssertionError(f"{where}: a block of {block.language or 'no language'}: say what it is by a marker")

    def _shell(self, where: str, text: str, shell: str = "bash") -> None:
        if shell != "bash":
            done = self._run([shell, "-c", text])
            assert done.returncode == 0, f"{where}: exit code {done.returncode}\n{text}\n{done.stdout}{done.stderr}"
            return
        after = self.folder / ".after"
        script = f"set -a  # variables stay, as in a terminal\n{text}\n{{ pwd; env -0; }} >'{after}'"
        done = self._run(["bash", "-euo", "pipefail", "-c", script])
        assert done.returncode == 0, f"{where}: exit code {done.returncode}\n{text}\n{done.stdout}{done.stderr}"
        self.printed = done.stdout
        pwd, env = after.read_text().split("\n", 1)
        after.unlink()
        self.folder = Path(pwd)
        self.environment = dict(e.split("=", 1) for e in env.split("\0") if "=" in e)

    def _run(self, command: list[str]) -> subprocess.CompletedProcess[str]:
        return subprocess.run(command, cwd=self.folder, env=self.environment, capture_output=True, text=True)

    def _console(self, where: str, text: str) -> None:
        """Commands after `$ `, each followed by what it writes: all of it, numbers and spaces aside; `...` is anything."""
        for command, said in re.findall(r"^\$ (.*)\n?((?:(?!\$ ).*\n?)*)", text, re.M):
            done = self._run(["bash", "-c", command])
            assert done.returncode in (0, 2), f"{where}: {command}: exit code {done.returncode}: {done.stderr}"
            wanted = ".*".join(re.escape(part) for part in _squeezed(said).split("..."))
            errors = PROGRESS.sub("", done.stderr)  # a slow machine is told of it
            assert re.fullmatch(wanted, _squeezed(done.stdout + errors)), (
                f"{where}: {command}: writes\n{done.stdout}{done.stderr}"
            )

    def _check(self, where: str, text: str) -> None:
        """Each program is there, and what it says of itself names the options that it is given."""
        for line in text.replace("\\\n", " ").splitlines():
            words = [w for w in shlex.split(line, comments=True) if not re.match(r"\w+=", w)]
            if not words:
                continue
            script = next((w for w in words if (self.folder / w).is_file()), "")
            program = words[0] if words[0] != "python3" or not script else script
            assert (self.folder / program).is_file() or shutil.which(program), f"{where}: no program {program}"
            if Path(program).name == "partpose":
                commands = words[1 : next((i for i, w in enumerate(words) if w.startswith("-")), len(words))]
                known = self._run([program, commands[0], "--help"]).stdout
            elif program == script:
                known = (self.folder / script).read_text()
            else:
                continue
            for option in (w.split("=")[0] for w in words if w.startswith("-") and w != "-m"):
                assert re.search(rf"(?<![\w-]){re.escape(option)}\b", known), f"{where}: {program} has no {option}"

    def _python(self, page: str, line: int, text: str) -> None:
        before, environment = os.getcwd(), dict(os.environ)
        os.chdir(self.folder)
        os.environ.update(self.environment)
        said = io.StringIO()
        try:
            with contextlib.redirect_stdout(said):
                exec(compile("\n" * (line - 1) + text, page, "exec"), self.names)
        finally:
            os.chdir(before)
            os.environ.clear()
            os.environ.update(environment)
        self.printed = said.getvalue()

    def _cpp(self, where: str, text: str) -> None:
        """As a program against the installed library, run where the page is read. Lines without a main are its body."""
        if not re.search(r"\bmain\(", text):
            text = f"#include <partpose/partpose.hpp>\nusing namespace partpose;\nint main() {{\n{text}\n}}\n"
        project = self.folder / ".cpp"
        project.mkdir(exist_ok=True)
        (project / "main.cpp").write_text(text)
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
            done = self._run([str(word) for word in step])
            assert done.returncode == 0, f"{where}: {done.stdout}{done.stderr}"
        self.printed = done.stdout

    def _compare(self, where: str, block: Block) -> None:
        actual = iter(self.printed.splitlines())
        for line in filter(str.strip, block.text.splitlines()):
            found = next((each for each in actual if _without_numbers(each) == _without_numbers(line)), None)
            assert found is not None, f"{where}: {line!r} is not what is printed:\n{self.printed}"
            if block.marked("output") == ["numbers too"]:
                near = all(abs(a - b) <= 0.03 + 0.01 * abs(b) for a, b in zip(_numbers(found), _numbers(line), strict=True))
                assert near, f"{where}: {line!r} is not near to what is printed: {found!r}"


def _without_numbers(line: str) -> str:
    return re.sub(r"\s+", " ", re.sub(rf"\s*{NUMBER.pattern}", " #", line)).strip()


def _numbers(line: str) -> list[float]:
    """Those that are no time, which is another on each machine."""
    return [float(number) for number in NUMBER.findall(re.sub(r"[\d.]+ ms", "", line))]


def _squeezed(text: str) -> str:
    return re.sub(r"\s+", "", NUMBER.sub("#", text))
