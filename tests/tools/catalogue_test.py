"""Every entry of the catalogue has a test, and every id in the name of a test has an entry."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

CATALOGUE = Path(__file__).resolve().parents[1] / "catalogue.py"


@pytest.fixture(scope="module")
def catalogue() -> ModuleType:
    spec = importlib.util.spec_from_file_location("catalogue", CATALOGUE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_entry_has_a_test(catalogue: ModuleType) -> None:
    tests = catalogue.find_tests()
    assert not [entry for entry in catalogue.ENTRIES if not tests.get(entry)]


def test_every_test_of_an_id_is_in_the_table(catalogue: ModuleType) -> None:
    """Regression: tests whose id has no entry were left out of docs/tests.md without a message."""
    assert not catalogue.unknown_entries()


def test_an_id_without_an_entry_is_named(catalogue: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(catalogue.ENTRIES, "I2")
    assert catalogue.unknown_entries() == ["I2"]
