# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Every code block of every page is run, in the page's order; what is done with those that cannot be: doc_blocks.py."""

import os
import sys
from pathlib import Path

import pytest
from conftest import ROOT
from doc_blocks import Reader, blocks_of

# All that the site gathers from the repository (docs/site/gather.py).
PAGES = [page for pattern in ("*.md", "docs/*.md", "*/README.md", "*/*/README.md") for page in sorted(ROOT.glob(pattern))
         if not page.is_relative_to(ROOT / "build") and list(blocks_of(page.read_text()))]  # fmt: skip
NEEDS = [ROOT / "build" / "release" / "partpose"]


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A folder that looks like the repository's root, so that what blocks write stays out of it."""
    folder = tmp_path / "partpose"
    folder.mkdir()
    for entry in ROOT.iterdir():
        if not entry.name.startswith("."):
            (folder / entry.name).symlink_to(entry)
    return folder


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_each_block_runs(page: Path, checkout: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    if not all(p.exists() for p in NEEDS) or "PARTPOSE_PREFIX" not in os.environ:
        pytest.skip("needs the built command line and an installed library, as script/test_python makes them")
    bin_folder = Path(sys.executable).parent
    environment = os.environ | {
        "PATH": f"{bin_folder}:{ROOT / 'build' / 'release'}:{os.environ['PATH']}",
        "DISPLAY": "",  # no page is opened in a browser
        "WAYLAND_DISPLAY": "",
        "HOME": str(tmp_path_factory.mktemp("home")),
        "XDG_CACHE_HOME": str(tmp_path_factory.getbasetemp() / "docs_cache"),  # catalogues are made once for all pages
    }
    reader = Reader(checkout, environment)
    for block in blocks_of(page.read_text()):
        reader.run(str(page.relative_to(ROOT)), block)


def test_blocks_are_found() -> None:
    page = "# t\n\n    ls\n\n    pwd\n\n- a\n\n    no block\n\ntext\n\n```python\nx = 1\n```\n\n<!-- before: a -->\n<!-- output -->\n\n    {\n"
    found = [(b.line, b.language, b.text, b.markers) for b in blocks_of(page)]
    markers = (("before", "a"), ("output", ""))
    assert found == [(3, "sh", "ls\n\npwd", ()), (14, "python", "x = 1", ()), (20, "json", "{", markers)]


def test_what_is_wrong_in_a_page_fails(tmp_path: Path) -> None:
    def read(page: str) -> None:
        reader = Reader(tmp_path, dict(os.environ))
        for block in blocks_of(page):
            reader.run("page.md", block)

    read("```sh\ncd /; X=3; export X\n```\n\n```sh\n[ $PWD$X = /3 ]; echo at -7.5 mm\n```\n<!-- output -->\n```\nat 12 mm\n```\n")
    read("```python\nx = 1\n```\n\n```python\nassert x == 1\n```\n")
    read("<!-- before: touch x -->\n<!-- run with: y -> x -->\n```sh\nls y\n```\n\n```console\n$ ls x\nx\n$ seq 3\n1\n...\n```\n")
    numbers = "```sh\necho 'at -7.5 mm (3 ms)'\n```\n<!-- output: numbers too -->\n```\nat {} mm (12.5 ms)\n```\n"
    read(numbers.format(-7.47))
    (tmp_path / "tool").write_text("#!/bin/sh\n# tool --fast: at once\n")
    read("<!-- checked: slow -->\n```sh\nX=1 ./tool --fast 3 # soon\n```\n")
    for wrong in ("```sh\nfalse\n```", "```python\n1 / 0\n```", "```json\n{\n```", "```\nwhat\n```",
                  "```sh\necho a\n```\n<!-- output -->\n```\nb\n```", numbers.format(-7.2), "<!-- run with: y -> x -->\n```sh\nls\n```",
                  "```console\n$ echo a\nb\n```", "```console\n$ echo a\n```", "```console\n$ exit 1\n```",
                  "<!-- checked: slow -->\n```sh\n./tool --fas\n```", "<!-- checked: slow -->\n```sh\n./no_tool\n```"):  # fmt: skip
        with pytest.raises((AssertionError, ZeroDivisionError, ValueError)):
            read(wrong)
