"""Tests of the motion benchmark: its measures on known motion, its modes, its report, and a tiny run."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools" / "bench"))
pytest.importorskip("PIL", reason="Pillow is in the environments of Blender modules only")
pytest.importorskip("scipy", reason="SciPy is in the environment of bpy45 only")
import animation_variants as variants  # noqa: E402
import document  # noqa: E402
import motion_metrics as metrics  # noqa: E402
import motion_modes  # noqa: E402
import motion_pictures as pictures  # noqa: E402
import motion_report as report  # noqa: E402

HEIGHT, WIDTH = 36, 64
SHIFT = (3.25, -1.5)  # pixels to the right, and up


def waves(right: float = 0.0, up: float = 0.0) -> np.ndarray:
    """Returns a smooth picture shifted by this distance."""
    rows, columns = np.indices((HEIGHT, WIDTH)).astype(float)
    return 1.0 + 0.4 * np.sin(0.4 * (columns - right)) * np.cos(0.3 * (rows + up))


def forward(right: float, up: float) -> np.ndarray:
    """Returns the motion as passes have it: current − next."""
    return np.broadcast_to(np.array((-right, -up)), (HEIGHT, WIDTH, 2))


def motion_of(own: np.ndarray, frames: int = 2) -> metrics.Passes:
    """Returns passes that are the same in all frames: a reflection moves by `own`, and surfaces are static.

    The light on the reflected surfaces is static, too.
    """
    motion = np.broadcast_to(np.concatenate([own, own], axis=-1), (frames, HEIGHT, WIDTH, 4)).copy()
    passes = {"Vector": np.zeros_like(motion), "Path Reflection Motion": motion}
    passes["Path Reflection Irradiance Motion"] = np.zeros_like(motion)
    for what in ("", "Irradiance "):
        passes[f"Path Reflection {what}Tracked"] = np.ones((frames, HEIGHT, WIDTH, 1))
    return passes


def renderings_of(
    now: np.ndarray, following: np.ndarray, deviation: float = 0.0, count: int = 4
) -> list[metrics.Passes]:
    """Returns renders of two frames of a reflection."""
    random = np.random.default_rng(1)
    both = np.stack([now, following])[..., None] * np.ones(3)
    passes = {"Path Reflection Reflectance": 0.5 * both, "Path Reflection Irradiance": np.ones_like(both)}
    noise = [deviation * random.normal(size=(2, HEIGHT, WIDTH, 1)) for _ in range(count)]
    return [passes | {"Path Reflection": both + n, "Combined": both + n} for n in noise]


def predicted(own: np.ndarray, following: np.ndarray, deviation: float = 0.0, kind: str = "") -> dict[str, Any]:
    motion = metrics.of_frame(motion_of(own), 0)
    return metrics.predict(motion, renderings_of(waves(), following, deviation), "Reflection")[kind].row()


def test_the_right_vectors_predict_the_next_frame_and_the_surface_does_not() -> None:
    found = predicted(forward(*SHIFT), waves(*SHIFT))
    assert found["all"]["own"] > 0.99
    assert found["all"]["surface"] < 0.2
    assert found["moving"]["pixels"] == found["all"]["pixels"] > 0.8 * HEIGHT * WIDTH, (
        "what leaves the picture does not count"
    )
    assert found["lit"] == HEIGHT * WIDTH


def test_vectors_of_the_wrong_sign_predict_nothing() -> None:
    assert predicted(-forward(*SHIFT), waves(*SHIFT))["all"]["own"] < 0.2


def test_noise_of_independent_renderings_is_no_error_of_prediction() -> None:
    """Each component is wrong by 4 %, their mean by 2 %."""
    found = predicted(forward(*SHIFT), waves(*SHIFT), deviation=0.04)
    assert found["all"]["own"] > 0.9
    assert found["all"]["noise"] > 0.9
    loud = predicted(forward(*SHIFT), waves(*SHIFT), deviation=0.4)
    assert loud["all"]["noise"] < 0.8, "too much noise must be visible in the limit"


def test_light_that_changes_is_an_error_of_prediction() -> None:
    assert predicted(forward(*SHIFT), 1.05 * waves(*SHIFT), deviation=0.02)["all"]["own"] < 0.1


def test_changing_light_is_no_error_of_reflectance() -> None:
    """Reflectance moves with the surface while the light changes."""
    renderings = renderings_of(waves(), waves(*SHIFT))
    for rendering in renderings:
        rendering["Path Reflection"] = rendering["Path Reflection"] * np.array((1.0, 1.2))[:, None, None, None]
    found = metrics.predict(metrics.of_frame(motion_of(forward(*SHIFT)), 0), renderings, "Reflection")
    assert found[""].row()["all"]["own"] < 0.1
    assert found["reflectance"].row()["all"]["own"] > 0.99


def test_irradiance_is_predicted_by_its_own_motion() -> None:
    """A shadow moves to the left over a surface that moves to the right."""
    renderings, passes = renderings_of(waves(), waves(*SHIFT)), motion_of(forward(*SHIFT))
    for rendering in renderings:
        rendering["Path Reflection Irradiance"] = np.stack([waves(), waves(-4.0, 2.0)])[..., None] * np.ones(3)
    passes["Path Reflection Irradiance Motion"][..., 2:] = forward(-4.0, 2.0)
    passes["Path Reflection Irradiance Tracked"][:, :10] = -9.0
    found = metrics.predict(metrics.of_frame(passes, 0), renderings, "Reflection")["irradiance"]
    shares = found.row()
    assert shares["all"]["own"] > 0.99
    assert shares["all"]["surface"] < 0.2
    assert not found.counts[:10].any(), "flow did not find it"
    assert shares["moving"]["pixels"] == shares["all"]["pixels"] < 0.8 * shares["lit"]


def test_pixels_without_a_track_do_not_count() -> None:
    passes = motion_of(forward(*SHIFT))
    passes["Path Reflection Tracked"][0, :, : WIDTH // 2] = -4.0
    found = metrics.predict(metrics.of_frame(passes, 0), renderings_of(waves(), waves(*SHIFT)), "Reflection")
    assert found[""].counts[:, : WIDTH // 2].sum() == 0


def test_pixels_count_where_both_motions_lead_into_the_picture() -> None:
    """Regression: a surface vector that leaves the picture counted as an error of 100 % and spread to others."""
    passes = motion_of(forward(0.0, 0.0))
    passes["Vector"][0, :, WIDTH // 2 :, 2] = -WIDTH
    found = metrics.predict(metrics.of_frame(passes, 0), renderings_of(waves(), waves()), "Reflection")[""]
    assert not found.counts[:, WIDTH // 2 :].any()
    assert found.row()["all"]["surface"] == 1.0
    assert found.row()["all"]["pixels"] == HEIGHT * WIDTH // 2


def test_components_are_those_with_a_pass_tracked() -> None:
    """Irradiance has a motion of its own, but it is no component."""
    assert metrics.components(motion_of(forward(0.0, 0.0))) == ["Reflection"]


def test_component_vectors_are_those_of_what_a_pixel_mostly_shows() -> None:
    passes = motion_of(forward(*SHIFT)) | renderings_of(waves(), waves())[0]
    passes["Combined"] = passes["Path Reflection"] * np.where(np.arange(WIDTH) < 20, 4.0, 1.0)[:, None]
    vectors = metrics.component_vectors(passes)
    assert (vectors[:, :, :20] == metrics.UNTRACKED).all()
    np.testing.assert_array_equal(vectors[:, :, 20:], passes["Path Reflection Motion"][:, :, 20:])


def test_an_error_that_moves_with_the_image_does_not_flicker() -> None:
    """The reflection and its error move by two pixels to the right; along the static surface, the error flickers."""
    frames = [waves(2.0 * k) for k in range(3)]
    reference = np.ones((3, HEIGHT, WIDTH, 3))
    images = reference + 0.1 * (np.stack(frames)[..., None] - 1.0)
    own = np.broadcast_to(np.array((-2.0, 0.0, -2.0, 0.0)), (3, HEIGHT, WIDTH, 4))
    still = [
        metrics.flicker_measures(images, reference, np.zeros_like(images), vectors)["flicker_component"]
        for vectors in (own, 0.0 * own)
    ]
    assert still[0] < 1e-9
    assert still[1] > 1e-5


def test_pixels_that_are_not_finite_are_named() -> None:
    """Regression: a mean with the other values hid them."""
    images = np.ones((2, HEIGHT, WIDTH, 3))
    metrics.check_finite(images, "windows-l2")
    images[1, 3, 4] = np.nan
    images[0, 3, 4, 0] = np.inf
    with pytest.raises(RuntimeError, match=f"windows-l2: 2 of {2 * HEIGHT * WIDTH} pixels are not finite"):
        metrics.check_finite(images, "windows-l2")


def test_flicker_of_a_picture_that_is_not_finite_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The error message names mode, scene and samples."""
    import motion

    images = np.ones((2, HEIGHT, WIDTH, 3))
    converged = SimpleNamespace(mean=images, variance=0.0 * images, samples=8)
    monkeypatch.setattr(motion, "reference", lambda *_: converged)
    bench = SimpleNamespace(
        animation=SimpleNamespace(name="box"), samples=8, _component_vectors=lambda: np.zeros((2, HEIGHT, WIDTH, 4))
    )
    bench.renderer = SimpleNamespace(
        render=lambda *_: (images * np.where(np.arange(WIDTH) == 0, np.nan, 1.0)[:, None], {})
    )
    with pytest.raises(RuntimeError, match=f"windows-l2 in box, 4 samples, seed 1: {2 * HEIGHT} of"):
        next(motion.MotionBench._flicker(bench, motion.Job("flicker", "windows-l2", 4, 1)))


@pytest.mark.parametrize("mode", motion_modes.FLICKER)
def test_every_mode_is_compared_with_windows_along_surfaces(mode: str) -> None:
    """Returns rows without components, and rows of components."""
    settings = motion_modes.MODES[mode].settings
    combined, components = (
        motion_modes.MODES[of(mode)].settings for of in (motion_modes.compared_with, motion_modes.along_surfaces)
    )
    assert (combined["use_temporal"], combined["use_decomposition"]) == (True, False)
    assert (components["use_temporal"], components["use_decomposition"], components["component_replays"]) == (
        True,
        True,
        False,
    )
    assert {other["reconstruction"] for other in (combined, components)} == {settings["reconstruction"]}
    assert {other["integrator"] for other in (combined, components)} == {settings["integrator"]}
    assert "use_temporal" in settings and "use_decomposition" in settings, "modes follow one another in one scene"  # noqa: PT018


def flicker_row(mode: str, flicker: float, seed: int = 0, **more: Any) -> dict:
    row = {
        "measure": "flicker",
        "scene": "mirror_and_glass",
        "frames": [10, 15],
        "width": 320,
        "height": 180,
        "shutter": 0.0,
    }
    row |= {"mode": mode, "samples": 16, "seed": seed, "version": "new", "blender": "5.2", "cpu": 6.0}
    return (
        row
        | {name: flicker for name in ("flicker_component", "flicker_component_moving", "relmse_specular", "relmse")}
        | more
    )


def tables(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *rows: dict) -> list[document.Table]:
    file = tmp_path / "motion.jsonl"
    file.write_text("".join(json.dumps(row) + "\n" for row in rows))
    monkeypatch.setattr(report, "RESULTS", file)
    return [block for block in report.blocks() if isinstance(block, document.Table)]


def column(table: document.Table, name: str) -> dict[str, str]:
    """Returns the rows by the labels of their modes."""
    return {row[table.columns.index("mode")]: row[table.columns.index(name)] for row in table.rows}


LABELS = {name: mode.label for name, mode in motion_modes.MODES.items()}
TIMES = ("CPU-s a frame", "F at equal time / windows", "F at equal time / components along surfaces")


def test_the_default_of_animations_is_among_the_usual_modes() -> None:
    assert motion_modes.DELIVERED in motion_modes.USUAL
    assert set(motion_modes.USUAL) < set(motion_modes.FLICKER)


def test_flicker_is_relative_to_windows_of_the_same_seed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [
        flicker_row("windows-l2", 1.0),
        flicker_row("windows-l2", 4.0, 1),
        flicker_row("windows-components-l2", 0.5),
    ]
    table = tables(tmp_path, monkeypatch, *rows, flicker_row("windows-components-surfaces-l2", 0.8))[-1]
    assert column(table, "F / windows")[LABELS["windows-components-l2"]] == "0.500"
    assert column(table, "F / components along surfaces")[LABELS["windows-components-l2"]] == "0.625"


def test_times_of_a_loaded_machine_are_not_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = {"windows-l2": 1.0, "windows-components-surfaces-l2": 1.0, "windows-components-l2": 0.5}
    for more, expected in (({}, True), ({"loaded": True}, False)):
        runs = [
            flicker_row(mode, flicker / n, samples=n, cpu=0.5 * n, **more)
            for mode, flicker in rows.items()
            for n in (4, 16)
        ]
        table = tables(tmp_path, monkeypatch, *runs)[-1]
        assert all((cell != "–") == expected for name in TIMES for cell in column(table, name).values())
    assert column(table, "F / windows")[LABELS["windows-components-l2"]] == "0.500", (
        "samples are the same on any machine"
    )


def test_flicker_at_equal_time_includes_the_time_of_components(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Flicker is halved at equal samples and takes a fifth more time. A single sample count gives no ratio."""
    name = "F at equal time / windows"
    for counts, expected in (((16,), "–"), ((4, 16), "0.600")):
        rows = [flicker_row("windows-l2", 1.0 / n, samples=n, cpu=float(n)) for n in counts]
        rows += [flicker_row("windows-components-l2", 0.5 / n, samples=n, cpu=1.2 * n) for n in counts]
        assert column(tables(tmp_path, monkeypatch, *rows)[-1], name)[LABELS["windows-components-l2"]] == expected


def test_bars_of_flicker_name_scenes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    flickers = {"mirror_and_glass": 0.5, "moving-box": 1.021, "animated": 0.9}
    rows = [flicker_row("windows-components-surfaces-auto", 1.0, scene=scene) for scene in flickers]
    rows += [flicker_row("windows-components-auto", flicker, scene=scene) for scene, flicker in flickers.items()]
    table = tables(tmp_path, monkeypatch, *rows)[-2]
    (flicker, _) = table.rows
    assert flicker[1:5] == ["components along surfaces", "F at equal samples", "3", "0.900"]
    assert flicker[5:] == ["0.500 (mirror_and_glass)", "1.021 (moving-box)", "mirror_and_glass", "moving-box"]


def test_the_newest_version_of_a_part_replaces_the_one_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [flicker_row("windows-l2", 1.0, version="old"), flicker_row("windows-components-l2", 1.0, version="old")]
    table = tables(tmp_path, monkeypatch, *rows, flicker_row("windows-l2", 2.0))[-1]
    assert list(column(table, "F along").values()) == ["2.0000", "1.0000"]


def test_versions_are_not_compared_with_each_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Results of other commits may be of other pixels, and results in another Blender have other peers."""
    modes = ("windows-l2", "windows-components-l2")
    rows = [flicker_row(mode, 1.0 / n, version="old", samples=n, cpu=float(n)) for mode in modes for n in (4, 16)]
    newer = [flicker_row("windows-l2", 2.0 / n, samples=n, cpu=float(n)) for n in (4, 16)]
    elsewhere = [row | {"version": "old", "blender": "4.5"} for row in newer]
    for more, expected in (([], "1.000"), (newer, "–"), (elsewhere, "–")):
        made = tables(tmp_path, monkeypatch, *rows, *more)[-1]
        for name in ("F / windows", "relMSE / windows", "F at equal time / windows"):
            assert column(made, name)[LABELS["windows-components-l2"]] == expected


def test_another_size_of_truth_replaces_that_of_the_version_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "motion.jsonl"
    rows = [
        flicker_row("", 0.0, version=version, width=width) | {"measure": "truth"}
        for version, width in (("old", 160), ("new", 320))
    ]
    file.write_text("".join(json.dumps(row) + "\n" for row in rows))
    monkeypatch.setattr(report, "RESULTS", file)
    assert [row["width"] for row in report.load()["truth"]] == [320]


def test_a_quiet_run_replaces_a_loaded_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Regression: times of the quiet run were never shown, and its jobs counted as done."""
    import motion

    loaded, quiet = flicker_row("windows-l2", 1.0, loaded=True, frame=0), flicker_row("windows-l2", 2.0, frame=0)
    assert list(column(tables(tmp_path, monkeypatch, loaded, quiet)[-1], "F along").values()) == ["2.0000"]
    monkeypatch.setattr(motion, "RESULTS", tmp_path / "motion.jsonl")
    monkeypatch.setattr(motion.hosts, "peer", lambda: "5.2")
    (animation,) = motion.select(motion.ANIMATIONS, "mirror_and_glass", 6)
    for row, done in ((loaded, 0), (quiet, 1)):
        motion.RESULTS.write_text(json.dumps(row) + "\n")
        assert len(motion.done_jobs(animation, variants.Variant((320, 180), 6), "new", loaded=False)) == done


def cost_row(mode: str, **seconds: float) -> dict:
    times = {"sample": 1.0, "reconstruct": 0.5, "correspondence": 0.0} | seconds
    return flicker_row(mode, 0.0) | {"measure": "cost", "seconds": times, "frame": 12}


def test_costs_are_ratios(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [
        cost_row("combined"),
        cost_row("components", sample=1.04, reconstruct=0.7),
        cost_row("components-surfaces", sample=1.1),
    ]
    rows += [cost_row("components-motion", sample=2.0, correspondence=0.062)]
    table = tables(tmp_path, monkeypatch, *rows)[-1]
    assert table.rows == [["mirror_and_glass", "1.040", "1.100", "1.400", "0.031", "1"]]
    text = next(block.markdown for block in report.blocks() if "### Cost" in block.as_markdown())
    assert "Missed: motion / sampling in mirror_and_glass (0.031)." in text
    assert len(tables(tmp_path, monkeypatch, *(row | {"loaded": True} for row in rows))) == 1, (
        "no ratio of a loaded machine"
    )


def truth_row(component: str, tracked: int) -> dict:
    check = {"searched": 10, "exist": 10, "tracked": 10, "error": {"median": 0.01, "quantile_95": 0.02}}
    return flicker_row("", 0.0) | {
        "measure": "truth",
        "component": component,
        "chains": 10000,
        "pixels": {"tracked": tracked},
        "check": check,
    }


def test_components_of_which_too_little_is_tracked_are_named() -> None:
    text = report.about_truth([truth_row("Reflection", 9499), truth_row("Transmission", 9500)]).markdown
    assert (
        "tracked in 1, and 95 % of those that can be followed in 2. "
        "Fewer of all pixels: mirror_and_glass, Reflection (94.99 %)." in text
    )


def prediction_row(component: str, own: float, surface: float, pixels: int = 1000) -> dict:
    shares = {"pixels": pixels, "own": own, "surface": surface, "noise": 1.0, "median": 0.01}
    kinds = {f"{kind}{key}": shares for kind in ("", "reflectance_", "irradiance_") for key in ("all", "moving")}
    return flicker_row("components", 0.0) | {"measure": "prediction", "component": component} | kinds | {"lit": 2000}


def test_predictions_are_summed_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [
        prediction_row("Reflection", 0.96, 0.48),
        prediction_row("Transmission", 0.3, 0.4),
        prediction_row("Residual", 0.5, 0.25, 10),
    ]
    texts = [text.markdown for text in report.about_prediction(rows)]
    assert "of light in 1 of 3 (1 up to the limit of noise), of reflectance in 1 of 3" in texts[0]
    assert "of irradiance in 1 of 3" in texts[0]
    extremes = (
        "lowest 0.75 (mirror_and_glass, Transmission), highest 2.00 (mirror_and_glass, Reflection); fewer in 1 of 2; "
    )
    assert [extremes in text for text in texts] == [False, True, True], "ten pixels of Residual are too few"
    more = report.about_prediction([*rows, prediction_row("Transmission", 0.1, 0.0) | {"scene": "moving-box"}])
    assert "fewer in 1 of 3; no ratio in 1, where" in more[1].markdown
    made = tables(tmp_path, monkeypatch, *rows)[-3:]
    assert [table.rows[0][4:7] for table in made] == [["50.0 %", "96.0 %", "48.0 %"], *[["–", "96.0 %", "48.0 %"]] * 2]


def test_the_wheel_has_the_colours_of_the_maps() -> None:
    """Motion to the right has the colour at the right of the wheel."""
    passes = metrics.of_frame(motion_of(forward(*SHIFT)), 0)
    passes["Path Reflection Motion"] = np.broadcast_to(np.array((-4.0, 0.0, -4.0, 0.0)), (HEIGHT, WIDTH, 4))
    shown = pictures.component_sheet.motion(passes, "Reflection")
    wheel = np.asarray(pictures.wheel(4.0)) / 255.0
    np.testing.assert_allclose(shown[0, 0], wheel[pictures.WHEEL // 2, -1], atol=0.01)
    assert np.abs(shown[0, 0] - wheel[pictures.WHEEL // 2, 0]).max() > 0.5


def strip_of(frames: int) -> metrics.Passes:
    """Returns a reflection that moves right by two pixels a frame, in the left half; its surface is static."""
    light = np.stack([waves(2.0 * k) for k in range(frames)])[..., None] * np.ones(3)
    light[:, :, WIDTH // 2 :] = 0.0
    return motion_of(forward(2.0, 0.0), frames) | {
        "Path Reflection": light,
        "Path Transmission": 0.5 * light,
        "Combined": light + 0.1,
    }


def test_strips_show_the_difference_from_the_next_frame_by_both_motions() -> None:
    passes = strip_of(3)
    own, surface, counts = pictures.differences(passes, "Reflection", 1)
    assert not counts[:, WIDTH // 2 :].any(), "there is no light"
    assert own[counts & (np.arange(WIDTH) < WIDTH // 2 - 8)].max() < 1e-4
    assert np.sqrt(surface[counts].mean()) > 0.1
    shown = np.asarray(pictures.strip(passes, "Reflection"))
    assert shown.shape == (3 * (HEIGHT + pictures.HEADER) - pictures.GAP, 3 * (WIDTH + pictures.GAP) - pictures.GAP, 3)
    rows = [pictures.HEADER - pictures.GAP + row * (HEIGHT + pictures.HEADER) for row in range(3)]
    beneath = [shown[top : top + HEIGHT, : WIDTH // 2 - 8].mean() for top in rows[1:]]
    assert beneath[0] < 0.5 * beneath[1], "errors are bright"
    assert (shown[rows[1] : rows[1] + HEIGHT, 2 * (WIDTH + pictures.GAP) :] == 255).all(), (
        "nothing follows the last frame"
    )


def test_strips_show_the_brightest_reflection_or_refraction() -> None:
    passes = strip_of(2)
    assert pictures.brightest(passes) == "Reflection"
    assert pictures.brightest(passes | {"Path Transmission": 3.0 * passes["Path Reflection"]}) == "Transmission"
    assert pictures.brightest({"Path Diffuse": passes["Combined"]}) == ""


def arguments_of(**more: Any) -> SimpleNamespace:
    import motion

    usual = {
        "measures": list(motion.MEASURES), "size": None, "frames": 6, "blur": False, "seeds": 1, "repeats": 3,
        "samples": [4, 16],
        "modes": list(motion_modes.USUAL), "light": 256, "loaded": False, "reference": 512,
    }  # fmt: skip
    return SimpleNamespace(**usual | more)


def test_flicker_is_of_small_pictures_and_the_others_of_large_ones(capsys: pytest.CaptureFixture[str]) -> None:
    import motion

    sizes = {variant.size: measures for variant, measures in motion.measures_by_variant(arguments_of()).items()}
    assert sizes == {(160, 90): ["flicker"], (320, 180): ["truth", "prediction", "cost"]}
    assert list(motion.measures_by_variant(arguments_of(size=(64, 36))).values()) == [list(motion.MEASURES)]
    assert not capsys.readouterr().out


def test_motion_blur_is_for_truth_and_cost_alone(capsys: pytest.CaptureFixture[str]) -> None:
    """With motion blur a pixel has more than one vector, so that the other measures have no meaning."""
    import motion

    ((variant, measures),) = motion.measures_by_variant(arguments_of(blur=True)).items()
    assert variant.shutter == 0.5
    assert measures == ["truth", "cost"]
    assert [line.split(":")[0] for line in capsys.readouterr().out.splitlines()] == ["SKIP prediction", "SKIP flicker"]


def test_passes_whose_cost_is_measured_are_requested() -> None:
    """Regression: without their passes, no component is computed, so that the measured cost was zero."""
    import motion

    asked = {mode: set(passes) for mode, (_, passes) in motion.COST_MODES.items()}
    assert not asked["combined"]
    assert all("components" in passes for mode, passes in asked.items() if mode != "combined")
    assert asked["components-motion"] - asked["components"] == {"component_motion"}
    assert asked["components-surfaces"] - asked["components"] == {"component_reflectance", "component_normal"}
    (animation,) = motion.select(motion.ANIMATIONS, "mirror_and_glass", 6)
    jobs = motion.jobs_of(animation, arguments_of(repeats=2), ["cost"])
    assert [(job.mode, job.seed) for job in jobs] == [(mode, seed) for seed in range(2) for mode in asked]


@pytest.mark.module
def test_passes_that_are_not_wanted_are_off(scene: bpy.types.Scene) -> None:
    import motion_worker

    layer = scene.view_layers[0]
    known = {
        switch.identifier
        for switch in layer.gradus.bl_rna.properties
        if switch.identifier.startswith("use_pass_component")
    }
    assert {f"use_pass_{name}" for name in motion_worker.COMPONENT_SWITCHES} == known
    motion_worker.set_passes(layer, motion_worker.SWITCHES)
    assert layer.use_pass_vector
    assert all(getattr(layer.gradus, name) for name in known)
    motion_worker.set_passes(layer, ["components"])
    assert not layer.use_pass_vector
    assert [name for name in known if getattr(layer.gradus, name)] == ["use_pass_components"]
    with pytest.raises(ValueError, match="component_color"):
        motion_worker.set_passes(layer, ["component_color"])


@pytest.mark.module
def test_a_tiny_run_fills_all_tables(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Measures the sample with the mirror ball; a second run does nothing."""
    import animation_references
    import motion
    import motion_renderer

    if not motion_renderer.TOOL.exists():
        pytest.skip("needs build/native/gradus (tools/build.sh)")
    results = tmp_path / "motion.jsonl"
    for module in (motion, report):
        monkeypatch.setattr(module, "RESULTS", results)
    monkeypatch.setattr(animation_references, "CACHE", tmp_path)
    monkeypatch.setattr(animation_references, "PART", 2)
    for module in (pictures, report):
        monkeypatch.setattr(module, "OUT", tmp_path)
    monkeypatch.setattr(motion, "CHECKED", 8)
    (animation,) = motion.select(motion.ANIMATIONS, "mirror_and_glass", 2)
    modes = ["frames-l2", "windows-l2", "windows-components-auto"]
    # In smaller pictures a pixel covers so much of the texture that flow finds nothing to follow.
    arguments = arguments_of(size=(96, 54), frames=2, repeats=1, reference=8, light=8, samples=[2], modes=modes)
    for _ in range(2):
        motion.bench_motion(animation, arguments, "version", float("inf"))
    rows = [json.loads(line) for line in results.read_text().splitlines()]
    counts = {part: sum(row["measure"] == part for row in rows) for part in motion.MEASURES}
    assert (counts["flicker"], counts["cost"]) == (3, 4)
    seconds = {row["mode"]: row["seconds"] for row in rows if row["measure"] == "cost"}
    assert [mode for mode, found in seconds.items() if found["correspondence"] > 0.0] == ["components-motion"]
    assert counts["truth"] >= 3 and counts["prediction"] >= 3  # noqa: PT018
    reflected = next(row for row in rows if (row["measure"], row["component"]) == ("truth", "Reflection"))
    assert reflected["check"]["error"]["quantile_95"] < 0.5
    predictions = {row["component"]: row for row in rows if row["measure"] == "prediction"}
    assert predictions["Residual"]["all"]["pixels"] > 0, "its motion is found by flow, which needs neighbouring frames"
    assert predictions["Diffuse"]["irradiance_all"]["pixels"] > 0
    assert all((tmp_path / of(animation.name)).exists() for of in (pictures.file_name, pictures.strip_name))
    files = [block.file for block in report.blocks() if isinstance(block, document.Figure)]
    assert files[1:] == [pictures.file_name(animation.name), pictures.strip_name(animation.name)]
    assert len([block for block in report.blocks() if isinstance(block, document.Table)]) == 8
    assert variants.of_row(rows[0]).size == (96, 54)
