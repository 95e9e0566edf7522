"""Tests of the benchmark's measures on images and curves whose error is known, and of its report."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools" / "bench"))
import behind  # noqa: E402
import bounds  # noqa: E402
import crops  # noqa: E402
import document  # noqa: E402
import hosts  # noqa: E402
import metrics  # noqa: E402
import modes  # noqa: E402
import path_tracing  # noqa: E402
import records  # noqa: E402
import results  # noqa: E402
import rooms  # noqa: E402
import scenes  # noqa: E402
import seeds  # noqa: E402
import speed  # noqa: E402
import targets  # noqa: E402

RANDOM = np.random.default_rng(1)
REFERENCE = 0.2 + RANDOM.random((24, 32, 3))


def noisy(deviation: float, seed: int) -> np.ndarray:
    return REFERENCE + np.random.default_rng(seed).normal(scale=deviation, size=REFERENCE.shape)


def test_relative_error_of_a_constant_offset() -> None:
    gray = np.linspace(0.1, 1.0, 32)  # the median of 3x3 pixels is that in the middle
    reference = np.broadcast_to(gray[None, :, None], (24, 32, 3))
    expected = 0.01 / (1e-3 + gray[1:-1] ** 2)
    assert metrics.relative_squared_error(reference + 0.1, reference)[:, 1:-1] == pytest.approx(
        np.broadcast_to(expected, (24, 30))
    )


def test_missing_light_of_rare_bright_paths_counts() -> None:
    """Regression: errors were divided by the reference's own bright pixels, and a darker image had less error."""
    reference = np.full((64, 64, 3), 0.95)
    reference[::8, ::8] += 0.05 * 64  # a rare path carries a twentieth of the light
    variance = ((reference - 1.0) ** 2).mean() * np.ones_like(reference)
    dark, right = (metrics.rel_mse(np.full_like(reference, level), reference, variance) for level in (0.95, 1.0))
    assert dark > right


def test_the_variance_of_a_reference_is_subtracted() -> None:
    """A perfect image against a noisy reference has no error, on average."""
    deviation = 0.05
    errors = [
        metrics.rel_mse(REFERENCE, noisy(deviation, seed), np.full_like(REFERENCE, deviation**2)) for seed in range(64)
    ]
    raw = metrics.rel_mse(REFERENCE, noisy(deviation, 0))
    assert abs(np.mean(errors)) < 0.1 * raw


def test_trimming_removes_one_firefly() -> None:
    image = np.tile(REFERENCE, (2, 2, 1))
    reference = image.copy()
    image[3, 5] += 1e4
    assert metrics.rel_mse(image, reference) > 1.0
    assert metrics.rel_mse_trimmed(image, reference) == 0.0


def test_similarity_falls_with_noise() -> None:
    values = [metrics.ssim(noisy(deviation, 1), REFERENCE) for deviation in (0.0, 0.05, 0.5)]
    assert values[0] == pytest.approx(1.0)
    assert values[0] > values[1] > values[2]


def test_bias_and_variance_are_separated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(seeds, "CACHE", tmp_path)
    count, deviation, bias = 16, 0.2, 0.1
    none = np.zeros_like(REFERENCE)
    weight = (1.0 / metrics.relative_to(REFERENCE)).mean()
    errors = []
    for seed in range(count):
        image = noisy(deviation, seed) + bias
        sums = seeds.SeedSum("key")  # read anew each time, as when a run is resumed
        sums.add(seed, image)
        sums.add(seed, image)  # the same seed again changes nothing
        errors.append(metrics.rel_mse(image, REFERENCE, none))
    found = sums.errors(REFERENCE, none)
    assert found["seeds_in_mean"] == count
    squared_bias, variance = seeds.bias_and_variance(float(np.mean(errors)), found["relmse_of_mean"], count)
    assert squared_bias == pytest.approx(bias**2 * weight, rel=0.1)
    assert variance == pytest.approx(deviation**2 * weight, rel=0.1)


def test_seeds_separate_bias_from_variance() -> None:
    none = np.zeros_like(REFERENCE)
    images = np.stack([noisy(0.2, seed) + 0.1 for seed in range(16)])
    spread = behind.Spread(images, (REFERENCE, none))
    bias, variance = spread.parts()
    assert spread.variance_map().mean() == pytest.approx(variance, rel=1e-3)
    assert spread.bias_map().mean() == pytest.approx(bias + variance / 16, rel=1e-3)


def test_crops_are_where_the_modes_differ() -> None:
    errors = [np.full((180, 320), 0.5) for _ in range(3)]
    errors[0][90:135, 160:240] = 0.3
    errors[1][0:45, 0:80] = 0.1
    errors[2][:, 300] = 1e6  # counts as 1
    assert crops.choose_crops(errors) == [(0, 0), (160, 90)]


def rows_of(mode: str, errors: list[float], samples: int = 16, **more: Any) -> list[dict]:
    return [
        {"scene": "hero", "mode": mode, "samples": samples, "seed": i, "relmse": error} | more
        for i, error in enumerate(errors)
    ]


def test_modes_are_compared_at_the_same_samples_and_seed() -> None:
    ours = [*rows_of("path", [1.0, 4.0, 9.0]), *rows_of("path", [3.0], samples=64), *rows_of("path", [1.0], samples=4)]
    theirs = [*rows_of("gradient-l2", [2.0, 2.0, 2.0, 0.1]), *rows_of("gradient-l2", [1.0], samples=64)]
    scene = results.SceneResults("hero", [*ours, *theirs])
    assert scene.same_samples_ratios("path", "gradient-l2") == {16: 2.0, 64: 3.0}
    assert scene.same_samples_ratios("path", "auto") == {}


def test_estimates_are_compared_with_the_error_of_their_own_image() -> None:
    scene = results.SceneResults("hero", [*rows_of("auto", [2.0], estimated=3.0), *rows_of("auto", [1.0], samples=64)])
    assert scene.estimate_ratio("auto") == 1.5
    assert scene.estimate_ratio("path") is None


def test_ratios_of_curves() -> None:
    """Twice as good at every time is twice as fast at every error, for errors that fall like 1/t."""
    ours = [(t, 0.5 / t) for t in (1.0, 4.0, 16.0)]
    theirs = [(t, 1.0 / t) for t in (2.0, 8.0, 32.0)]
    assert metrics.equal_time_ratio(ours, theirs) == pytest.approx(0.5)
    assert metrics.speed_up(ours, theirs) == pytest.approx(2.0)
    assert metrics.equal_time_ratio([(1.0, 1.0), (2.0, 0.5)], [(10.0, 1.0), (20.0, 0.5)]) is None


def test_a_single_sample_count_gives_no_ratio_at_equal_time() -> None:
    """Regression: results with equal samples counted as equal time if the time differed by less than a quarter."""
    assert metrics.equal_time_ratio([(1.2, 0.5)], [(1.0, 1.0)]) is None
    theirs = [(t, 1.0 / t) for t in (1.0, 4.0)]
    for time in (0.9, 1.2, 4.5):
        assert metrics.equal_time_ratio([(time, 0.5 / time)], theirs) == pytest.approx(0.5), (
            "the curve goes on to the time of the point"
        )
        assert metrics.equal_time_ratio(theirs, [(time, 0.5 / time)]) == pytest.approx(2.0)


def test_slope_is_that_of_the_last_decade() -> None:
    curve = [(0.01, 5.0), (0.1, 5.0), (1.0, 1.0), (3.0, 1.0 / 3.0), (10.0, 0.1)]
    assert metrics.slope(curve) == pytest.approx(-1.0)
    assert metrics.slope(curve[:1]) is None


def test_a_setting_that_does_not_exist_refuses_the_mode(scene: bpy.types.Scene) -> None:
    """Regression: Blender accepts any attribute, so that a temporal mode was measured without effect."""
    mode = modes.Mode("unknown", modes.GRADUS, {"use_more_light": True})
    with pytest.raises(ValueError, match="use_more_light"):
        modes.apply(scene, mode, 4, 0)


@pytest.mark.module
def test_settings_of_cycles_do_not_stay_for_the_next_mode(scene: bpy.types.Scene) -> None:
    found = {}
    for name in ("cycles-denoised", "cycles", "cycles-shipped"):
        modes.apply(scene, modes.MODES[name], 4, 0)
        found[name] = (scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling)
    shipped = tuple(scene.cycles.bl_rna.properties[name].default for name in ("use_denoising", "use_adaptive_sampling"))
    assert found == {"cycles-denoised": (True, False), "cycles": (False, False), "cycles-shipped": shipped}


def test_every_mode_has_a_reference() -> None:
    for mode in modes.MODES.values():
        assert modes.REFERENCES[mode.engine] in modes.MODES


def test_the_denoiser_is_measured_on_every_reconstruction() -> None:
    def reconstructions(denoiser: str) -> set[str]:
        settings = [mode.settings for mode in modes.MODES.values() if mode.engine == modes.GRADUS]
        return {found["reconstruction"] for found in settings if found["denoiser"] == denoiser}

    assert reconstructions("OIDN") == reconstructions("NONE") - {"AUTO"}


def test_a_slider_offers_all_pictures_and_crops() -> None:
    slider = document.Slider(
        {"pictures": {"a": "a.webp", "b": "b.webp"}, "errors": {"error of a": "a-error.webp"}},
        "Caption.",
        ("a", "error of a"),
        [document.Crop(0.25, 0.5, 4.0)],
        "scale.svg",
    )
    page = slider.as_html()
    assert page.count('<option value="a-error.webp"') == 2
    assert '<option value="a-error.webp" selected>' in page
    assert '<option value="scale(4) translate(-25%, -50%)">crop 1</option>' in page
    for file in ("a.webp", "b.webp", "a-error.webp", "scale.svg"):
        assert f"({file})" in slider.as_markdown()


def test_both_forms_of_the_report_say_the_same() -> None:
    blocks = [
        document.Text("# Title\n\n- one **bold**\n- two `a<b`"),
        document.Table(["x", "y"], [["1", "[there](other.html)"]]),
    ]
    assert "| 1 | [there](other.html) |" in document.to_markdown(blocks)
    page = document.to_html("Title", blocks, "", "")
    assert '<td>1</td><td><a href="other.html">there</a></td>' in page
    assert "<li>one <b>bold</b></li><li>two <code>a&lt;b</code></li>" in page


def test_sentences_in_a_table_wrap() -> None:
    """Regression: they stayed on one line, so that the first column had one word per line."""
    sentence = "3 of 13; median 0.98, most 2.42 (glass_and_chrome)"
    page = document.Table(["aim", "found"], [["R ≤ 1", sentence], ["R ≤ 2", "0.98 (0.97–1.01)"]]).as_html()
    assert f'<td class="long">{sentence}</td>' in page
    assert "<td>0.98 (0.97–1.01)</td>" in page


@pytest.fixture
def stored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Redirects the results of stills to a temporary file and returns it."""
    file = tmp_path / "results" / "stills.jsonl"
    for module in (results, stills_module()):
        monkeypatch.setattr(module, "STILLS", file)
    return file


def stills_module() -> Any:
    pytest.importorskip("PIL", reason="Pillow is in the environments of Blender modules only")
    import stills

    return stills


def test_results_are_appended_with_six_digits(tmp_path: Path) -> None:
    file = tmp_path / "results" / "part.jsonl"
    assert records.read(file) == []
    records.append({"relmse": 0.123456789, "range": (1.23456789, 2)}, file)
    records.append({"relmse": 2.0}, file)
    assert records.read(file) == [{"relmse": 0.123457, "range": [1.23457, 2]}, {"relmse": 2.0}]


def test_everything_is_written_to_folders_outside_git() -> None:
    ignored = (hosts.ROOT / ".gitignore").read_text().splitlines()
    assert "/out/" in ignored
    assert records.RESULTS.relative_to(hosts.ROOT).parts[:2] == ("out", "bench")


def test_only_runs_of_one_commit_and_blender_are_compared(stored: Path) -> None:
    """Runs in another Blender have other peers."""
    newest = {"version": "b", "blender": "5.2", "width": 160}
    older = [newest | {"version": "a"}, newest | {"blender": "4.5"}, newest | {"width": 320}]
    for conditions in (*older, newest):
        for mode in ("path", "cycles"):
            for row in rows_of(mode, [1.0], **conditions):
                records.append(row, stored)
    (scene,) = results.load()
    assert [(row["mode"], row["version"], row["blender"], row["width"]) for row in scene.rows] == [
        ("path", "b", "5.2", 160),
        ("cycles", "b", "5.2", 160),
    ]


def test_every_part_of_the_report_names_its_blender(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Regression: the tables of agreement and of the rooms did not say which Blender's Cycles they compare with."""
    report = report_module()
    agreements, costs = tmp_path / "agreement.jsonl", tmp_path / "speed.jsonl"
    records.append({"name": "hero", "share": 1.0, "ratio": 1.0, "reason": "", "blender": "4.5"}, agreements)
    for row in rows_of_room():
        records.append(row, costs)
    monkeypatch.setattr(report.agreement, "RESULTS", agreements)
    monkeypatch.setattr(speed, "RESULTS", costs)
    assert [row[-1] for row in report.agreements()[1].rows] == ["4.5"]
    assert "commit a, Blender 5.2" in report.rooms()[0].markdown


def report_module() -> Any:
    pytest.importorskip("PIL", reason="Pillow is in the environments of Blender modules only")
    pytest.importorskip("scipy", reason="SciPy is in the environment of bpy45 only")
    import report

    return report


def rows_of_room() -> list[dict]:
    """Returns one repeat of the smallest room by all engines."""
    size = {"room": "room-1k", "triangles": 1164, "width": 10, "height": 10, "version": "a", "blender": "5.2"}
    modes = [(mode, samples) for mode in rooms.ENGINES for samples in speed.SAMPLES]
    return [
        size | {"mode": mode, "samples": samples, "repeat": 0, "cpu": 5.0 + samples, "peak_memory_bytes": 1}
        for mode, samples in modes
    ]


def test_runs_that_are_stored_are_not_repeated(stored: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stills = stills_module()
    (hero,) = (scene for scene in scenes.SCENES if scene.name == "hero")
    for row in rows_of("path", [1.0, 2.0], version="a", blender="5.2", width=160):
        records.append(row, stored)
    found = {}
    for blender in ("5.2", "4.5"):
        monkeypatch.setattr(hosts, "peer", lambda blender=blender: blender)
        found[blender] = stills.done_jobs(hero, 160, "a")
    assert found == {"5.2": {stills.Job(0, 16, "path"), stills.Job(1, 16, "path")}, "4.5": set()}


@pytest.mark.parametrize("newest", [True, False])
def test_peers_are_those_of_the_newest_blender_if_it_is_there(
    newest: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(hosts, "ROOT", tmp_path)
    if newest:
        (tmp_path / ".venv" / "bpy52").mkdir(parents=True)
        (tmp_path / ".venv" / "bpy52" / ".stamp").touch()
    hosts.peer.cache_clear()
    try:
        assert hosts.peer() == ("5.2" if newest else "4.5")
        assert hosts.module_command(Path("worker.py"))[0].endswith(
            "bpy52/bin/python3" if newest else "bpy45/bin/python3"
        )
    finally:
        hosts.peer.cache_clear()
    assert ("peers are those of 4.5" in capsys.readouterr().err) == (not newest)


def test_costs_are_ratios_within_a_repeat() -> None:
    """Export and build take the same time for both sample counts, so the slope is free of them."""

    def row(mode: str, samples: int, repeat: int, cpu: float) -> dict:
        size = {"room": "room-1k", "width": 10, "height": 10, "version": "a", "blender": "5.2"}
        return size | {"mode": mode, "samples": samples, "repeat": repeat, "cpu": cpu, "peak_memory_bytes": 1}

    rows = []
    for repeat, slow in enumerate((1.0, 2.0)):
        for mode, cost in (("path", 1.0), ("cycles", 4.0)):
            rows += [row(mode, samples, repeat, 5.0 + slow * cost * samples) for samples in speed.SAMPLES]
    found = speed.costs(rows)["room-1k"]
    assert found["path"].per_sample == pytest.approx({0: 1e4, 1: 2e4})
    assert found["cycles"].over(found["path"]) == pytest.approx((4.0, 4.0, 4.0))
    assert found["cycles"].total_over(found["path"])[0] < 4.0


class FakeRenderers:
    """Renders a gray of 0.5 with noise whose variance for one sample is 0.04 (Gradus) or 0.08, and a fixed cost."""

    def __init__(self, _: scenes.Scene, size: tuple[int, int]) -> None:
        self.size = size

    def refusal(self, mode: str) -> str:
        return "no guiding here" if mode == "cycles-guided" else ""

    def render(self, mode: str, samples: int, seed: int) -> tuple[np.ndarray, dict[str, float]]:
        known = {"path": (0.04, 1e-6), "path-guided": (0.032, 2e-6), "cycles": (0.08, 4e-6)}
        variance, cost = known.get(mode, (0.0, 1e-6))
        noise = np.random.default_rng(seed).normal(scale=(variance / samples) ** 0.5, size=(*self.size[::-1], 3))
        return 0.5 + noise, {"cpu": 3.0 + cost * samples * self.size[0] * self.size[1]}

    def close(self) -> None:
        pass


def test_plain_paths_are_compared_by_variance_and_time_of_a_sample(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(path_tracing, "Renderers", FakeRenderers)
    monkeypatch.setattr(path_tracing, "RESULTS", tmp_path / "path_tracing.jsonl")
    arguments = argparse.Namespace(width=320, samples=16, seeds=3, modes=list(path_tracing.MODES))
    for _ in range(2):
        path_tracing.bench_scene(scenes.SCENES[0], arguments, "a", 0.0)
    (row,) = path_tracing.load()
    assert "no guiding here" in capsys.readouterr().out
    assert path_tracing.median_of(row, "path", "seconds") == pytest.approx(1e-6)
    assert path_tracing.median_of(row, "path", "variance") == pytest.approx(0.04 / 0.251, rel=0.02)
    found = path_tracing.ratios(row, "path", "cycles")
    assert found is not None
    assert found["seconds"] == pytest.approx(0.25)
    assert found["work"] == pytest.approx(0.125, rel=0.02)
    assert path_tracing.ratios(row, "path-guided", "cycles-guided") is None
    table = report_module().plain_paths()[1]
    assert table.rows[0][0] == "hero"
    assert table.rows[0][1] == "0.25"
    assert table.rows[0][5:] == ["0.20", "–", "1.00"]
    tested = {name: (text, met) for name, _, (text, met) in targets.plain_paths()}
    times = tested["PT in scenes: CPU time per sample / Cycles ≤ 0.8"]
    assert times == ("1 of 1; median 0.25, worst 0.25 (hero)", True)
    assert tested["guided PT: median variance × time / Cycles ≤ 0.6"][1] is True
    assert tested["guided PT: median variance × time / guided Cycles ≤ 0.6"] == bounds.NOT_MEASURED


def test_guided_modes_bring_those_without_a_guide() -> None:
    assert path_tracing.modes_of("cycles-guided,path") == ["path", "cycles", "cycles-guided"]


def test_values_are_tested_against_bounds() -> None:
    values = {"a": 0.5, "b": 1.0, "c": -3.0}
    assert bounds.every(values, 0.9) == ("2 of 3; median 0.50, worst 1.00 (b)", False)
    assert bounds.at_least(values, -3.0) == ("3 of 3; median 0.50, lowest -3.00 (c)", True)
    assert bounds.within(values, 1.0) == ("2 of 3; -300.0 % (c) to +100.0 % (b)", False)
    assert bounds.median(values, 0.5) == ("0.50 over 3", True)


def test_starts_are_those_of_the_newest_commit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speed, "STARTS", tmp_path / "start.jsonl")
    assert targets.start("room-2m", 0.7) == bounds.NOT_MEASURED
    for version, mode, cpu in (("a", "path", 9.0), ("b", "path", 1.0), ("b", "cycles", 2.0)):
        row = {"room": "room-2m", "version": version, "blender": "5.2", "mode": mode, "repeat": 0, "cpu": cpu}
        records.append(row, speed.STARTS)
    assert targets.start("room-2m", 0.7) == ("0.50 (0.50–0.50)", True)


def test_plain_paths_of_other_conditions_are_not_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(path_tracing, "RESULTS", tmp_path / "path_tracing.jsonl")
    assert path_tracing.newest() == []
    values = {name: [1.0] for name in path_tracing.MEASURES}
    setup = {"width": 640, "samples": 16, "seeds": 2, "blender": "5.2", "machine": "m"}
    for scene, version, mode in (("a", "1", "path"), ("b", "2", "path"), ("c", "2", "cycles"), ("c", "2", "path")):
        row = setup | {"scene": scene, "version": version, "modes": {mode: values}}
        records.append(row, path_tracing.RESULTS)
    assert [row["scene"] for row in path_tracing.newest()] == ["b", "c"]
