"""IES profiles of each photometric type, of symmetric luminaires, and files that are none."""

from __future__ import annotations

import math

import pytest
from gradus.nodes import ies_profile

WATTS = 4.0 * math.pi / 177.83


def text(kind: int, vertical: list[float], horizontal: list[float], rows: list[list[float]], tilt: str = "NONE") -> str:
    lines = [
        "IESNA:LM-63-1995",
        "[TEST] a luminaire",
        f"TILT={tilt}",
        f"1 1000 2 {len(vertical)} {len(horizontal)} {kind} 2 0 0 0",
        "0.5 1 50",
        *(" ".join(map(str, values)) for values in (vertical, horizontal, *rows)),
    ]
    return "\r\n".join(lines)


def rows_of(profile: ies_profile.Profile) -> list[list[float]]:
    return [[round(value / WATTS, 6) for value in row] for row in profile.rows]


def test_one_column_is_the_same_all_around() -> None:
    profile = ies_profile.parse(text(1, [0, 45, 90], [0], [[100, 50, 0]]))
    assert profile.horizontal == [0, 360] and profile.vertical == [0, 45, 90]
    assert rows_of(profile) == [[100, 50, 0]] * 2
    table = profile.table()
    assert table[0] == 2 and table[1:6] == pytest.approx((0, 2 * math.pi, 0, math.pi / 4, math.pi / 2))
    assert len(table) == 1 + 2 + 3 + 6


@pytest.mark.parametrize(
    ("horizontal", "columns", "expected_angles", "expected"),
    [
        ([0, 90], [1, 2], [0, 90, 180, 270, 360], [1, 2, 1, 2, 1]),
        ([0, 90, 180], [1, 2, 3], [0, 90, 180, 270, 360], [1, 2, 3, 2, 1]),
        ([90, 180, 270], [1, 2, 3], [0, 90, 180, 270, 360], [1, 2, 3, 2, 1]),
        ([0, 120, 240], [1, 2, 3], [0, 120, 240, 360], [1, 2, 3, 1]),
        ([0, 120, 240, 360], [1, 2, 3, 1], [0, 120, 240, 360], [1, 2, 3, 1]),
        ([0, 100, 150], [1, 2, 3], [0, 100, 150], [1, 2, 3]),
    ],
)
def test_type_c_is_completed_by_its_symmetry(
    horizontal: list[float], columns: list[float], expected_angles: list[float], expected: list[float]
) -> None:
    profile = ies_profile.parse(text(1, [0, 90], horizontal, [[value, 0] for value in columns]))
    assert profile.horizontal == expected_angles
    assert [row[0] for row in rows_of(profile)] == expected


def test_type_a_turns_the_other_way() -> None:
    profile = ies_profile.parse(text(3, [-90, 0, 90], [0, 90], [[1, 2, 3], [4, 5, 6]]))
    assert profile.vertical == [0, 90, 180] and profile.horizontal == [90, 180, 270]
    assert rows_of(profile) == [[4, 5, 6], [1, 2, 3], [4, 5, 6]]


def test_the_axes_of_type_b_swap() -> None:
    profile = ies_profile.parse(text(2, [0, 90], [0, 90], [[1, 2], [3, 4]]))
    assert profile.horizontal == [0, 90, 180] and profile.vertical == [0, 90, 180]
    assert rows_of(profile) == [[4, 2, 4], [3, 1, 3], [4, 2, 4]]


def test_the_tilt_of_the_lamp_is_passed_over() -> None:
    included = text(1, [0, 90], [0], [[7, 0]], tilt="INCLUDE\r\n1\r\n2\r\n0 90\r\n1 0.5")
    assert rows_of(ies_profile.parse(included)) == [[7, 0]] * 2


def test_commas_separate_numbers() -> None:
    assert rows_of(ies_profile.parse(text(1, [0, 90], [0], [[7, 0]]).replace("7 0", "7,0"))) == [[7, 0]] * 2


GOOD = text(1, [0, 90], [0], [[7, 0]])


@pytest.mark.parametrize(
    "broken",
    [
        "",
        "\0" * 100,
        "TILT=",
        GOOD.replace("TILT", "TURN"),
        GOOD[:-6],
        GOOD.replace("7 0", "7 nan"),
        GOOD.replace("7 0", "7 x"),
        GOOD.replace("7 0", "7 1e999"),
        GOOD.replace("7 0", "7 1e41"),
        GOOD.replace("0 90", "90 0"),
        GOOD.replace(" 2 1 1 2 ", " 2 1 4 2 "),  # an unknown type
        GOOD.replace(" 2 1 1 2 ", " -2 1 1 2 "),
        GOOD.replace(" 2 1 1 2 ", " 1e300 1 1 2 "),
        GOOD.replace(" 2 1 1 2 ", " nan 1 1 2 "),
        GOOD.replace(" 2 1 1 2 ", " 99999 99999 1 2 "),
        text(1, [0], [0], [[7]]),
        text(1, [], [], []),
    ],
)
def test_broken_files_have_no_profile(broken: str) -> None:
    assert ies_profile.parse(broken) is None
