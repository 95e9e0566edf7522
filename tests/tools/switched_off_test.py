"""M3: fixed bugs stay tested. A test may be switched off for 30 days, with a reason and a date.

A test that skips itself where a host or machine lacks something says what is missing.
"""

from __future__ import annotations

import datetime
import re
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
ARGUMENTS = r"(?:[^()]|\((?:[^()]|\([^()]*\))*\))*"
"""Text with parentheses in pairs, two deep, over any number of lines."""

SWITCHED_OFF = re.compile(rf".*(?:\bDISABLED_\w+|pytest\.mark\.(?:xfail|skip)\b(?:\({ARGUMENTS}\))?).*")
STATED = re.compile(r"(\d{4}-\d\d-\d\d): \S+")
MAXIMUM_DAYS = 30
WITHOUT_REASON = re.compile(
    rf"pytest\.skip\(\s*\)|GTEST_SKIP\(\)\s*;|(?:importorskip|skipif)\((?!{ARGUMENTS}\breason=)"
)


def unstated(source: str, today: datetime.date) -> list[str]:
    """Returns lines that switch a test off without a reason and a date of the last 30 days."""
    found = []
    for match in SWITCHED_OFF.finditer(source):
        stated = STATED.search(match[0])
        if stated is None or (today - datetime.date.fromisoformat(stated[1])).days > MAXIMUM_DAYS:
            found.append(match[0].strip())
    return found


def sources() -> list[Path]:
    """Returns all sources of tests and of their helpers, except this file."""
    paths = (path for path in TESTS.rglob("*") if path.suffix in (".py", ".cpp", ".h", ".c"))
    return sorted(path for path in paths if path != Path(__file__).resolve())


def test_m3_nothing_is_switched_off_without_reason_and_date() -> None:
    found = {str(path): lines for path in sources() if (lines := unstated(path.read_text(), datetime.date.today()))}
    assert not found


def test_m3_nothing_is_skipped_without_a_reason() -> None:
    texts = {str(path): path.read_text() for path in sources()}
    assert not {name: found for name, text in texts.items() if (found := WITHOUT_REASON.findall(text))}


def test_m3_helpers_are_searched_too() -> None:
    """Regression: a fixture of conftest.py or a helper of support/ could skip tests without a reason."""
    names = {str(path.relative_to(TESTS)) for path in sources()}
    assert {"conftest.py", "support/window.py", "native/support/statistics.cpp", "stress/light_stress.cpp"} <= names


def test_m3_the_rule_itself() -> None:
    today = datetime.date(2030, 5, 31)
    assert unstated("TEST(A, DISABLED_B) {", today)
    assert unstated('@pytest.mark.xfail(reason="2030-04-01: broken")', today)
    assert not unstated('@pytest.mark.xfail(reason="2030-05-20: waits for the new solver")', today)
    assert not unstated('@pytest.mark.skipif(OLD, reason="came with 4.1")', today)
    for line in ("pytest.skip()", "GTEST_SKIP();", 'pytest.importorskip("scipy")', "@pytest.mark.skipif(OLD)"):
        assert WITHOUT_REASON.search(line)
        assert WITHOUT_REASON.search(f'{line}\npytest.importorskip("scipy", reason="why")'), "a reason of another"
    for line in ('pytest.skip("why")', 'GTEST_SKIP() << "why";', 'pytest.importorskip("scipy", reason="why")'):
        assert not WITHOUT_REASON.search(line)


def test_m3_statements_may_have_several_lines() -> None:
    """Regression: a reason on the next line did not count."""
    today = datetime.date(2030, 5, 31)
    skipif = '@pytest.mark.skipif(\n    not has((1, 2)),\n    {}"came with 4.1",\n)\ndef test_a(reason=1): ...'
    assert not WITHOUT_REASON.search(skipif.format("reason="))
    assert WITHOUT_REASON.search(skipif.format(""))
    xfail = '@pytest.mark.xfail(\n    strict=True,\n    reason="{}: waits for the new solver (L1)",\n)\n'
    assert not unstated(xfail.format("2030-05-20"), today)
    assert unstated(xfail.format("2030-04-01"), today)
    assert unstated('@pytest.mark.xfail\n# 2030-05-20: elsewhere\n', today)
