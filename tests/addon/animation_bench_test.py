"""The benchmark of animations: its modes, what its report makes of stored rows, and its strips."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools" / "bench"))
pytest.importorskip("PIL")
import animation_modes  # noqa: E402
import animation_report as report  # noqa: E402
import animation_scenes  # noqa: E402
import animation_strips as strips  # noqa: E402
import document  # noqa: E402


def rows(mode: str, flicker: float, version: str = "new", **more: float) -> list[dict]:
    """Measures that fall as 1/t, of two seeds."""
    found = []
    for seed in range(2):
        for samples in (4, 16):
            row = {"scene": "lamp-off", "frames": [1, 10], "width": 160, "mode": mode, "version": version, "samples": samples, "seed": seed}
            measures = {"flicker": flicker / samples, "flicker_warped": 0.1 * flicker / samples, "relmse": 0.5 * flicker / samples}
            found.append(row | measures | {"cpu": 0.1 * samples, "reference_samples": 256} | more)
    return found


def stored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *found: list[dict]) -> list[report.AnimationResults]:
    file = tmp_path / "animation.jsonl"
    file.write_text("".join(json.dumps(row) + "\n" for part in found for row in part))
    monkeypatch.setattr(report, "RESULTS", file)
    return report.load()


def test_every_temporal_mode_is_compared_with_itself_frame_by_frame() -> None:
    """AUTO's choice for stills is the library's: its twin is what that takes."""
    temporal = [mode for mode in animation_modes.MODES if animation_modes.is_temporal(mode)]
    assert temporal
    for mode in temporal:
        twin = animation_modes.MODES[animation_modes.per_frame(mode)].settings
        same = {"integrator": "AUTO", "reconstruction": "AUTO"} if mode == "temporal-auto" else {}
        assert animation_modes.MODES[mode].settings == twin | same | {"use_temporal": True}


def test_aims_are_ratios_at_equal_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = [rows("path", 1.0), rows("gradient-l2", 0.2), rows("temporal-l2", 0.05), rows(report.PEER, 0.1)]
    table = report.aims(stored(tmp_path, monkeypatch, *found))
    assert table.columns == ["mode", "ratio", "aim", "lamp-off", "met"]
    assert [row[3:] for row in table.rows] == [[ratio, "1 of 1"] for ratio in ("0.05", "0.05", "0.25", "0.25", "0.25", "0.50", "0.50")]


def test_the_newest_version_of_each_mode_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old = [row | {"frames": [1, 8]} for row in rows("cycles", 1.0)]
    (scene,) = stored(tmp_path, monkeypatch, old, rows("path", 4.0, "old"), rows("path", 1.0), rows("temporal-l2", 0.1, "old"))
    assert scene.modes() == ["path", "temporal-l2"], "another range of frames cannot be compared"
    assert {row["version"] for row in scene.rows if row["mode"] == "path"} == {"new"}
    assert scene.ratio("temporal-l2", "path", "flicker") == pytest.approx(0.1)


def test_lags_are_those_of_the_mean_over_seeds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    late = [0.0] * 4 + [-0.1] + [0.5, 0.2, 0.0, 0.0, 0.0]
    found = rows("temporal-l1", 1.0)
    for row, noise in zip(found, (0.06, 0.06, -0.06, -0.06), strict=True):
        row["shares_of_light"] = [share + noise for share in late]
    (scene,) = stored(tmp_path, monkeypatch, found)
    assert scene.lag_and_lead(scene.points["temporal-l1"][-1]) == (2, 1)


def test_strips_show_all_frames_in_order() -> None:
    frames = np.zeros((4, 90, 160, 3)) + np.arange(4)[:, None, None, None]
    film, over_time = strips.film(frames), strips.over_time(frames)
    assert film.shape == (45, 4 * 64, 3)
    assert film[0, ::64, 0].tolist() == [0, 1, 2, 3]
    assert over_time.shape == (4 * strips.TALL, 160, 3)
    assert over_time[:: strips.TALL, 0, 0].tolist() == [0, 1, 2, 3]


def test_all_animations_are_described() -> None:
    for animation in animation_scenes.ANIMATIONS:
        assert 8 <= animation.length <= 12
        assert animation.moves
        assert animation.goes_off is None or animation.frames[0] < animation.goes_off <= animation.frames[1]


def test_pictures_in_a_table_are_pictures_on_the_page() -> None:
    assert document.inline("![a + b](c.webp)") == '<img src="c.webp" alt="a + b">'
