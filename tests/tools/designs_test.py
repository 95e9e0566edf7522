"""The published reconstructions of the benchmark, on small images whose truth is known."""

from __future__ import annotations

import sys
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("scipy", reason="SciPy is in the environment of bpy45 only")
sys.path.append(str(Path(__file__).resolve().parents[2] / "tools" / "bench"))
import compare_animated_designs  # noqa: E402
import compare_designs  # noqa: E402
from designs import animations, chapter8, films, nfor, nlm, poisson, svgf  # noqa: E402
from designs.animations import Frame, Motion  # noqa: E402
from designs.films import Half  # noqa: E402
from designs.patches import OFFSETS, Patches  # noqa: E402
from designs.poisson import Reweighting  # noqa: E402

HEIGHT, WIDTH = 20, 24
TILES = np.kron([[0, 1], [1, 0]], np.ones((HEIGHT // 2, WIDTH // 2)))[:, :, None]  # albedo: a chessboard
Y, X = (axis[:, :, None] / WIDTH for axis in np.indices((HEIGHT, WIDTH)))
FEATURES = np.concatenate([0.2 + 0.6 * TILES, X, Y, np.ones_like(X)], axis=2)
TRUTH = (0.3 + TILES + 0.5 * X) * np.array([1.0, 0.8, 0.6])


def half_of(image: np.ndarray) -> Half:
    return Half(image, *films.differences(image), FEATURES[: image.shape[0], : image.shape[1]])


def noisy_half(seed: int) -> Half:
    """Adds noise: differences have half the deviation; one pixel in a hundred and its differences are outliers."""
    random = np.random.default_rng(seed)

    def noisy(image: np.ndarray, deviation: float) -> np.ndarray:
        outliers = 20.0 * (random.random((*image.shape[:2], 1)) < 0.01)
        return image + deviation * (1.0 + outliers) * random.normal(size=image.shape)

    true = half_of(TRUTH)
    dx, dy = noisy(true.dx, 0.25), noisy(true.dy, 0.25)
    dx[:, -1], dy[-1] = 0.0, 0.0
    return Half(noisy(TRUTH, 0.5), dx, dy, np.clip(noisy(FEATURES, 0.01), 0.0, 1.0))


def cropped(half: Half, height: int, width: int) -> Half:
    return Half(*(getattr(half, field.name)[:height, :width].copy() for field in fields(Half)))


FILM = noisy_half(1), noisy_half(2)
SMALL = tuple(cropped(half, 10, 12) for half in FILM)
ROBUST = [name for name in compare_designs.PUBLISHED if "tuned" not in name]  # what else is tuned is numbers


def squared_error(image: np.ndarray) -> float:
    return float(((image - TRUTH) ** 2).mean())


def patches_of(features: np.ndarray, deviation: float = 0.0) -> Patches:
    weights = np.concatenate([nlm.inside(features.shape, *offset) for offset in OFFSETS], axis=2)
    return Patches(features, np.full_like(features, deviation), weights.reshape(-1, len(OFFSETS)))


@pytest.mark.parametrize(("scales", "gain"), [(chapter8.PRINTED, 1.3), (chapter8.TUNED, 2.0)])
def test_chapter_8_has_less_error_than_l1(scales: tuple[chapter8.Scale, ...], gain: float) -> None:
    l1 = squared_error(poisson.l1(films.mean_of(FILM), chapter8.ALPHA_L1, Reweighting.L1))
    assert squared_error(chapter8.reconstruct(FILM, scales, Reweighting.L1)) < l1 / gain


def test_nfor_has_less_error_than_the_noisy_image() -> None:
    l1 = tuple(poisson.l1(half, chapter8.ALPHA_L1, Reweighting.L1) for half in FILM)
    noisy = squared_error(films.mean_of(FILM).image)
    assert squared_error(nfor.reconstruct(FILM)) < noisy / 4.0
    assert squared_error(nfor.reconstruct(FILM, l1)) < noisy / 4.0


@pytest.mark.parametrize(("reweighting", "power"), [(Reweighting.L1, 1), (Reweighting.PRINTED, 0)])
def test_weighted_squares_of_residuals_are_the_norm_or_as_printed_a_constant(
    reweighting: Reweighting, power: int
) -> None:
    late = 40  # what is added to the residuals is next to nothing
    weights = poisson.reweighted(FILM[0], TRUTH, late, 0.2, 0.0, None, reweighting)
    residual = np.linalg.norm(0.2 * (TRUTH - FILM[0].image), axis=2)
    assert weights.pixel * residual**2 == pytest.approx(residual**power, rel=1e-6)


def test_frozen_weights_are_a_linear_operator() -> None:
    patches = patches_of(FEATURES)
    a, b = FILM
    weights = poisson.reweighted(a, b.image, 0, 0.2, 3.0, patches, Reweighting.L1)
    mixed = Half(*(2.0 * x - 3.0 * y for x, y in ((a.image, b.image), (a.dx, b.dx), (a.dy, b.dy))), FEATURES)
    of_a, of_b, of_mixed = poisson.solve((a, b, mixed), weights, 0.2, 3.0, patches)
    assert of_mixed == pytest.approx(2.0 * of_a - 3.0 * of_b, abs=1e-8)


def test_linear_functions_of_features_satisfy_the_patches() -> None:
    image = FEATURES @ np.random.default_rng(3).normal(size=(4, 3))
    patches = patches_of(FEATURES)
    assert patches.residuals(image) == pytest.approx(0.0, abs=1e-9)
    random = np.random.default_rng(4).random
    weights = poisson.Weights(
        *(0.1 + random((HEIGHT, WIDTH)) for _ in range(3)), 0.1 + random((HEIGHT * WIDTH, len(OFFSETS)))
    )
    (solved,) = poisson.solve((half_of(image),), weights, 0.1, 20.0, patches)
    assert solved == pytest.approx(image, abs=1e-8)


def test_shapes_that_no_feature_describes_violate_the_patches() -> None:
    image = half_of(TRUTH).image
    image = image + (X > 0.4) * (Y > 0.3)  # a shadow
    assert np.abs(patches_of(FEATURES).residuals(image)).max() > 0.1


def test_features_that_are_noise_leave_the_basis() -> None:
    noise = 0.01 * np.random.default_rng(5).random((HEIGHT, WIDTH, 1))
    features = np.concatenate([np.ones_like(X), noise], axis=2)
    assert np.abs(patches_of(features).residuals(noise)).max() < 1e-9
    assert np.abs(patches_of(features, deviation=0.5).residuals(noise)).max() > 1e-3


def test_the_normal_matrix_is_that_of_the_rows() -> None:
    """Compares the matrices of an image, column by column, with P_p and with the differences of every unit image."""
    height, width, alpha, beta = 6, 7, 0.3, 2.0
    features = FEATURES[:height, :width]
    patches = patches_of(features)
    random = np.random.default_rng(6).random
    weights = poisson.Weights(
        *(0.1 + random((height, width)) for _ in range(3)), 0.1 + random((height * width, len(OFFSETS)))
    )
    rows = []
    for unit in np.eye(height * width):
        image = unit.reshape(width, height).T[:, :, None]
        dx, dy = films.differences(image)
        parts = [
            alpha * image[:, :, 0] * np.sqrt(weights.pixel),
            dx[:, :, 0] * np.sqrt(weights.dx),
            dy[:, :, 0] * np.sqrt(weights.dy),
        ]
        rows.append(
            np.concatenate(
                [
                    *(p.ravel() for p in parts),
                    (beta * patches.residuals(image)[:, :, 0] * np.sqrt(weights.patch)).ravel(),
                ]
            )
        )
    expected = np.array(rows) @ np.array(rows).T
    band = poisson.normal_matrix(weights, alpha, beta, patches).band()
    found = np.zeros_like(expected)
    for step, diagonal in enumerate(band):
        for i in range(height * width - step):
            found[i + step, i] = found[i, i + step] = diagonal[i]
    assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("design", ["chapter8", "nfor-l1"])
def test_halves_may_be_swapped(design: str) -> None:
    reconstruct = compare_designs.PUBLISHED[design][1]
    assert reconstruct(SMALL[::-1]) == pytest.approx(reconstruct(SMALL), abs=1e-8)


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (2, 3)])
@pytest.mark.parametrize("design", ROBUST)
def test_images_smaller_than_a_patch(design: str, shape: tuple[int, int]) -> None:
    film = tuple(cropped(half, *shape) for half in FILM)
    assert np.isfinite(compare_designs.PUBLISHED[design][1](film)).all()


@pytest.mark.parametrize("design", ROBUST)
def test_bad_pixels_stay_finite(design: str) -> None:
    bad = cropped(FILM[0], HEIGHT, WIDTH)
    for plane in (bad.image, bad.dx, bad.dy, bad.features):
        plane[3, 4:7] = np.array([[np.nan], [-np.inf], [1e30]])
    image = compare_designs.PUBLISHED[design][1]((films.tidied(bad), FILM[1]))
    assert np.isfinite(image).all()
    assert np.abs(image).max() < 2.0 * films.LARGEST
    if "nfor" not in design:  # which spreads an outlier over its window
        assert np.median(np.abs(image - TRUTH)) < 0.5


@pytest.mark.parametrize("features", [0.0, 0.5])
@pytest.mark.parametrize("design", ROBUST)
def test_uninformative_features(design: str, features: float) -> None:
    film = tuple(replace(half, features=np.full_like(half.features, features)) for half in SMALL)
    assert np.isfinite(compare_designs.PUBLISHED[design][1](film)).all()


def stored_planes() -> dict[str, np.ndarray]:
    """Returns a film of 4×5 pixels with 2 samples per half, and 1 where pairs are counted only twice."""
    planes = {}
    for half in "AB":
        planes[f"{half}.count.V"] = np.full((4, 5), 2.0)
        for name, channels in (("Normal", "XYZ"), ("Albedo", "XYZ"), ("Depth", "V")):
            planes |= {f"{half}.Denoising_{name}.{c}": np.full((4, 5), 1.0) for c in channels}
        planes |= {f"{half}.{c}": np.full((4, 5), 6.0) for c in "RGB"}
        for value, offset in enumerate(("right", "up", "left", "down")):
            planes[f"{half}.{offset}.pairs.V"] = np.full((4, 5), 2.0)
            planes |= {f"{half}.{offset}.{c}": np.full((4, 5), 2.0 * value) for c in "RGB"}
    return planes


def test_stored_films_are_means_and_differences_of_both_ends() -> None:
    half = films.film_of(stored_planes())[0]
    assert half.image == pytest.approx(3.0)
    assert half.dx[:, :-1] == pytest.approx(0.0 - 2.0) and half.dx[:, -1] == pytest.approx(0.0)
    assert half.dy[:-1] == pytest.approx(3.0 - 1.0) and half.dy[-1] == pytest.approx(0.0)
    assert half.features[0, 0] == pytest.approx([0.75, 0.75, 0.75, 0.5, 0.5, 0.5, 0.5, 0.0, 0.0])


def test_pairs_without_samples_take_the_images_difference() -> None:
    planes = stored_planes()
    planes["A.left.pairs.V"][1, 2] = 0.0
    planes["A.R"][1, 2] = 10.0
    half = films.film_of(planes)[0]
    assert half.dx[1, 1] == pytest.approx([2.0, 0.0, 0.0])


def test_the_table_has_the_newest_results_of_scenes_that_have_l1() -> None:
    settings = {"width": 100, "height": 100, "samples": 16, "reference": 1024}
    rows = [
        {"scene": "a", "design": design, "relmse": error, "cpu": 1.0, **settings}
        for error in (9.0, 2.0)
        for design in compare_designs.LABELS
    ]
    rows.insert(-1, rows[-1] | {"relmse": 7.0, "samples": 4})
    rows.insert(-1, {"scene": "b", "design": "l1", "relmse": 5.0, "cpu": None, **settings})
    assert {scene: designs["nfor-l1"]["relmse"] for scene, designs in compare_designs.newest(rows).items()} == {
        "a": 2.0
    }
    assert "| NFOR | 1.00 | 1.00 | 2.0000 | 2.0000 | 100 |" in compare_designs.table(rows)


def flat_surface(height: int = 24, width: int = 30, normal: int = 0) -> svgf.Surface:
    """Returns a plane that faces the camera at depth 1; `normal` is the axis of its normal."""
    shape = (height, width)
    normals = np.broadcast_to(np.eye(4)[normal], (*shape, 4)).copy()
    return svgf.Surface(np.ones(shape), np.zeros((*shape, 2)), normals, np.ones((*shape, 3)))


def pan(height: int, width: int, down: int, right: int, displacement: tuple[float, float] = (0.0, 0.0)) -> Motion:
    """Returns the motion of a picture that moved by whole pixels, and a fraction, since the other frame."""
    source = np.stack(np.indices((height, width)), axis=2) - (down, right)
    shown = ((source >= 0) & (source < (height, width))).all(axis=2)
    return Motion(np.where(shown[:, :, None], source, 0), np.full((height, width, 2), displacement), shown)


def random_light(seed: int, height: int = 24, width: int = 30) -> np.ndarray:
    return 1.0 + np.random.default_rng(seed).normal(size=(height, width, 3))


def two_frames(surface: svgf.Surface, motion: Motion, previous: svgf.Surface | None = None) -> svgf.History:
    """Returns the history of random_light(1) and then random_light(2)."""
    previous = previous or surface
    first = svgf.accumulate(random_light(1), previous, None)
    return svgf.accumulate(random_light(2), surface, (first, previous, motion))


def test_svgf_accumulates_an_exponential_mean() -> None:
    surface, still = flat_surface(), animations.own(24, 30)
    history = svgf.accumulate(random_light(0), surface, None)
    for seed in range(1, 40):
        history = svgf.accumulate(random_light(seed), surface, (history, surface, still))
    assert history.length == pytest.approx(40.0)
    assert history.light.mean() == pytest.approx(1.0, abs=0.03)
    assert history.light.var() == pytest.approx(svgf.ALPHA / (2.0 - svgf.ALPHA), rel=0.1)


def test_svgf_averages_the_first_frames_evenly() -> None:
    history = two_frames(flat_surface(), animations.own(24, 30))
    assert history.light == pytest.approx(0.5 * (random_light(1) + random_light(2)))
    luminance = np.stack([random_light(seed) @ svgf.LUMINANCE for seed in (1, 2)])
    assert history.moments[:, :, 1] == pytest.approx((luminance**2).mean(axis=0))


def test_svgf_follows_motion_by_whole_pixels_exactly() -> None:
    history = two_frames(flat_surface(), pan(24, 30, 2, -3))
    assert history.light[2:, :-3] == pytest.approx(0.5 * (random_light(1)[:-2, 3:] + random_light(2)[2:, :-3]))
    assert (history.length[:2] == 1.0).all() and (history.length[:, -3:] == 1.0).all()


def test_svgf_reads_between_pixels() -> None:
    light = random_light(1)
    history = two_frames(flat_surface(), pan(24, 30, 0, 0, (0.0, 0.25)))
    between = 0.75 * light[:, 1:] + 0.25 * light[:, :-1]
    assert history.light[:, 1:] == pytest.approx(0.5 * (between + random_light(2)[:, 1:]))


@pytest.mark.parametrize("change", ["depth", "normal"])
def test_svgf_starts_anew_in_disocclusions(change: str) -> None:
    surface, previous = flat_surface(), flat_surface()
    if change == "depth":
        previous.depth[8:16, 8:16] = 2.0
    else:
        previous.normal[8:16, 8:16] = np.eye(4)[1]
    history = two_frames(surface, animations.own(24, 30), previous)
    inner = history.length[9:15, 9:15]
    assert (inner == 1.0).all() and (history.length[:7] == 2.0).all()
    assert history.light[9:15, 9:15] == pytest.approx(random_light(2)[9:15, 9:15])


def test_small_holes_of_the_motion_move_as_their_neighbors() -> None:
    motion = pan(24, 30, 0, 2)
    motion.shown[10, 10], motion.shown[15:24, 12:24] = False, False
    filled = svgf.filled(motion)
    assert filled.shown[10, 10] and (filled.source[10, 10] == (10, 8)).all()
    assert not filled.shown[19:24, 16:20].any()


def test_the_filter_keeps_an_edge_of_normals() -> None:
    edge, plane = flat_surface(), flat_surface()
    edge.normal[:, 15:] = np.eye(4)[1]
    light = np.ones((24, 30, 3))
    light[:, 15:] = 2.0
    variance = np.ones((24, 30))
    *_, kept = svgf.filtered(light, variance, edge)
    *_, mixed = svgf.filtered(light, variance, plane)
    assert kept == pytest.approx(light)
    assert np.abs(mixed - light).max() > 0.2


def test_a_level_of_the_filter_keeps_constants_and_knows_its_variance() -> None:
    light, variance = svgf.filtered_once(np.full((24, 30, 3), 3.0), np.full((24, 30), 2.0), flat_surface(), 1)
    assert light == pytest.approx(3.0)
    assert variance[2:-2, 2:-2] == pytest.approx(2.0 * (70.0 / 256.0) ** 2)


def test_variance_of_short_histories_is_that_of_the_neighborhood() -> None:
    light = np.repeat(random_light(1)[:, :, :1], 3, axis=2)
    variance = svgf.variance_of(svgf.accumulate(light, flat_surface(), None), flat_surface())
    assert variance.mean() == pytest.approx(svgf.SHORT * 48.0 / 49.0, rel=0.1)  # of deviations from means of 7×7


def test_slopes_are_those_of_planes_and_ignore_edges() -> None:
    depth = 1.0 + 0.1 * np.arange(10.0)[None] + np.zeros((8, 1))
    depth[4:] += 5.0
    assert svgf.slope_of(depth) == pytest.approx(np.broadcast_to([0.0, 0.1], (8, 10, 2)))


def test_svgf_of_a_still_animation_has_less_error_in_later_frames() -> None:
    still = animations.own(HEIGHT, WIDTH)
    features = np.concatenate([np.full((HEIGHT, WIDTH, 3), 0.5), np.full((HEIGHT, WIDTH, 4), 0.5), X, Y], axis=2)
    features[:, :, 2] = 1.0
    features[:, :, 3:6] = 0.2 + 0.6 * TILES
    light = features[:, :, 3:6]

    def frame(seed: int) -> Frame:
        noise = np.random.default_rng(seed).normal(scale=0.2, size=light.shape) * light
        film = tuple(replace(half_of(light + noise), features=features) for _ in "AB")
        return Frame(film, features, still if seed else None)

    pictures = list(svgf.reconstruct([frame(seed) for seed in range(8)]))
    errors = [float(((picture - light) ** 2).mean()) for picture in pictures]
    assert errors[0] < 0.1 * (0.2 * light).var() + 1e-3
    assert np.mean(errors[5:]) < 0.7 * errors[0]


def test_motions_are_joined_and_inverted() -> None:
    one, two = pan(12, 15, 1, -2), pan(12, 15, 2, -4)
    joined = animations.joined(one, one)
    assert (joined.shown == two.shown).all() and (joined.source[two.shown] == two.source[two.shown]).all()
    back = animations.inverse(one)
    there = animations.joined(one, back)
    assert (there.source[there.shown] == animations.own(12, 15).source[there.shown]).all()
    assert there.shown.sum() == one.shown.sum() == 11 * 13


def test_displacements_that_add_up_move_to_the_next_pixel() -> None:
    joined = animations.joined(pan(12, 15, 0, 0, (0.0, 0.4)), pan(12, 15, 0, 0, (0.0, 0.4)))
    assert (joined.source[:, 1:] == animations.own(12, 15).source[:, :-1]).all()
    assert joined.displacement[:, 1:] == pytest.approx(np.broadcast_to([0.0, -0.2], (12, 14, 2)))
    assert not joined.shown[:, 0].any()


def test_stored_correspondences_run_upwards() -> None:
    planes = {"correspondence.V": np.full((4, 5), float(2**32 - 1))}
    planes["correspondence.V"][0, 1] = 5 * 1 + 3  # the second row from below, the fourth column
    planes |= {f"correspondence.off_centre.{axis}": np.full((4, 5), value) for axis, value in (("X", 0.1), ("Y", 0.3))}
    motion = animations.motion_of(planes)
    assert motion is not None and motion.shown.sum() == 1 and motion.shown[0, 1]
    assert tuple(motion.source[0, 1]) == (2, 3)
    assert motion.displacement[0, 1] == pytest.approx([-0.3, 0.1])


def test_a_crop_loses_surfaces_from_outside() -> None:
    film, before = animations.cropped(FILM, pan(HEIGHT, WIDTH, 0, 3), (slice(2, 12), slice(5, 20)))
    image = film[0].image
    assert before is not None and image.shape[:2] == (10, 15)
    assert not before.shown[:, :3].any() and before.shown[:, 3:].all()
    assert before.read(image)[:, 3:] == pytest.approx(image[:, :-3])


STILL = animations.own(10, 12)


def small_film(seed: int) -> films.Film:
    return tuple(cropped(noisy_half(seed + i), 10, 12) for i in range(2))


def nfor_of(frames: list[Frame], picture: int) -> np.ndarray:
    return next(nfor.reconstruct_animation(frames, [picture]))


def test_nfor_of_equal_frames_is_that_of_one() -> None:
    frames = [animations.frame_of(SMALL, STILL) for _ in range(3)]
    assert nfor_of(frames, 1) == pytest.approx(nfor.reconstruct(SMALL), abs=1e-9)


def test_nfor_over_frames_has_less_error_than_of_one() -> None:
    frames = [animations.frame_of(small_film(10 * i), STILL) for i in range(5)]
    truth = TRUTH[:10, :12]
    alone = ((nfor_of(frames[2:3], 0) - truth) ** 2).mean()
    assert ((nfor_of(frames, 2) - truth) ** 2).mean() < 0.6 * alone


def test_nfor_uses_no_frames_behind_a_shot_change() -> None:
    frames = [animations.frame_of(small_film(10 * i), None) for i in range(3)]
    assert nfor_of(frames, 1) == pytest.approx(nfor.reconstruct(small_film(10)), abs=1e-9)


def test_nfor_ignores_frames_of_another_light() -> None:
    brighter = tuple(replace(half, image=half.image + 50.0) for half in small_film(20))
    frames = [animations.frame_of(film, STILL) for film in (SMALL, brighter)]
    assert nfor_of(frames, 0) == pytest.approx(nfor.reconstruct(SMALL), abs=1e-6)


def test_moved_frames_lie_where_the_picture_shows_them() -> None:
    """A copy of the picture that is two columns to the left is led back; its columns behind the border are missing."""
    frame = nfor.guided(SMALL)
    left = replace(
        frame,
        colours=[np.roll(image, -2, axis=1) for image in frame.colours],
        variance=np.roll(frame.variance, -2, axis=1),
        features=np.roll(frame.features, -2, axis=2),
    )
    moved = nfor.moved(left, pan(10, 12, 0, 2, (0.25, 0.0)), frame)
    assert (moved.shown[:, :2] == 0.0).all() and (moved.shown[:, 2:] == 1.0).all()
    assert moved.colours[0] == pytest.approx(frame.colours[0]) and moved.variance == pytest.approx(frame.variance)
    assert moved.features[..., :-1] == pytest.approx(frame.features[..., :-1])
    assert moved.features[:, :, 2:, -1] - frame.features[:, :, 2:, -1] == pytest.approx(0.25 / 12.0)


def test_films_of_plain_paths_take_the_images_differences() -> None:
    planes = {name: plane for name, plane in stored_planes().items() if ".pairs." not in name}
    planes["A.R"][1, 2] = 10.0
    half = films.film_of(planes, median=3.0)[0]
    assert half.dx[1, 1] == pytest.approx([2.0, 0.0, 0.0])
    assert half.features[0, 0, 6] == pytest.approx(0.5 / 3.5)


def test_noise_and_bias_of_animations_are_told_apart() -> None:
    random = np.random.default_rng(7)
    truth = np.ones((3, 40, 50, 3))
    references = truth + 0.3 * random.normal(size=(2, *truth.shape))
    bias = np.array([0.0, 0.1, 0.0])[:, None, None, None]
    pictures = truth + bias + 0.2 * random.normal(size=(4, *truth.shape))
    found = compare_animated_designs.measured(pictures, np.stack([truth, truth]))
    assert found["noise"] == pytest.approx(0.04 / 1.001, rel=0.03)
    assert found["flicker_noise"] == pytest.approx(0.08 / 1.001, rel=0.03)
    assert found["bias"] == pytest.approx(0.01 / 3.0, abs=0.001)
    assert found["flicker_bias"] == pytest.approx(0.01, abs=0.002)
    errors = compare_animated_designs.noise_and_error(pictures, references)[1]
    assert errors.mean() == pytest.approx(0.04 + 0.01 / 3.0, abs=0.003)


def test_the_table_of_animations_has_the_newest_results() -> None:
    rows = [
        {"name": "a", "design": "svgf"} | dict.fromkeys(compare_animated_designs.MEASURES, value)
        for value in (1.0, 2.0)
    ]
    assert compare_animated_designs.table(rows).splitlines()[2:] == [
        f"| a | SVGF (Schied et al. 2017) |{' 2.00000 |' * len(compare_animated_designs.MEASURES)}"
    ]


def test_the_margin_of_a_part_stays_inside_the_picture() -> None:
    part = compare_animated_designs.Part(slice(2, 8), slice(4, 10))
    wide = part.widened(3, 20, 12)
    assert (wide.rows, wide.columns) == (slice(0, 11), slice(1, 12))
    image = np.random.default_rng(8).random((20, 12, 3))
    assert (part.inside(wide).of(wide.of(image)) == part.of(image)).all()
