# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""gather.py FOLDER: gathers the pages of the documentation site there: the repository's Markdown pages from the README
on, what they link to, and a page of the Python package's documentation for each of its modules. Writes mkdocs.yml
beside, with all of them in its table of contents. Needs partpose to be installed."""

import importlib
import inspect
import pkgutil
import re
import shutil
import sys
from pathlib import Path
from typing import Any

import partpose

ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"\]\(([^)\s#]+)(?:#[^)\s]*)?\)")
FENCE = re.compile(r"^```.*?^```", re.M | re.S)


def gather_pages(target: Path) -> list[Path]:
    """Copies the README, the pages of docs/ and, from there, all that is linked. A link to a folder is to its README."""
    waiting = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]
    done: list[Path] = []
    while waiting:
        page = waiting.pop(0)
        if page in done:
            continue
        done.append(page)
        copy = target / page.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        if page.suffix != ".md":
            shutil.copy(page, copy)
            continue
        text = page.read_text()
        for link in LINK.findall(FENCE.sub("", text)):
            if re.match(r"[a-z]+:", link):
                continue
            linked = (page.parent / link).resolve()
            if (linked / "README.md").is_file():
                text = text.replace(f"]({link})", f"]({link.rstrip('/')}/README.md)")
                linked = linked / "README.md"
            if linked.is_file() and linked.is_relative_to(ROOT):
                waiting.append(linked)
        copy.write_text(text)
    return [page.relative_to(ROOT) for page in done if page.suffix == ".md"]


def signature_and_text(value: Any) -> tuple[list[str], str]:
    """A function's signatures, as Python shows them, and what its documentation says."""
    text = inspect.getdoc(value) or ""
    if inspect.isfunction(value):
        return [f"{value.__name__}{inspect.signature(value)}"], text
    lines = text.splitlines()
    signatures = [line for line in lines if re.match(r"(\d+\. )?``?\w+\(|\w+\(.*\)( -> .*)?$", line)]
    rest = "\n".join(line for line in lines if line not in signatures and line != "Overloaded function.").strip()
    return [shortened(s.split("``")[1] if "``" in s else s) for s in signatures], rest


def shortened(signature: str) -> str:
    signature = re.sub(r"typing\.Annotated\[numpy\.typing\.NDArray\[[^\]]*(?:\[[^\]]*\])?[^\]]*\], dict\(shape=(\([^)]*\))\)\]",
                       r"array\1", signature)  # fmt: skip
    signature = re.sub(r"ndarray\[dtype=(\w+), shape=(\([^)]*\))[^\]]*\]", r"\1 array\2", signature)
    signature = re.sub(r": ([\w.]+) = (\w+)\([^()]*\)", r": \1 = \2()", signature)
    return re.sub(r"\b(collections\.abc|typing|pathlib|partpose\.\w+)\.(?=\w)", "", signature).replace("<partpose", "<")


def cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("<", "&lt;")


def page_of_module(name: str) -> str:
    module = importlib.import_module(f"partpose.{name}")
    documented = getattr(partpose._partpose, name, module)  # a bound room's text is in the extension module
    out = [f"# partpose.{name}", "", inspect.getdoc(documented) or "", ""]
    public = getattr(module, "__all__", [n for n in sorted(dir(module)) if not n.startswith("_")])
    for entry in public:
        value = getattr(module, entry)
        if inspect.ismodule(value):
            continue
        out += [f"## {entry}", ""]
        if inspect.isclass(value):
            out += paragraphs(inspect.getdoc(value) or "") + members(value)
        else:
            signatures, text = signature_and_text(value)
            out += ["```text", *signatures, "```", "", cell(text), ""]
    return "\n".join(out) + "\n"


def paragraphs(doc: str) -> list[str]:
    """The text; lines of fields (name = default: what it is) as a list."""
    out = []
    for line in doc.splitlines():
        field = re.match(r"(\w+(?: = .*?)?): (.*)", line)
        out.append(f"- `{field[1]}`: {cell(field[2])}" if field else cell(line))
    return [*out, ""]


def members(cls: type) -> list[str]:
    described = "to_dict" in vars(cls)  # its fields are in its documentation
    rows, methods = [], []
    for name, value in vars(cls).items():
        if name.startswith("_") and name != "__init__":
            continue
        if isinstance(value, property):
            if not (described and value.fset):
                rows.append(f"| `{name}` | {cell(inspect.getdoc(value) or '')} |")
        elif callable(value) or isinstance(value, staticmethod):
            function = value.__func__ if isinstance(value, staticmethod) else value
            if name == "__init__" and described:
                continue
            signatures, text = signature_and_text(function)
            if name == "__init__":
                signatures, text = [s.replace("__init__(self, ", f"{cls.__name__}(").replace("__init__(self", f"{cls.__name__}(") for s in signatures], ""
            if signatures:
                methods += ["```text", *signatures, "```", "", cell(text), ""]
    table = ["| | |", "|---|---|", *rows, ""] if rows else []
    return [*table, *methods]


def main() -> None:
    target = Path(sys.argv[1]).resolve()
    shutil.rmtree(target, ignore_errors=True)
    pages = gather_pages(target)
    modules = sorted(m.name for m in pkgutil.iter_modules(partpose.__path__) if not m.name.startswith("_"))
    (target / "api").mkdir(parents=True)
    for name in modules:
        (target / "api" / f"{name}.md").write_text(page_of_module(name))
    here = Path(__file__).parent
    settings = (here / "mkdocs.yml").read_text().replace("../../build/docs", str(target.parent))
    api = "\n".join(f"      - partpose.{name}: api/{name}.md" for name in modules)
    settings = settings.replace("Python reference: [API]", f"Python reference:\n{api}")
    named = set(re.findall(r"[\w/]+\.md", settings))
    others = "\n".join(f"      - {page}" for page in map(str, pages) if page not in named)
    settings = settings.replace("  - Changes:", f"  - More pages:\n{others}\n  - Changes:")
    (target.parent / "mkdocs.yml").write_text(settings)


main()
