"""M3: fixed bugs stay tested. A test may be switched off for 30 days, with a reason and a date.

A test that skips itself where a host or machine lacks something says what is missing.
"""

from __future__ import annotations

import datetime
import re
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
SWITCHED_OFF = re.compile(r"\bDISABLED_\w+|pytest\.mark\.(?:xfail|skip)\b")
STATED = re.compile(r"(\d{4}-\d\d-\d\d): \S+")
MAXIMUM_DAYS = 30
WITHOUT_REASON = re.compile(r"pytest\.skip\(\)|GTEST_SKIP\(\);|(?:importorskip|skipif)\((?!.*\breason=)")


def unstated(source: str, today: datetime.date) -> list[str]:
    """Returns lines that switch a test off without a reason and a date of the last 30 days."""
    found = []
    for line in source.splitlines():
        if not SWITCHED_OFF.search(line):
            continue
        stated = STATED.search(line)
        if stated is None or (today - datetime.date.fromisoformat(stated[1])).days > MAXIMUM_DAYS:
            found.append(line.strip())
    return found


def sources() -> list[Path]:
    return [
        path for path in TESTS.rglob("*_test.*") if path != Path(__file__).resolve() and path.suffix in (".py", ".cpp")
    ]


def test_m3_nothing_is_switched_off_without_reason_and_date() -> None:
    assert len(sources()) > 80
    found = {path.name: lines for path in sources() if (lines := unstated(path.read_text(), datetime.date.today()))}
    assert not found


def test_m3_nothing_is_skipped_without_a_reason() -> None:
    texts = {path.name: path.read_text() for path in sources()}
    assert not {name: found for name, text in texts.items() if (found := WITHOUT_REASON.findall(text))}


def test_m3_the_rule_itself() -> None:
    today = datetime.date(2030, 5, 31)
    assert unstated("TEST(A, DISABLED_B) {", today)
    assert unstated('@pytest.mark.xfail(reason="2030-04-01: broken")', today)
    assert not unstated('@pytest.mark.xfail(reason="2030-05-20: waits for the new solver")', today)
    assert not unstated('@pytest.mark.skipif(OLD, reason="came with 4.1")', today)
    for line in ("pytest.skip()", "GTEST_SKIP();", 'pytest.importorskip("scipy")', "@pytest.mark.skipif(OLD)"):
        assert WITHOUT_REASON.search(line)
    for line in ('pytest.skip("why")', 'GTEST_SKIP() << "why";', 'pytest.importorskip("scipy", reason="why")'):
        assert not WITHOUT_REASON.search(line)
