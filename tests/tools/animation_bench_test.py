"""Tests of the animation benchmark: its modes, its report on stored rows, and its strips."""

from __future__ import annotations

import json
import sys
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


def rows(mode: str, flicker: float, version: str = "new", **more: Any) -> list[dict]:
    """Returns measures of two seeds that fall as 1/t."""
    found = []
    for seed in range(2):
        for samples in (4, 16):
            row = {"scene": "light-off", "frames": [1, 10], "width": 160, "height": 90, "shutter": 0.0, "mode": mode}
            row |= {"version": version, "blender": "5.2", "samples": samples, "seed": seed}
            measures = {
                "flicker": flicker / samples,
                "flicker_warped": 0.1 * flicker / samples,
                "relmse": 0.5 * flicker / samples,
            }
            found.append(row | measures | {"cpu": 0.1 * samples, "reference_samples": 256} | more)
    return found


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
    found = [rows("path", 1.0), rows("gradient-l2", 0.2), rows("temporal-l2", 0.05), rows(report.PEER, 0.1)]
    table = report.target_table(stored(tmp_path, monkeypatch, *found)[variants.USUAL])
    assert table.columns == ["mode", "ratio", "target", "light-off", "met"]
    assert [row[3:] for row in table.rows] == [
        [ratio, "1 of 1"] for ratio in ("0.05", "0.05", "0.25", "0.25", "0.25", "0.50", "0.50")
    ]


def test_the_newest_version_of_each_mode_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    elsewhere = [row | {"frames": [2, 11]} for row in rows("cycles", 1.0)]
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
    "30 frames": {"frames": [1, 30]},
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


def test_figures_of_variants_follow_those_of_the_usual_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blurred = {"shutter": 0.5, "shares_of_light": [0.0] * 5 + [0.5] + [0.0] * 4}
    modes = {"path": 1.0, "gradient-l2": 0.2, "temporal-l2": 0.05, report.PEER: 0.1}
    stored(
        tmp_path,
        monkeypatch,
        *(rows(mode, flicker, **more) for mode, flicker in modes.items() for more in ({}, blurred)),
    )
    found = report.blocks()
    headings = [
        block.markdown for block in found if isinstance(block, document.Text) and block.markdown.startswith("### ")
    ]
    assert headings[0] == "### Targets at equal CPU time"
    assert headings[-1] == "### Animations: motion blur, shutter 0.5"
    table = next(block for block in reversed(found) if isinstance(block, document.Table))
    assert table.rows[0][:4] == ["light-off", "Gradus PT", "4, 16", "2"]
    assert table.rows[0][4:] == ["1.00", "–", "–", "10.00", "1", "0"], (
        "a mode frame by frame is compared with no other mode"
    )
    assert table.rows[2][4:] == ["0.05", "0.25", "0.25", "0.50", "1", "0"]


def test_more_frames_end_where_the_motion_does() -> None:
    animated = next(animation for animation in animation_scenes.ANIMATIONS if animation.name == "animated")
    assert [animated.lasting(length).frames for length in (4, 15, 20, 24)] == [(10, 13), (10, 24), (5, 24), (1, 24)]
    animation = next(animation for animation in animation_scenes.ANIMATIONS if animation.goes_off)
    assert (animation.lasting(30).frames, animation.lasting(30).goes_off) == ((1, 30), 6)
    assert animation.lasting(3).goes_off is None, "no frame shows the light going off"


def test_an_animation_that_is_too_short_is_left_out(capsys: pytest.CaptureFixture[str]) -> None:
    assert [animation.frames for animation in animation_scenes.select(animation_scenes.ANIMATIONS, "animated", 24)] == [
        (1, 24)
    ]
    assert not animation_scenes.select(animation_scenes.ANIMATIONS, "animated", 30)
    assert "SKIP animated: it has 24 frames" in capsys.readouterr().out


def test_converged_frames_are_those_of_the_variant() -> None:
    animation = animation_scenes.ANIMATIONS[0]

    def file(frames: int, **more: Any) -> str:
        variant = variants.Variant(length=frames, **more)
        return references.file_of(SimpleNamespace(animation=animation.lasting(frames), variant=variant), "path").name

    assert file(10).endswith("-10-19-160x90-path.npz")
    assert len({file(10), file(12), file(10, size=(320, 180)), file(10, shutter=0.5), file(10, shutter=0.25)}) == 5


def test_strips_are_of_the_usual_variant_alone() -> None:
    own, mode = next(animation for animation in animation_scenes.ANIMATIONS if animation.scene.own), strips.SHOWN[0]
    assert strips.wanted(own, variants.USUAL, mode, strips.SAMPLES, strips.SEED)
    assert not strips.wanted(own, variants.Variant(shutter=0.5), mode, strips.SAMPLES, strips.SEED)


def test_peers_of_another_blender_are_not_mixed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = [row | {"blender": "4.5", "samples": 64} for row in rows(report.PEER, 1.0, "old")]
    ((scene,),) = stored(tmp_path, monkeypatch, found, rows(report.PEER, 1.0)).values()
    assert [point.samples for point in scene.points[report.PEER]] == [4, 16]


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
    late = [0.0] * 4 + [-0.1] + [0.5, 0.2, 0.0, 0.0, 0.0]
    found = rows("temporal-l1", 1.0)
    for row, noise in zip(found, (0.06, 0.06, -0.06, -0.06), strict=True):
        row["shares_of_light"] = [share + noise for share in late]
    ((scene,),) = stored(tmp_path, monkeypatch, found).values()
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
