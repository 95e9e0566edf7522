"""The published reconstructions of the benchmark, on small images whose truth is known."""

from __future__ import annotations

import sys
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("scipy", reason="SciPy is in the environment of bpy45 only")
sys.path.append(str(Path(__file__).resolve().parents[2] / "tools" / "bench"))
import compare_designs  # noqa: E402
from designs import chapter8, films, nfor, nlm, poisson  # noqa: E402
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
