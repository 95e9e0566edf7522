"""The benchmark's measures of animations, on sequences whose flicker is known."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools" / "bench"))
import temporal_metrics as measures  # noqa: E402
from metrics import relative_to  # noqa: E402

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


SEEDS = (REFERENCE + noise(1, *SHAPE), REFERENCE + noise(2, *SHAPE))
EXACT = (REFERENCE, REFERENCE)
LEVEL = REFERENCE.mean(axis=3)
ALL = slice(0, FRAMES)
EXPECTED = DEVIATION**2 * (1.0 / (1e-3 + LEVEL**2)).mean()  # relMSE of noise


def found(first: np.ndarray, second: np.ndarray, halves: measures.Halves = EXACT, **more: Any) -> dict[str, float]:
    return measures.error_measures((first, second), halves, **{"level": LEVEL, "checked": ALL} | more)


def test_independent_noise_flickers_by_twice_its_energy_and_is_no_bias() -> None:
    measured = found(*SEEDS)
    assert measured["relmse_noise"] == pytest.approx(EXPECTED, rel=0.03)
    assert measured["flicker_noise"] == pytest.approx(2.0 * EXPECTED, rel=0.05)
    assert measured["relmse"] == pytest.approx(EXPECTED, rel=0.05)
    for name in ("relmse", "flicker"):
        assert abs(measured[f"{name}_bias"]) < 4.0 * measured[f"{name}_bias_error"]
        assert measured[f"{name}_bias_error"] < 0.02 * EXPECTED


def test_noise_that_stays_does_not_flicker() -> None:
    measured = found(*(REFERENCE + noise(seed, *SHAPE[1:]) for seed in (1, 2)))
    assert measured["relmse_noise"] == pytest.approx(EXPECTED, rel=0.1)
    assert measured["flicker"] < 1e-20


def test_an_error_that_all_seeds_share_is_bias() -> None:
    """The noise of seeds and of the reference does not count as bias, however large it is."""
    halves = (REFERENCE + noise(3, *SHAPE), REFERENCE + noise(4, *SHAPE))
    measured = found(*(seed + 0.2 for seed in SEEDS), halves)
    assert measured["relmse_bias"] == pytest.approx(4.0 * EXPECTED, rel=0.05)
    assert measured["relmse_noise"] == pytest.approx(EXPECTED, rel=0.03)
    assert measured["relmse"] == pytest.approx(5.0 * EXPECTED, rel=0.05)
    assert abs(measured["flicker_bias"]) < 0.1 * EXPECTED, "it is the same in all frames"


def test_bias_that_turns_its_sign_each_frame_flickers_by_four_times_its_energy() -> None:
    sign = np.array([1.0, -1.0] * (FRAMES // 2))[:, None, None, None]
    measured = found(*(seed + DEVIATION * sign for seed in SEEDS))
    assert measured["relmse_bias"] == pytest.approx(EXPECTED, rel=0.1)
    assert measured["flicker_bias"] == pytest.approx(4.0 * EXPECTED, rel=0.1)
    assert measured["flicker_noise"] == pytest.approx(2.0 * EXPECTED, rel=0.05)


def test_motion_in_the_reference_is_no_flicker() -> None:
    assert found(REFERENCE, REFERENCE)["flicker"] == 0.0
    assert found(STATIC, STATIC)["flicker_bias"] > 0.05, "a static picture flickers against a moving reference"


def test_noise_is_that_of_all_frames_and_bias_that_of_the_checked_ones() -> None:
    checked = slice(3, 7)
    halves = (REFERENCE[checked], REFERENCE[checked])
    seeds, shifted = [seed.copy() for seed in SEEDS], [REFERENCE.copy(), REFERENCE.copy()]
    for seed, clean in zip(seeds, shifted, strict=True):
        seed[checked] = REFERENCE[checked]
        clean[0] += 0.2
        clean[checked] += 0.1
    level = np.ones_like(LEVEL)
    measured = found(*seeds, halves, level=level, checked=checked)
    assert measured["relmse_noise"] == pytest.approx(0.6 * DEVIATION**2 / 1.001, rel=0.03)
    assert measured["flicker_noise"] == pytest.approx((2 * 4 + 2) / 9 * DEVIATION**2 / 1.001, rel=0.05)
    assert measured["relmse_bias"] == measured["flicker_bias"] == 0.0
    measured = found(*shifted, halves, level=level, checked=checked)
    assert measured["relmse_bias"] == pytest.approx(0.01 / 1.001)
    assert measured["flicker_bias"] == pytest.approx(0.0, abs=1e-20)


def test_changes_are_relative_to_the_frame_that_they_lead_to() -> None:
    level = np.where(np.arange(FRAMES) % 2, 1.0, 10.0)[:, None, None] + np.zeros(SHAPE[:3])
    seeds = (REFERENCE[:2], REFERENCE[:2] + noise(1, *SHAPE)[:2])
    measured = found(*seeds, (REFERENCE[:2], REFERENCE[:2]), level=level[:2], checked=slice(0, 2))
    assert measured["flicker_noise"] == pytest.approx(DEVIATION**2 / 1.001, rel=0.15)


def test_bias_below_zero_is_not_subtracted_from_the_noise() -> None:
    """Errors of opposite sign have a negative product."""
    measured = found(REFERENCE + 0.1, REFERENCE - 0.1)
    assert measured["relmse_bias"] < 0.0
    assert measured["relmse"] == measured["relmse_noise"] > 0.0


def test_fireflies_are_trimmed() -> None:
    """A firefly of a seed or of a half of the reference leaves the trimmed means."""
    bright, half = REFERENCE.copy(), REFERENCE.copy()
    bright[4, 3, 5] += 1e4
    half[6, 7, 9] -= 1e4
    measured = found(bright, REFERENCE + 0.1, (REFERENCE, half))
    assert measured["relmse_noise"] > 1e3
    assert measured["relmse_noise_trimmed"] == pytest.approx(0.5 * EXPECTED, rel=0.02)
    assert measured["relmse_bias_trimmed"] == 0.0 != measured["relmse_bias"]
    assert measures.trimmed_mean(measures.error_map(bright, REFERENCE, NONE)) == 0.0


def test_rare_light_of_the_reference_does_not_bias_the_trimmed_bias() -> None:
    """Half of the picture gets its light from one sample in 40: pixels in which both halves lack it are no bias."""
    shape = (4, 64, 160, 3)
    level, lit = np.full(shape[:3], 1.0), np.zeros(shape, bool)
    lit[:, :, :80] = True

    def half(seed: int) -> np.ndarray:
        found = np.random.default_rng(seed).random((*shape[:3], 1)) < 1.0 / 40.0
        return np.where(lit, 40.0 * found, 1.0)

    exact, halves = np.ones(shape), (half(1), half(2))
    measured = found(exact, exact, halves, level=level, checked=slice(0, 4))
    best = measures._best(measures.noise_map(*halves, level))
    assert measures.bias_map(exact, exact, halves, level)[best].mean() > 0.02, "the case shows nothing"
    assert abs(measured["relmse_bias_trimmed"]) < 4.0 * measured["relmse_bias_error"]
    assert measured["relmse_bias_error"] < 0.3


def test_the_wake_is_what_the_shadow_left_in_the_last_frames() -> None:
    level = np.ones((12, 4, 100))
    for frame in range(12):
        level[frame, :, 5 * frame : 5 * frame + 10] = 0.3
    wake = measures.wake(level)
    assert not wake[0].any()
    assert [np.flatnonzero(wake[frame, 0]).tolist() for frame in (2, 6)] == [list(range(10)), list(range(10, 30))]
    errors = np.zeros((12, 4, 100, 3)) + 0.5 * wake[..., None]
    zero = np.zeros_like(errors)
    assert measures.error_in(wake, (errors, errors), (zero, zero), level) == pytest.approx(0.25 / 1.001)
    assert measures.error_in(~wake, (errors, errors), (zero, zero), level) == 0.0


def test_lost_light_darkens_the_mean() -> None:
    halves = (1.1 * REFERENCE, 0.9 * REFERENCE)
    assert measures.mean_light(0.97 * REFERENCE, halves) == pytest.approx(0.97)


def test_noise_of_the_reference_is_subtracted_from_errors_of_one_seed() -> None:
    variance = np.full(SHAPE, DEVIATION**2)
    vectors = vectors_of_motion()
    error, warped = [], []
    for seed in range(32):
        reference = REFERENCE + noise(seed, *SHAPE)
        error.append(measures.error_map(REFERENCE, reference, variance).mean())
        warped.append(np.nanmean(measures.warped_flicker_map(REFERENCE, reference, variance, vectors)))
    assert max(abs(np.mean(error)), abs(np.mean(warped))) < 0.04 * EXPECTED
    expected = DEVIATION**2 * (1.0 / relative_to(REFERENCE)).mean()
    assert measures.error_map(SEEDS[0], REFERENCE, NONE).mean() == pytest.approx(expected, rel=0.03)


def vectors_of_motion() -> np.ndarray:
    """Returns pass Vector of moving_picture(): (previous - current, current - next)."""
    return np.broadcast_to(np.array((-2.0, 0.0, -2.0, 0.0)), (*SHAPE[:3], 4))


def test_noise_that_moves_with_the_surface_flickers_but_not_along_its_motion() -> None:
    wide = noise(3, HEIGHT, WIDTH + 2 * FRAMES, 3)
    images = REFERENCE + np.stack([wide[:, 2 * (FRAMES - t) :][:, :WIDTH] for t in range(FRAMES)])
    warped = measures.warped_flicker_map(images, REFERENCE, NONE, vectors_of_motion())
    assert found(images, REFERENCE)["flicker_noise"] == pytest.approx(EXPECTED, rel=0.1)
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


OFF = 6


def switched_light() -> np.ndarray:
    """Returns a light that is switched off at frame OFF."""
    return STATIC + 2.0 * (np.arange(FRAMES) < OFF)[:, None, None, None]


def shares_of(images: np.ndarray, reference: np.ndarray | None = None) -> list[float]:
    reference = switched_light() if reference is None else reference
    return measures.shares_of_old_light(images, (reference, reference), OFF)


def test_independent_frames_have_no_lag() -> None:
    shares = shares_of(switched_light() + noise(4, *SHAPE))
    assert measures.lag(shares, OFF) == measures.lead(shares, OFF) == 0


def test_noise_of_the_reference_leaves_the_shares() -> None:
    """Regression: the noise of a single reference is in the light as well as in the error."""
    halves = tuple(switched_light() + 10.0 * noise(seed, *SHAPE) for seed in (7, 8))
    images = switched_light()
    images[OFF] = 0.7 * images[OFF] + 0.3 * images[OFF - 1]
    assert measures.shares_of_old_light(images, halves, OFF)[OFF] == pytest.approx(0.3, abs=0.05)


def test_a_mean_over_past_frames_lags() -> None:
    reference = switched_light()
    images = np.stack([reference[max(0, t - 2) : t + 1].mean(axis=0) for t in range(FRAMES)])
    shares = shares_of(images)
    assert shares[OFF : OFF + 3] == pytest.approx([2 / 3, 1 / 3, 0.0])
    assert (measures.lag(shares, OFF), measures.lead(shares, OFF)) == (2, 0)


def test_light_that_goes_on_is_missing_as_light_that_goes_off_is_left() -> None:
    """The share of the old state counts, which is darkness here."""
    reference = 3.0 - switched_light()
    images = reference.copy()
    images[OFF] = 0.75 * reference[OFF] + 0.25 * reference[OFF - 1]
    assert shares_of(images, reference)[OFF : OFF + 2] == pytest.approx([0.25, 0.0])


def test_a_mean_over_coming_frames_leads() -> None:
    reference = switched_light()
    images = np.stack([reference[t : t + 3].mean(axis=0) for t in range(FRAMES)])
    shares = shares_of(images)
    assert shares[OFF - 2 : OFF + 1] == pytest.approx([-1 / 3, -2 / 3, 0.0])
    assert (measures.lag(shares, OFF), measures.lead(shares, OFF)) == (0, 2)


def test_a_light_that_never_leaves_lags_to_the_end() -> None:
    assert measures.lag(shares_of(np.broadcast_to(switched_light()[0], SHAPE)), OFF) == FRAMES - OFF
