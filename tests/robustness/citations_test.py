"""What comments cite is there for whoever reads them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("addon/gradus", "native", "tests", "tools", "docs")
ENDINGS = {".py", ".h", ".hpp", ".cpp", ".c", ".sh", ".md"}

NUMBER = r"\d+(?:\.\d+)?"
CONTRACT = re.compile(rf"\b[Cc]ontract(?:\.md)? ({NUMBER}(?:,[\s/#*]*{NUMBER})*)")
"""Several numbers may go on in the next line of a comment."""
PAGE = re.compile(r"[\w/-]+\.md\b")


def texts() -> Iterator[tuple[Path, str]]:
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in ENDINGS and path.is_file():
                yield path.relative_to(ROOT), path.read_text()


def cited(text: str) -> set[str]:
    return {number for cite in CONTRACT.finditer(text) for number in re.findall(NUMBER, cite[1])}


def defined() -> set[str]:
    text = (ROOT / "docs/contract.md").read_text()
    return set(re.findall(r"^- \*\*(\d+\.\d+) ", text, re.MULTILINE)) | set(re.findall(r"^## (\d+)\. ", text, re.MULTILINE))


def test_numbers_are_found_in_one_line_and_the_next() -> None:
    assert cited("// As asked (contract 1.6,\n// 5.3). Contract 2.2; docs/contract.md 4. No contract.") == {"1.6", "5.3", "2.2", "4"}


def test_every_number_of_the_contract_that_is_cited_is_in_it() -> None:
    """Comments cited a page that was not in the project."""
    known = defined()
    assert len(known) > 30
    assert not {str(path): missing for path, text in texts() if (missing := cited(text) - known)}


def test_every_page_that_is_named_exists() -> None:
    folders = (ROOT, ROOT / "docs", ROOT / "docs/benchmark")
    missing = {
        (str(path), name)
        for path, text in texts()
        for name in PAGE.findall(text)
        if not any((folder / name.lstrip("/")).is_file() for folder in folders)
    }
    assert not missing
