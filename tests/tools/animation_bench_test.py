"""Tests of the animation benchmark: its modes, its report on stored rows, and its strips."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools" / "bench"))
pytest.importorskip("PIL", reason="Pillow is in the environments of Blender modules only")
import animation_modes  # noqa: E402
import animation_references as references  # noqa: E402
import animation_report as report  # noqa: E402
import animation_scenes  # noqa: E402
import animation_strips as strips  # noqa: E402
import animation_variants as variants  # noqa: E402
import document  # noqa: E402
import figures  # noqa: E402


def rows(mode: str, flicker: float, version: str = "new", **more: Any) -> list[dict]:
    """Returns measures of two seeds that fall as 1/t; the first seed has none of those that need two."""
    found = []
    for seed in range(2):
        for samples in (4, 16):
            row = {"scene": "light-off", "frames": [1, 24], "width": 640, "height": 360, "shutter": 0.0, "mode": mode}
            row |= {"version": version, "blender": "5.2", "samples": samples, "seed": seed, "checked": [9, 16]}
            row |= {"mean_light": 0.9 + 0.2 * seed, "sampling": 0.1 * samples, "flip": 0.1 * flicker}
            measures = {
                f"{measure}{part}": size * flicker / samples
                for measure, size in (("flicker", 1.0), ("relmse", 0.5))
                for part in ("", "_trimmed", "_noise", "_noise_trimmed")
            }
            row |= measures | dict.fromkeys(BIAS, 0.0) if seed else {}
            found.append(row | {"cpu": 0.1 * samples, "reference_samples": 256} | more)
    return found


BIAS = [f"{measure}_{part}" for measure in ("relmse", "flicker") for part in ("bias", "bias_error", "bias_trimmed")]


def stored(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *found: list[dict]
) -> dict[variants.Variant, list[report.AnimationResults]]:
    file = tmp_path / "animation.jsonl"
    file.write_text("".join(json.dumps(row) + "\n" for part in found for row in part))
    monkeypatch.setattr(report, "RESULTS", file)
    return report.load()


def test_every_temporal_mode_is_compared_with_itself_frame_by_frame() -> None:
    """The mode that AUTO is compared with is the one that the library chooses for stills."""
    temporal = [mode for mode in animation_modes.MODES if animation_modes.is_temporal(mode)]
    assert temporal
    for mode in temporal:
        twin = animation_modes.MODES[animation_modes.per_frame(mode)].settings
        same = {"integrator": "AUTO", "reconstruction": "AUTO"} if mode == "temporal-auto" else {}
        assert animation_modes.MODES[mode].settings == twin | same | {"use_temporal": True}


def test_targets_are_ratios_at_equal_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = [rows("path", 1.0), rows("gradient-l2", 0.2), rows("temporal-l2", 0.02), rows(report.PEER, 0.1)]
    table = report.ratios(stored(tmp_path, monkeypatch, *found)[variants.USUAL])
    assert table.columns == ["mode", "ratio", "target", "light-off", "met"]
    assert [row[3:] for row in table.rows] == [
        [ratio, "1 of 1"] for ratio in ("0.10", "0.10", "0.10", "0.10", "0.20", "0.20", "0.20", "0.20")
    ], "there is neither a shadow nor a peer with one seed"


def test_the_newest_version_of_each_mode_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    elsewhere = [row | {"frames": [2, 25]} for row in rows("cycles", 1.0)]
    found = stored(
        tmp_path, monkeypatch, elsewhere, rows("path", 4.0, "old"), rows("path", 1.0), rows("temporal-l2", 0.1, "old")
    )
    (scene,) = found[variants.USUAL]
    assert scene.modes() == ["path", "temporal-l2"], "another range of frames cannot be compared"
    assert {row["version"] for row in scene.rows if row["mode"] == "path"} == {"new"}
    assert scene.ratio("temporal-l2", "path", "flicker") == pytest.approx(0.1)


def test_a_peer_gets_more_samples_in_a_later_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Earlier results count while they have as many seeds; all modes of Gradus are of one version."""
    found = [
        rows(mode, 1.0, "old") + [row | {"samples": 64} for row in rows(mode, 1.0)[:4:2]]
        for mode in ("path", report.PEER)
    ]
    lone = [row | {"samples": 32} for row in rows(report.PEER, 1.0, "older")[:1]]
    ((scene,),) = stored(tmp_path, monkeypatch, lone, *found).values()
    counts = {mode: [point.samples for point in points] for mode, points in scene.points.items()}
    assert counts == {"path": [64], report.PEER: [4, 16, 64]}


VARIANTS = {
    "320×180 pixels": {"width": 320, "height": 180},
    "12 frames": {"frames": [7, 18]},
    "motion blur, shutter 0.5": {"shutter": 0.5},
}


def test_variants_are_never_compared_with_each_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A newer result of another variant does not replace that of the usual one."""
    varied = [
        rows(mode, flicker, "newer", **more)
        for more in VARIANTS.values()
        for mode, flicker in (("path", 1.0), ("temporal-l2", 0.5))
    ]
    found = stored(tmp_path, monkeypatch, rows("path", 1.0), rows("temporal-l2", 0.1), *varied)
    ratios = {variant.title: scene.ratio("temporal-l2", "path", "flicker") for variant, (scene,) in found.items()}
    assert ratios == pytest.approx({"": 0.1} | dict.fromkeys(VARIANTS, 0.5))
    assert {len(scene.rows) for (scene,) in found.values()} == {8}


def test_the_usual_variant_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All variants have the same tables, and a curve of their own."""
    for module in (figures, strips):
        monkeypatch.setattr(module, "OUT", tmp_path)
    modes = {report.ONE_BY_ONE: 0.2, report.DELIVERED: 0.05, report.PEER: 0.1}
    stored(
        tmp_path,
        monkeypatch,
        *(rows(mode, flicker, **more) for more in ({"shutter": 0.5}, {}) for mode, flicker in modes.items()),
    )
    found = report.blocks()
    headings = [block.markdown for block in found if isinstance(block, document.Text) and "### A" in block.markdown]
    assert headings == [
        "### Animations: 640×360 pixels, 24 frames",
        "#### Animation light-off",
        "### Animations: motion blur, shutter 0.5",
        "#### Animation light-off",
    ]
    curves = [block.file for block in found if isinstance(block, document.Figure)]
    assert curves == ["animation-light-off.svg", "animation-light-off-motion-blur-shutter-0-5.svg"]
    assert all((tmp_path / file).stat().st_size > 0 for file in curves)
    last = [block for block in found if isinstance(block, document.Table)][-1]
    assert last.rows[0] == [
        "Gradus AUTO, frames one by one", "4", "2", "0.02",
        "0.02500", "0.02500", "0.00000 ± 0.00000", "0.02500", "0.05000", "0.05000", "0.00000 ± 0.00000", "0.05000",
        "0.0200",
    ]  # fmt: skip


def test_the_deviation_of_the_mean_is_that_over_all_seeds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Noise of one seed is no deviation: the first seed is 10 % too dark, the second 10 % too bright."""
    found = rows("path", 1.0) + [row | {"mean_light": 0.95} for row in rows(report.DELIVERED, 1.0)]
    table = report.light(stored(tmp_path, monkeypatch, found)[variants.USUAL])[1]
    assert table.rows == [
        [animation_modes.MODES[report.DELIVERED].label, "4", "-5.00 %"],
        [animation_modes.MODES[report.DELIVERED].label, "16", "-5.00 %"],
        ["Gradus PT", "4", "+0.00 %"],
        ["Gradus PT", "16", "+0.00 %"],
    ]


def test_a_static_shot_is_measured_in_frames_of_sampling(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """24 frames by themselves take 2.4 s for 4 samples; a joined animation that takes 0.1 s has sampled one frame."""
    shot = {"scene": animation_scenes.STATIC}
    alone = [row | shot | {"sampling": 2.4} for row in rows(report.ONE_BY_ONE, 1.0)]
    joined = [row | shot | {"sampling": 0.1} for row in rows(report.DELIVERED, 1.0)]
    table = report.static_shots(stored(tmp_path, monkeypatch, alone, joined)[variants.USUAL])[1]
    assert table.rows == [[samples, "24", "1.00", "≤ 1.3"] for samples in ("4", "16")]


def test_fewer_frames_are_those_in_the_middle() -> None:
    animation = next(animation for animation in animation_scenes.ANIMATIONS if animation.changes)
    assert [animation.lasting(length).frames for length in (24, 12, 9, 4)] == [(1, 24), (7, 18), (9, 17), (11, 14)]
    assert animation.lasting(4).changes == 13
    assert animation.lasting(1).changes is None, "no frame shows the light before"
    assert animation.middle(8) == animation.lasting(12).middle(8) == (9, 16)
    assert animation.lasting(4).middle(8) == (11, 14), "there are no more frames"


def test_an_animation_that_is_too_short_is_left_out(capsys: pytest.CaptureFixture[str]) -> None:
    assert [animation.frames for animation in animation_scenes.select(animation_scenes.ANIMATIONS, "animated", 24)] == [
        (1, 24)
    ]
    assert not animation_scenes.select(animation_scenes.ANIMATIONS, "animated", 30)
    assert "SKIP animated: it has 24 frames" in capsys.readouterr().out


def test_converged_frames_are_those_of_the_variant() -> None:
    animation = animation_scenes.ANIMATIONS[0]

    def file(frames: int, checked: tuple[int, int] | None = None, **more: Any) -> str:
        variant = variants.Variant(length=frames, **more)
        renderer = SimpleNamespace(animation=animation.lasting(frames), variant=variant)
        return references.file_of(renderer, "path", checked).name

    assert file(10).endswith("-8-17-640x360-path.npz")
    assert file(10, (12, 14)).endswith("-12-14-640x360-path.npz")
    others = (file(12), file(10, size=(320, 180)), file(10, shutter=0.5), file(10, shutter=0.25))
    assert len({file(10), file(10, (12, 14)), *others}) == 6


def test_halves_of_a_reference_share_no_seed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A reference of more samples goes on with the parts that are there."""
    monkeypatch.setattr(references, "CACHE", tmp_path)
    seeds: list[int] = []

    def render(engine: str, samples: int, seed: int, frames: tuple[int, int]) -> tuple[np.ndarray, dict]:
        assert (engine, samples, frames) == ("path", references.PART, (12, 14))
        seeds.append(seed)
        return np.full((3, 2, 4, 3), float(seed - 1000)), {}

    renderer = SimpleNamespace(
        animation=animation_scenes.ANIMATIONS[0], variant=variants.Variant(size=(4, 2)), render=render
    )
    first = references.reference(renderer, "path", 2 * references.PART, (12, 14))
    assert (first.samples, *(half[0, 0, 0, 0] for half in first.halves)) == (2 * references.PART, 0.0, 1.0)
    more = references.reference(renderer, "path", 3 * references.PART, (12, 14))
    assert (more.samples, *(half[0, 0, 0, 0] for half in more.halves)) == (4 * references.PART, 1.0, 2.0)
    assert seeds == [1000, 1001, 1002, 1003]
    assert (more.mean[0, 0, 0, 0], more.variance[0, 0, 0, 0]) == (1.5, 0.25)


def test_strips_are_of_pictures_of_the_usual_size_alone() -> None:
    own, mode = next(animation for animation in animation_scenes.ANIMATIONS if animation.scene.own), strips.SHOWN[0]
    for variant, expected in (
        (variants.USUAL, True),
        (variants.Variant(length=9), True),
        (variants.Variant(shutter=0.5), False),
        (variants.Variant(size=(320, 180)), False),
    ):
        assert strips.wanted(own, variant, mode, strips.SAMPLES, strips.SEED) is expected


def test_films_show_two_modes_side_by_side(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Three films of noise, which hardly compresses, take at most 300 kB each."""
    monkeypatch.setattr(strips, "OUT", tmp_path)
    generator = np.random.default_rng(1)
    own = next(animation for animation in animation_scenes.ANIMATIONS if animation.scene.own)
    reference = np.ones((3, 360, 640, 3))
    for mode in strips.SHOWN:
        noise = 0.05 if mode == strips.DELIVERED else 1.0
        images = 0.5 + noise * (generator.random((5, 360, 640, 3)) - 0.5)
        strips.store(own, mode, images, reference, slice(1, 4))
    made = strips.films(own.name)
    assert len(made) == len({film.file for film in made}) == 3
    for film in made:
        file = tmp_path / film.file
        assert file.stat().st_size <= 300_000
        with strips.Image.open(file) as opened:
            assert (opened.n_frames, opened.size) == (5, (512, 180))
            opened.seek(3)
            left, right = np.split(np.asarray(opened.convert("L"), float), 2, axis=1)
        assert left.std() > 2.0 * right.std(), "the delivered mode is on the right"
    strips.store(own, strips.PEER, images[:4], reference, slice(0, 3))
    assert len(strips.films(own.name)) == 2, "films of different lengths are not put together"


def test_a_film_that_stays_too_large_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(strips, "MAXIMUM_BYTES", 100)
    frames = [np.random.default_rng(1).integers(0, 255, (64, 64, 3), np.uint8)] * 2
    with pytest.raises(RuntimeError, match=r"film\.webp"):
        strips.save_film(frames, tmp_path / "film.webp")
    assert not (tmp_path / "film.webp").exists()


def test_peers_of_another_blender_are_not_mixed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = [row | {"blender": "4.5", "samples": 64} for row in rows(report.PEER, 1.0, "old")]
    ((scene,),) = stored(tmp_path, monkeypatch, found, rows(report.PEER, 1.0)).values()
    assert [point.samples for point in scene.points[report.PEER]] == [4, 16]


def test_earlier_measures_and_other_references_are_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    earlier = [{key: value for key, value in row.items() if key != "checked"} for row in rows("cycles", 1.0)]
    fewer = rows("path", 1.0, checked=[12, 14])
    ((scene,),) = stored(tmp_path, monkeypatch, earlier, fewer, rows(report.DELIVERED, 1.0)).values()
    assert scene.modes() == [report.DELIVERED]


def test_a_mode_of_one_seed_is_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Regression: the report of a run that was interrupted could not be drawn."""
    first = [row for row in rows(report.PEER, 1.0) if row["seed"] == 0]
    ((scene,),) = stored(tmp_path, monkeypatch, first, rows(report.DELIVERED, 1.0)).values()
    assert scene.modes() == [report.DELIVERED]


def test_a_peer_of_another_blender_is_not_compared_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Regression: the newest rows of each mode counted, even if they were of different Blenders."""
    peer = [row | {"blender": "4.5"} for row in rows(report.PEER, 1.0)]
    ((scene,),) = stored(tmp_path, monkeypatch, peer, rows("path", 1.0)).values()
    assert scene.modes() == ["path"]


@pytest.mark.module
def test_all_engines_have_the_bounce_limits_of_the_file(scene: bpy.types.Scene, tmp_path: Path) -> None:
    """Regression: Gradus kept its own bounce limits and denoiser in animations."""
    import animation_worker

    scene.cycles.max_bounces, scene.cycles.diffuse_bounces = 9, 7
    file = tmp_path / "limits.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    animation_worker.open_scene(str(file), 32, 18)
    gradus = bpy.context.scene.gradus
    assert (gradus.max_bounces, gradus.diffuse_bounces) == (9, 7)


@pytest.mark.module
def test_motion_blur_is_switched_on_and_off_again(scene: bpy.types.Scene) -> None:
    import animation_worker

    layer = scene.view_layers[0]
    layer.use_motion_blur = False
    animation_worker.set_motion_blur(scene, layer, 0.25)
    assert (scene.render.use_motion_blur, layer.use_motion_blur, scene.render.motion_blur_shutter) == (True, True, 0.25)
    animation_worker.set_motion_blur(scene, layer, 0.0)
    assert not scene.render.use_motion_blur


def test_lags_are_those_of_the_mean_over_seeds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The light changes in frame 13, the fifth of those that have a reference."""
    late = [0.0] * 3 + [-0.1] + [0.5, 0.2, 0.0, 0.0]
    found = rows("temporal-l1", 1.0)
    for row, noise in zip(found, (0.06, 0.06, -0.06, -0.06), strict=True):
        row["shares_of_light"] = [share + noise for share in late]
    scenes = stored(tmp_path, monkeypatch, found)[variants.USUAL]
    assert scenes[0].lag_and_lead(scenes[0].points["temporal-l1"][-1]) == (2, 1)
    table = report.changes(scenes)[1]
    assert table.rows[-1] == ["light-off", "Gradus T-GPT + L1", "16", "50.0 %", "2", "1"]


def test_strips_show_all_frames_in_order() -> None:
    frames = np.zeros((4, 90, 160, 3)) + np.arange(4)[:, None, None, None]
    film, over_time = strips.film(frames), strips.over_time(frames)
    assert film.shape == (45, 4 * 64, 3)
    assert film[0, ::64, 0].tolist() == [0, 1, 2, 3]
    assert over_time.shape == (4 * strips.TALL, 160, 3)
    assert over_time[:: strips.TALL, 0, 0].tolist() == [0, 1, 2, 3]


def test_all_animations_are_described() -> None:
    for animation in animation_scenes.ANIMATIONS:
        assert animation.length == variants.USUAL.length
        assert animation.moves
    names = {animation.name for animation in animation_scenes.ANIMATIONS}
    assert len(names) == len(animation_scenes.ANIMATIONS)
    assert names > {*animation_scenes.QUICK, animation_scenes.STATIC}


@pytest.mark.module
def test_a_tiny_run_goes_on_where_it_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A seed is compared with the one before, which is kept, or rendered again if it is not. Nothing remains."""
    import animation

    monkeypatch.setattr(animation, "RESULTS", tmp_path / "animations.jsonl")
    monkeypatch.setattr(references, "CACHE", tmp_path)
    monkeypatch.setattr(references, "PART", 2)
    monkeypatch.setattr(animation.seeds, "CACHE", tmp_path / "seeds")
    (chosen,) = animation_scenes.select(animation_scenes.ANIMATIONS, "animated", 4)
    options = {"size": (32, 18), "frames": 4, "checked": 3, "blur": False, "reference": 4, "references_only": False}
    options |= {"samples": [2], "modes": ["path-regularized", "temporal-auto"], "quick": False}
    for seeds in (1, 3, 3):
        animation.bench_animation(chosen, Namespace(**options, seeds=seeds), "version", float("inf"))
    found = [json.loads(line) for line in (tmp_path / "animations.jsonl").read_text().splitlines()]
    assert [(row["mode"], row["seed"]) for row in found] == [
        (mode, seed) for seed in range(3) for mode in options["modes"]
    ], "the third run does nothing"
    assert [row["flicker_noise"] > 0.0 for row in found if row["seed"]] == 4 * [True]
    assert all(0.5 < row["mean_light"] < 1.5 and row["sampling"] > 0.0 for row in found)
    assert not list((tmp_path / "seeds").glob("*"))


def test_pictures_in_a_table_are_pictures_on_the_page() -> None:
    assert document.inline("![a + b](c.webp)") == '<img src="c.webp" alt="a + b">'
