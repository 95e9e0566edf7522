"""The table of seeded faults agrees with the list of base/fault.h, the switches in the sources and the tests."""

from __future__ import annotations

import fnmatch
import re
import sys
from collections import Counter
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests" / "faults"))
from fault import Fault, Test, listed_names, read_faults, switches  # noqa: E402
from faults import Table  # noqa: E402

FAULTS = read_faults()
SWITCHED = [fault.name for fault in FAULTS if fault.edit is None]
EDITS = [fault for fault in FAULTS if fault.edit]


def test_m4_the_list_names_the_faults_of_the_table() -> None:
    assert listed_names() == SWITCHED


def test_m4_each_fault_has_one_switch() -> None:
    assert Counter(name for name, _ in switches()) == Counter(SWITCHED)


@pytest.mark.parametrize("fault", EDITS, ids=lambda fault: fault.name)
def test_m4_edits_of_the_addon_have_their_place(fault: Fault) -> None:
    assert fault.edit.file.startswith("addon/")
    assert (ROOT / fault.edit.file).read_text().count(fault.edit.old) == 1
    assert fault.edit.old != fault.edit.new


@cache
def native_tests(program: str) -> set[str]:
    """Returns the names of a program's GoogleTest tests, without the prefix and the number of parameterised ones."""
    sources = "".join(path.read_text() for path in sorted((ROOT / "tests" / program).rglob("*.cpp")))
    return {".".join(names) for names in re.findall(r"^TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", sources, re.M)}


def unknown_parts(test: Test) -> list[str]:
    """Returns the parts of a selection that match no test."""
    if not test.is_native:
        names = (ROOT / test.program).read_text()
        words = (word for word in re.findall(r"\w+", test.choice) if word not in ("and", "or", "not"))
        return [word for word in words if word not in names]
    names = native_tests(test.program)
    patterns = [re.sub(r"^[\w*]+/|/[^.]*$", "", part) for part in re.split("[:-]", test.choice)]
    return [pattern for pattern in patterns if not fnmatch.filter(names, pattern)]


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_m4_each_fault_names_tests(fault: Fault) -> None:
    """Selections name existing tests, so that renamed tests are noticed without a run of `make faults`."""
    assert fault.tests
    for test in fault.tests:
        assert (ROOT / "tests" / test.program).is_dir() or (ROOT / test.program).is_file()
        assert test.choice
        assert unknown_parts(test) == []


def test_m4_the_page_has_results_of_current_faults_only() -> None:
    """Regression: a row named tests that the fault no longer named."""
    page = ROOT / "docs" / "faults.md"
    table = Table(page, FAULTS)
    rows = [line for line in page.read_text(encoding="utf-8").splitlines() if line.startswith("| ")][1:]
    assert len(rows) == sum(table.has(fault) for fault in FAULTS)
