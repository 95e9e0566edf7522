"""Every entry of the catalogue has a test."""

from __future__ import annotations

import importlib.util
from pathlib import Path

CATALOGUE = Path(__file__).resolve().parents[1] / "catalogue.py"


def test_every_entry_has_a_test() -> None:
    spec = importlib.util.spec_from_file_location("catalogue", CATALOGUE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    tests = module.find_tests()
    assert not [entry for entry in module.ENTRIES if not tests.get(entry)]
