"""Features that agree with Cycles go on agreeing: a part of the rows of docs/coverage.md is rendered again.

A fixed tenth of the rows is the same in every run, so that what breaks is found at once. Another tenth is drawn by a
seed that GRADUS_COVERAGE_SEED repeats. The first tests are about the measures and the document themselves.
"""

from __future__ import annotations

import os
import random
import sys
import zlib
from fnmatch import fnmatchcase
from pathlib import Path

import bpy
import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools"))
from coverage import difference, document, rna, trial  # noqa: E402
from coverage.families import all_rows  # noqa: E402
from coverage.row import Row  # noqa: E402
from coverage.trial import AGREES, DIFFERS, FALLS_BACK, NO_EFFECT, Judge  # noqa: E402

PART = 10
KEPT = {AGREES: {AGREES}, NO_EFFECT: {AGREES}, FALLS_BACK: {AGREES, FALLS_BACK}}
"""What a row with a stored verdict may be now. A row that falls back without a warning would be a silent difference."""


def host() -> str:
    """Returns the name of the running Blender in the document."""
    version = ".".join(str(part) for part in bpy.app.version[:2])
    return next(name for name, title in document.HOSTS.items() if title == version)


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    return list(all_rows())


def is_fixed(name: str) -> bool:
    return zlib.crc32(name.encode()) % PART == 0


def test_rows_keep_their_verdicts(rows: list[Row], tmp_path: Path) -> None:
    seed = os.environ.get("GRADUS_COVERAGE_SEED") or str(random.SystemRandom().randrange(10**6))
    print(f"GRADUS_COVERAGE_SEED={seed}")
    draw = random.Random(seed)
    stored = document.read().verdicts(host())
    chosen = [row for row in rows if is_fixed(row.name) or draw.randrange(PART) == 0]
    assert len(chosen) > len(stored) // PART
    judge = Judge(tmp_path, tells_effects=False)
    changed = []
    for row in chosen:
        allowed = KEPT.get(stored.get(row.name, ""))
        outcome = judge.run(row) if allowed else None
        if outcome and outcome.verdict not in allowed:
            changed.append(f"{row.name}: {outcome.verdict} instead of {stored[row.name]}: {outcome.note}")
    assert not changed, f"with GRADUS_COVERAGE_SEED={seed}:\n" + "\n".join(changed)


@pytest.mark.skipif(bpy.app.version[:2] != (4, 5), reason="columns of other versions may be older than the rows")
def test_the_document_has_every_row(rows: list[Row]) -> None:
    """A new row, such as that of a node that got another input, is rendered once by `make coverage`."""
    stored = document.read().verdicts(host())
    assert {row.name for row in rows} == set(stored)


def test_names_are_different(rows: list[Row]) -> None:
    names = [row.name for row in rows]
    assert len(names) == len(set(names))


def test_a_difference_of_two_percent_is_found() -> None:
    picture = np.full((48, 64, 4), 0.5, np.float32)
    assert difference.compare(picture, picture * 1.009).agrees
    assert not difference.compare(picture, picture * 1.011).agrees
    spot = picture.copy()
    spot[:16, :32] *= (1.03, 0.97, 1.0, 1.0)  # 16 of 48 blocks, without a change of the mean
    spot[16:32, :32] *= (0.97, 1.03, 1.0, 1.0)
    found = difference.compare(picture, spot)
    assert found.mean < 1e-6
    assert not found.agrees


def test_pictures_that_are_not_finite_differ() -> None:
    picture = np.full((48, 64, 3), 0.5, np.float32)
    broken = picture.copy()
    broken[3, 4] = np.nan
    assert not difference.compare(picture, broken).agrees
    assert difference.compare(broken, broken).agrees


def cryptomatte_of(*ranks: tuple[int, float]) -> dict[str, np.ndarray]:
    """Returns a Cryptomatte of one rank on the left and another one on the right, each an identifier and a coverage."""
    image = np.zeros((32, 32, 4), np.float32)
    for half, (identifier, share) in zip((np.s_[:, :16], np.s_[:, 16:]), ranks, strict=True):
        image[half][..., 0] = np.array(identifier, np.uint32).view(np.float32)
        image[half][..., 1] = share
    return {"Layer.CryptoObject00": image}


def test_cryptomattes_are_compared_by_coverage() -> None:
    """Identifiers are hashes, whose floats are huge or tiny. Regression: one pixel of an edge counted as all of it."""
    expected = cryptomatte_of((0x7E123456, 1.0), (0x00800001, 1.0))
    edge = cryptomatte_of((0x7E123456, 1.0), (0x00800001, 1.0))
    edge["Layer.CryptoObject00"][3, 4, :2] = 0.0
    other = cryptomatte_of((0x7E123456, 1.0), (0x00900001, 1.0))
    less = cryptomatte_of((0x7E123456, 1.0), (0x00800001, 0.9))
    assert [trial.worst_difference(expected, found)[0].agrees for found in (expected, other, less)] == [
        True,
        False,
        False,
    ]
    assert trial.worst_difference(expected, edge)[0].mean < 0.01


def test_light_passes_are_compared_with_their_colours() -> None:
    """Regression: a pixel of which one sample of thousands met a surface counted like one that it fills."""
    color = np.full((32, 32, 3), 0.5, np.float32)
    light = np.full((32, 32, 3), 0.7, np.float32)
    color[:2], edge = 1e-5, light.copy()
    edge[:2] = 0.0
    passes = {"Layer.DiffCol": color, "Layer.DiffInd": light}
    assert trial.worst_difference(passes, passes | {"Layer.DiffInd": edge})[0].agrees
    assert not trial.worst_difference(passes, passes | {"Layer.DiffInd": 1.1 * light})[0].agrees
    assert not trial.worst_difference({"Layer.DiffInd": light}, {"Layer.DiffInd": edge})[0].agrees


def test_the_document_is_read_as_it_was_written(tmp_path: Path) -> None:
    table = document.Document()
    rows = [
        ("Nodes", "A.x=1", AGREES, ""),
        ("Nodes", "A.y", FALLS_BACK, "it is | grey"),
        ("Lights", "B", DIFFERS, "2 %"),
    ]
    for family, name, verdict, note in rows:
        for blender in ("3.4", "bpy52"):
            table.put(blender, {"family": family, "name": name, "verdict": verdict, "note": note})
    table.put("bpy45", {"family": "Lights", "name": "B", "verdict": "not shown", "note": ""})
    document.write(table, tmp_path / "first")
    again = document.read(tmp_path / "first")
    document.write(again, tmp_path / "second")
    assert (tmp_path / "first").read_text() == (tmp_path / "second").read_text()
    assert again.verdicts("bpy52") == {"A.x=1": AGREES, "A.y": FALLS_BACK, "B": DIFFERS}
    assert again.verdicts("bpy45") == {"B": "not shown"}
    again.forget("bpy52")
    assert again.verdicts("bpy52") == {}


def test_shares_are_of_what_can_be_shown() -> None:
    table = document.Document()
    rows = {
        "A": AGREES,
        "B": NO_EFFECT,
        "C": FALLS_BACK,
        "D": DIFFERS,
        "E": "not shown",
        "ShaderNodeVolumeScatter.inputs[Color]": FALLS_BACK,
        "ShaderNodeOutputWorld.inputs[Volume]": FALLS_BACK,
        "Particles HAIR PATH": FALLS_BACK,
        "ShaderNodeBsdfHair.mute": AGREES,
    }
    for name, verdict in rows.items():
        table.put("bpy52", {"family": "Rows", "name": name, "verdict": verdict, "note": ""})
    assert table.share("bpy52") == 3 / 8
    assert table.share("bpy52", document.UNSUPPORTED) == 2 / 4
    assert "| **share** | 37.5% | of all lines" in table.text()
    assert "| **share** | 50.0% | of lines" in table.text()


def test_unsupported_rows_exist() -> None:
    """A renamed row would otherwise count as one that Gradus should render."""
    names = document.read().verdicts("bpy45")
    assert all(any(fnmatchcase(name, pattern) for name in names) for pattern in document.UNSUPPORTED)


def test_each_other_value_is_a_row() -> None:
    material = bpy.data.materials.new("Probe")
    changes = dict(rna.changes(material))
    assert ".pass_index" in changes
    changes[".pass_index"](material)
    assert material.pass_index == 1
