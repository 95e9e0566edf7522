"""Checks that the table of seeded faults, the list of base/fault.h and the switches in the sources agree."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests" / "faults"))
from fault import Fault, listed_names, read_faults, switches  # noqa: E402

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


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_m4_each_fault_names_tests(fault: Fault) -> None:
    assert fault.tests
    for test in fault.tests:
        assert (ROOT / "tests" / test.program).is_dir() or (ROOT / test.program).is_file()
        assert test.choice
