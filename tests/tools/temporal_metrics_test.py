"""The benchmark's measures of animations, on sequences whose flicker is known."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools" / "bench"))
import temporal_metrics as measures  # noqa: E402

SHAPE = (10, 24, 32, 3)
FRAMES, HEIGHT, WIDTH, _ = SHAPE
DEVIATION = 0.1
NONE = np.zeros(SHAPE)


def moving_picture() -> np.ndarray:
    """Returns a pattern that moves right by two pixels per frame."""
    pattern = 0.5 + np.random.default_rng(1).random((HEIGHT, WIDTH + 2 * FRAMES, 3))
    return np.stack([pattern[:, 2 * (FRAMES - t) :][:, :WIDTH] for t in range(FRAMES)])


REFERENCE = moving_picture()
STATIC = np.broadcast_to(REFERENCE[0], SHAPE)


def noise(seed: int, *shape: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(scale=DEVIATION, size=shape)


def steadiness(images: np.ndarray, reference: np.ndarray) -> float:
    return (
        measures.flicker_map(images, reference, NONE).mean() / measures.independent_map(images, reference, NONE).mean()
    )


def flicker_ratio(images: np.ndarray, reference: np.ndarray = REFERENCE) -> float:
    """Returns F / (2 relMSE)."""
    return measures.flicker_map(images, reference, NONE).mean() / (
        2.0 * measures.error_map(images, reference, NONE).mean()
    )


def test_errors_of_frames_that_are_independent_flicker_by_twice_their_energy() -> None:
    images = REFERENCE + noise(2, *SHAPE)
    expected = DEVIATION**2 * (1.0 / (1e-3 + REFERENCE.mean(axis=3) ** 2)).mean()
    assert measures.error_map(images, REFERENCE, NONE).mean() == pytest.approx(expected, rel=0.03)
    assert flicker_ratio(images) == pytest.approx(1.0, rel=0.03)
    assert steadiness(images, REFERENCE) == pytest.approx(1.0, rel=0.03)
    assert measures.fast_share(images, REFERENCE, NONE) == pytest.approx(0.5, rel=0.03)


def test_noise_that_stays_does_not_flicker() -> None:
    images = REFERENCE + noise(2, *SHAPE[1:])
    assert measures.error_map(images, REFERENCE, NONE).mean() > 0.5 * DEVIATION**2
    assert measures.flicker_map(images, REFERENCE, NONE).max() < 1e-20
    assert measures.fast_share(images, REFERENCE, NONE) < 1e-12


def test_motion_in_the_reference_is_no_flicker() -> None:
    assert measures.flicker_map(REFERENCE, REFERENCE, NONE).max() == 0.0
    assert measures.flicker_map(np.broadcast_to(REFERENCE[0], SHAPE), REFERENCE, NONE).mean() > 0.05, (
        "a static picture flickers against a moving reference"
    )


def test_an_error_that_turns_its_sign_each_frame_is_all_above_a_quarter_of_the_frame_rate() -> None:
    sign = np.array([1.0, -1.0] * (FRAMES // 2))[:, None, None, None]
    assert measures.fast_share(STATIC + 0.1 * sign, STATIC, NONE) == pytest.approx(1.0)
    assert flicker_ratio(STATIC + 0.1 * sign, STATIC) == pytest.approx(2.0)


def test_noise_of_the_reference_is_subtracted() -> None:
    """Converged frames against noisy references have neither error nor flicker on average, moving or static."""
    variance = np.full(SHAPE, DEVIATION**2)
    vectors = vectors_of_motion()
    found = {name: [] for name in ("error", "flicker", "warped")}
    for seed in range(32):
        reference = REFERENCE + noise(seed, *SHAPE)
        found["error"].append(measures.error_map(REFERENCE, reference, variance).mean())
        found["flicker"].append(measures.flicker_map(REFERENCE, reference, variance).mean())
        found["warped"].append(np.nanmean(measures.warped_flicker_map(REFERENCE, reference, variance, vectors)))
    noisy = measures.flicker_map(REFERENCE, REFERENCE + noise(0, *SHAPE), NONE).mean()
    assert all(abs(np.mean(values)) < 0.02 * noisy for values in found.values())
    images = REFERENCE + noise(99, *SHAPE)
    share = measures.fast_share(images, REFERENCE + noise(98, *SHAPE), variance)
    assert share == pytest.approx(0.5, rel=0.05)


def vectors_of_motion() -> np.ndarray:
    """Returns pass Vector of moving_picture(): (previous - current, current - next)."""
    return np.broadcast_to(np.array((-2.0, 0.0, -2.0, 0.0)), (*SHAPE[:3], 4))


def test_noise_that_moves_with_the_surface_flickers_but_not_along_its_motion() -> None:
    wide = noise(3, HEIGHT, WIDTH + 2 * FRAMES, 3)
    images = REFERENCE + np.stack([wide[:, 2 * (FRAMES - t) :][:, :WIDTH] for t in range(FRAMES)])
    warped = measures.warped_flicker_map(images, REFERENCE, NONE, vectors_of_motion())
    assert flicker_ratio(images) == pytest.approx(1.0, rel=0.1)
    assert np.isnan(warped[:, :, :2]).all(), "points that enter the picture have no previous position"
    assert warped[:, :, 2:].max() < 1e-20
    assert measures.moving(vectors_of_motion()).all()
    assert not measures.moving(np.zeros((*SHAPE[:3], 4))).any()


def test_motion_upwards_is_a_row_less() -> None:
    """Pass Vector has y upwards, and the first row is the top."""
    images = np.zeros(SHAPE)
    images[0, 10, 5] = images[1, 7, 5] = 1.0  # an error three rows up
    up = np.broadcast_to(np.array((0.0, -3.0, 0.0, -3.0)), (*SHAPE[:3], 4))
    warped = measures.warped_flicker_map(images[:2], NONE[:2], NONE[:2], up[:2])
    assert np.nanmax(warped) == 0.0


def test_a_point_that_was_hidden_is_not_compared() -> None:
    """The point was hidden in the previous frame: the pixel there shows another, static point."""
    vectors = np.zeros((*SHAPE[:3], 4))
    vectors[1, 8, 8, :2] = (-4.0, 0.0)
    warped = measures.warped_flicker_map(REFERENCE, REFERENCE, NONE, vectors)
    assert np.isnan(warped[0, 8, 8])
    assert np.isfinite(warped).sum() == warped.size - 1


def test_fireflies_are_trimmed() -> None:
    images = REFERENCE.copy()
    images[4, 3, 5] += 1e4
    squares = measures.error_map(images, REFERENCE, NONE)
    assert squares.mean() > 1.0
    assert measures.trimmed_mean(squares) == 0.0


OFF = 6


def switched_light() -> np.ndarray:
    """Returns a light that is switched off at frame OFF."""
    return STATIC + 2.0 * (np.arange(FRAMES) < OFF)[:, None, None, None]


def test_a_light_that_goes_off_makes_independent_errors_no_less_steady() -> None:
    """The noise of the bright frame before is divided by the dark one: F is more than twice relMSE."""
    images = switched_light() * (1.0 + noise(6, *SHAPE))
    assert flicker_ratio(images, switched_light()) > 1.2
    assert steadiness(images, switched_light()) == pytest.approx(1.0, rel=0.03)


def test_independent_frames_have_no_lag() -> None:
    shares = measures.shares_of_a_light(switched_light() + noise(4, *SHAPE), switched_light(), OFF)
    assert measures.lag(shares, OFF) == measures.lead(shares, OFF) == 0


def test_a_mean_over_past_frames_lags() -> None:
    reference = switched_light()
    images = np.stack([reference[max(0, t - 2) : t + 1].mean(axis=0) for t in range(FRAMES)])
    shares = measures.shares_of_a_light(images, reference, OFF)
    assert shares[OFF : OFF + 3] == pytest.approx([2 / 3, 1 / 3, 0.0])
    assert (measures.lag(shares, OFF), measures.lead(shares, OFF)) == (2, 0)


def test_a_mean_over_coming_frames_leads() -> None:
    reference = switched_light()
    images = np.stack([reference[t : t + 3].mean(axis=0) for t in range(FRAMES)])
    shares = measures.shares_of_a_light(images, reference, OFF)
    assert shares[OFF - 2 : OFF + 1] == pytest.approx([-1 / 3, -2 / 3, 0.0])
    assert (measures.lag(shares, OFF), measures.lead(shares, OFF)) == (0, 2)


def test_a_light_that_never_leaves_lags_to_the_end() -> None:
    images = np.broadcast_to(switched_light()[0], SHAPE)
    assert measures.lag(measures.shares_of_a_light(images, switched_light(), OFF), OFF) == FRAMES - OFF


def test_all_measures_have_names() -> None:
    found = measures.all_measures(REFERENCE + noise(5, *SHAPE), REFERENCE, NONE, vectors_of_motion())
    assert found["flicker"] == pytest.approx(2.0 * found["relmse"], rel=0.1)
    assert found["flicker_warped_moving"] == pytest.approx(found["flicker_warped"], rel=0.1)
    assert len(found["relmse_by_frame"]) == FRAMES
    assert "flicker_warped_moving" not in measures.all_measures(STATIC, STATIC, NONE, np.zeros((*SHAPE[:3], 4)))


def test_along_motion_nothing_is_measured_without_vectors() -> None:
    """With motion blur a pixel shows points of different motion."""
    images = REFERENCE + noise(5, *SHAPE)
    every, blurred = (
        measures.all_measures(images, REFERENCE, NONE, vectors) for vectors in (vectors_of_motion(), None)
    )
    assert blurred == {name: value for name, value in every.items() if "warped" not in name}
    assert {"flicker_warped", "flicker_warped_trimmed", "flicker_warped_moving"} == every.keys() - blurred.keys()
