"""Pages that comments name exist, and links between documents lead to a file and a heading."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("addon/gradus", "native", "tests", "tools", "docs")
ENDINGS = {".py", ".h", ".hpp", ".cpp", ".c", ".sh", ".md"}
DOCUMENTS = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])

PAGE = re.compile(r"[\w/-]+\.md\b")
LINK = re.compile(r"\]\(([^)\s]+)\)|(?:src|href)=\"([^\"]+)\"")


def sources() -> Iterator[tuple[Path, str]]:
    """Yields all sources but the benchmark, which writes pages of its own to out/bench."""
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in ENDINGS and path.is_file() and not path.is_relative_to(ROOT / "tools/bench"):
                yield path.relative_to(ROOT), path.read_text()


def anchors_of(text: str) -> set[str]:
    """Returns the anchors that GitHub gives to the headings of a Markdown text."""
    headings = re.findall(r"^#+ (.+)$", re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def broken_links(document: Path) -> list[str]:
    broken = []
    for match in LINK.finditer(document.read_text()):
        target = match[1] or match[2]
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        path = (document.parent / name).resolve() if name else document
        if not path.exists() or (anchor and path.suffix == ".md" and anchor not in anchors_of(path.read_text())):
            broken.append(target)
    return broken


def test_anchors_are_those_of_the_headings() -> None:
    assert anchors_of("# Method\n\n## Shifts and Jacobians\n### What it can't do: `all`\n") == {
        "method",
        "shifts-and-jacobians",
        "what-it-cant-do-all",
    }


def test_a_link_that_leads_nowhere_is_found(tmp_path: Path) -> None:
    page = tmp_path / "README.md"
    links = "[a](#title) [b](#other) [c](README.md#title)", "[d](method.md) [e](https://a.org) ![f](missing.png)"
    page.write_text("# Title\n" + " ".join(links))
    assert broken_links(page) == ["#other", "method.md", "missing.png"]


def test_links_of_all_documents_lead_somewhere() -> None:
    assert not {str(document.relative_to(ROOT)): broken for document in DOCUMENTS if (broken := broken_links(document))}


def test_every_page_that_is_named_exists() -> None:
    folders = (ROOT, ROOT / "docs", ROOT / "docs/benchmark")
    missing = {
        (str(path), name)
        for path, text in sources()
        for name in PAGE.findall(text)
        if not any((folder / name.lstrip("/")).is_file() for folder in folders)
    }
    assert not missing
