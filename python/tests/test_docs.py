# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Every code block of the README, the tutorial, the how-to pages and docs/python.md is run, in their order."""

import os
import sys
from pathlib import Path

import pytest
from conftest import ROOT
from doc_blocks import Reader, blocks_of

PAGES = [ROOT / "README.md", ROOT / "docs" / "python.md", *sorted((ROOT / "docs").glob("tutorial*.md")),
         *sorted((ROOT / "docs").glob("howto*.md"))]  # fmt: skip
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


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_each_block_runs(page: Path, checkout: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    if not all(p.exists() for p in NEEDS) or "PARTPOSE_PREFIX" not in os.environ:
        pytest.skip("needs the built command line and an installed library, as script/test_python makes them")
    bin_folder = Path(sys.executable).parent
    environment = os.environ | {
        "PATH": f"{bin_folder}:{os.environ['PATH']}",
        "HOME": str(tmp_path_factory.mktemp("home")),
        "XDG_CACHE_HOME": str(tmp_path_factory.getbasetemp() / "docs_cache"),  # catalogues are made once for all pages
    }
    reader = Reader(checkout, environment)
    blocks = list(blocks_of(page.read_text()))
    assert blocks, page
    for block in blocks:
        reader.run(str(page.relative_to(ROOT)), block)


def test_blocks_are_found() -> None:
    page = "# t\n\n    ls\n\n    pwd\n\n- a\n\n    no block\n\ntext\n\n```python\nx = 1\n```\n\n<!-- not run: why -->\n\n    {\n"
    found = [(b.line, b.language, b.text, b.marker) for b in blocks_of(page)]
    assert found == [(3, "sh", "ls\n\npwd", ""), (14, "python", "x = 1", ""), (19, "json", "{", "not run: why")]


def test_what_is_wrong_in_a_page_fails(tmp_path: Path) -> None:
    def read(page: str) -> None:
        reader = Reader(tmp_path, dict(os.environ))
        for block in blocks_of(page):
            reader.run("page.md", block)

    read("```sh\ncd /; X=3; export X\n```\n\n```sh\n[ $PWD$X = /3 ]; echo at -7.5 mm\n```\n<!-- output -->\n```\nat 12 mm\n```\n")
    read("```python\nx = 1\n```\n\n```python\nassert x == 1\n```\n")
    for wrong in ("```sh\nfalse\n```", "```python\n1 / 0\n```", "```json\n{\n```", "```\nwhat\n```",
                  "```sh\necho a\n```\n<!-- output -->\n```\nb\n```"):  # fmt: skip
        with pytest.raises((AssertionError, ZeroDivisionError, ValueError)):
            read(wrong)
