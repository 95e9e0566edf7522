"""Every entry of the catalogue has a test, and every id in the name of a test has an entry."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest
from support import shortened

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


CPP = """
int count() {
  // full_run() in a comment shortens nothing.
  return test::full_run() ? 5 : 2;
}

void check(float x) {
  for (int i = 0; i < count(); ++i) {
  }
}

class Sizes : public ::testing::TestWithParam<int> {};

TEST(A3_Samples, ByAHelper) { check(0.1f); }

TEST(A3_Samples, Directly) {
  const int n = full_run() ? 5 : 2;
}

TEST_P(Sizes, A3_ByTheirValues) {
}

INSTANTIATE_TEST_SUITE_P(All, Sizes,
                         full_run() ? ::testing::Values(1, 2) : ::testing::Values(1));

// Not full_run().
TEST(A4_Densities, Agree) {
  EXPECT_TRUE(true);
}
"""

PYTHON = """
FULL = os.environ.get("GRADUS_TEST_FULL") == "1"

@pytest.fixture
def seeds():
    return range(8 if FULL else 2)

def test_by_a_fixture(seeds): ...

@pytest.mark.parametrize("n", range(9 if FULL else 1))
def test_by_a_decorator(n): ...

def test_whole(): ...
"""


def test_only_tests_that_ask_for_the_full_run_are_shortened(tmp_path: Path) -> None:
    """Regression: all tests of a file counted as shortened if one was."""
    source = tmp_path / "a_test.cpp"
    source.write_text(CPP)
    expected = {"A3_Samples.ByAHelper", "A3_Samples.Directly", "Sizes.A3_ByTheirValues"}
    assert shortened.cpp_tests(source) == expected
    source.write_text(PYTHON)
    assert shortened.python_tests(source) == {"test_by_a_fixture", "test_by_a_decorator"}


def test_helpers_in_other_files_shorten_tests(tmp_path: Path) -> None:
    source = tmp_path / "a_stress.cpp"
    source.write_text('#include "stress/stress.h"\n\nTEST(A, B) { render("box", &scene, Bounds::alone()); }\n')
    assert shortened.cpp_tests(source) == {"A.B"}
