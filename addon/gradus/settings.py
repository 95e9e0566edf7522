"""THE table of settings: Blender properties, command-line options and native settings are made from it; a test compares it with
the library's own table (gradus_option). No Blender here."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

from .failure import Failure

BOOL, INT, FLOAT, ENUM, TEXT, FOLDER = "BOOL", "INT", "FLOAT", "ENUM", "TEXT", "FOLDER"

MAX_INT = 2147483647
MAX_FLOAT = 3.4e38


@dataclass(frozen=True)
class Setting:
    """One setting of a scene. `native`: the field of GradusSettings with the same name takes it."""

    name: str
    kind: str
    default: Any
    label: str
    doc: str
    minimum: float = 0
    maximum: float = MAX_INT
    soft_maximum: float | None = None
    precision: int = 3
    choices: tuple[tuple[str, str, str, int], ...] = ()  # identifier, label, meaning, native value
    native: bool = True
    unit: str = "NONE"  # of Blender

    def value_of(self, identifier: str) -> int:
        """Native value of an enum identifier. Blender reads a stored number that it does not know as ""."""
        known = {choice[0]: choice[3] for choice in self.choices}
        if identifier not in known:
            raise Failure(f"{self.label} ({self.name}) has a value that this version does not know: choose one of {', '.join(known)}")
        return known[identifier]


# Identifiers that exist in the library but are refused or unfinished there do not appear: a menu promises what it shows.
INTEGRATORS = (
    ("AUTO", "Automatic", "Path tracing; for L2, L1 and WEIGHTED with differences between neighbouring pixels where they pay", 0),
    ("PATH", "Path", "Plain path tracing: the reference", 1),
    ("GRADIENT", "Gradient", "Path tracing that also samples the differences between neighbouring pixels", 2),
)
RECONSTRUCTIONS = (
    ("AUTO", "Automatic", "Regularized; none for plain path tracing, if that is asked for", 0),
    ("NONE", "None", "Deliver the sampled image", 1),
    ("L2", "L2", "Least squares: unbiased; outliers may leave small dipoles, and single values may be negative", 2),
    ("WEIGHTED", "Weighted", "Least squares by the measured noise of every pixel and difference; consistent", 3),
    ("L1", "L1", "Least absolute deviations: robust to outliers, without dipoles; biased, it may darken", 4),
    ("REGULARIZED", "Regularized", "By the features of the surfaces, the samples and their differences: least error; consistent", 5),
)
DENOISERS = (
    ("NONE", "None", "Deliver the reconstruction as it is", 0),
    (
        "AUTO",
        "Automatic",
        "Open Image Denoise where this Blender has it, from 8 samples on; nothing otherwise",
        1,
    ),
    ("OIDN", "Open Image Denoise", "That of this Blender, on the CPU; an error where it has none", 2),
)
FILTERS = (
    ("BOX", "Box", "One pixel, whatever the width", 0),
    ("GAUSSIAN", "Gaussian", "Gauss curve of the given width", 1),
    ("BLACKMAN_HARRIS", "Blackman-Harris", "Cycles' default: smooth and compact", 2),
)

DENOISER_PAYS = 8
"""Samples from which denoiser AUTO runs; the library decides, and a test compares."""

SETTINGS: tuple[Setting, ...] = (
    Setting(
        "samples", INT, 64, "Samples", "Samples per pixel, with their offset paths; with a noise threshold, on average", 1, 16777216, 4096
    ),
    Setting("min_samples", INT, 0, "Min Samples", "Least samples per pixel before a tile may stop; 0 = automatic", 0, 16777216, 4096),
    Setting(
        "noise_threshold",
        FLOAT,
        0.01,
        "Noise Threshold",
        "Tiles stop when their estimated relative error is below it, others share samples by their noise; 0 = off, all take the same "
        "number. The same threshold leaves less noise than in Cycles",
        0,
        MAX_FLOAT,
        1,
        4,
    ),
    Setting(
        "time_limit",
        FLOAT,
        0.0,
        "Time Limit",
        "Seconds of sampling for each frame and view layer, 0 = no limit; the image so far is reconstructed and delivered",
        0,
        MAX_FLOAT,
        3600,
        1,
        unit="TIME_ABSOLUTE",
    ),
    Setting("seed", INT, 0, "Seed", "Another seed gives another noise pattern", 0, MAX_INT),
    Setting(
        "use_animated_seed",
        BOOL,
        True,
        "Animated Seed",
        "Has no effect, kept for scripts: all frames have their own noise patterns",
        0,
        1,
    ),
    Setting("integrator", ENUM, "AUTO", "Integrator", "How light is sampled", choices=INTEGRATORS),
    Setting("reconstruction", ENUM, "AUTO", "Reconstruction", "How the image is made from samples and gradients", choices=RECONSTRUCTIONS),
    Setting(
        "reconstruction_alpha",
        FLOAT,
        0.0,
        "Primal Weight",
        "Weight of the sampled image against its gradients in L2 and L1; in Weighted how far the image's means are smoothed. "
        "0 = automatic: 0.4 for L2, 0.2 for the others",
        0.0,
        1e3,
        1,
    ),
    Setting(
        "denoiser",
        ENUM,
        "NONE",
        "Denoiser",
        "What takes the rest of the noise out of the result, guided by colours and normals of surfaces. Biased; animations may flicker",
        choices=DENOISERS,
    ),
    Setting("max_bounces", INT, 12, "Total", "Most bounces of a path", 0, 1024, 128),
    Setting("diffuse_bounces", INT, 4, "Diffuse", "Most diffuse bounces of a path", 0, 1024, 128),
    Setting("glossy_bounces", INT, 4, "Glossy", "Most glossy bounces of a path", 0, 1024, 128),
    Setting("transmission_bounces", INT, 12, "Transmission", "Most transmission bounces of a path", 0, 1024, 128),
    Setting("volume_bounces", INT, 0, "Volume", "Most volume scattering events of a path", 0, 1024, 128),
    Setting("transparent_max_bounces", INT, 8, "Transparent", "Most transparent surfaces that a ray passes", 0, 1024, 128),
    Setting(
        "clamp_direct", FLOAT, 0.0, "Direct Light", "Largest direct radiance of a sample, 0 = off: clamping is bias", 0, MAX_FLOAT, 100
    ),
    Setting(
        "clamp_indirect",
        FLOAT,
        0.0,
        "Indirect Light",
        "Largest indirect radiance of a sample, 0 = off: clamping is bias",
        0,
        MAX_FLOAT,
        100,
    ),
    Setting("pixel_filter", ENUM, "BLACKMAN_HARRIS", "Pixel Filter", "How samples around a pixel count for it", choices=FILTERS),
    Setting("filter_width", FLOAT, 1.5, "Filter Width", "Width of the pixel filter in pixels, as in Cycles", 0.01, 10, 10, 2),
    Setting("film_exposure", FLOAT, 1.0, "Exposure", "Factor on all radiance that is delivered", 0, MAX_FLOAT, 10),
    Setting(
        "roughness_threshold",
        FLOAT,
        0.1,
        "Roughness Threshold",
        "Lobes with a smaller alpha (roughness squared) count as specular: 0.1 is a roughness of 0.316",
        0,
        1,
        1,
    ),
    Setting(
        "use_decomposition",
        BOOL,
        False,
        "Decomposition",
        "The picture in parts, by the paths of light: each is reconstructed by itself and has passes of its own, which add up to Combined",
        0,
        1,
    ),
    Setting(
        "components",
        TEXT,
        "",
        "Components",
        "Parts by path expressions, Name=EXPRESSION;Name=EXPRESSION. E: camera; D, R, T: rough scattering, sharp reflection, sharp "
        "transmission; L: light; . for any of D R T; * + ? | ( ) as in regular expressions. Empty: Emission, Diffuse, Reflection, "
        "Transmission, and Residual for the rest",
        0,
        511,
    ),
    Setting(
        "component_replays",
        BOOL,
        True,
        "Follow Reflections",
        "In animations, what mirrors and glass show is compared with where it was, not with where they were: less flicker where the two "
        "move differently",
        0,
        1,
    ),
    Setting(
        "strict",
        BOOL,
        False,
        "Strict",
        "Ends the render with an error where Gradus would otherwise leave out or replace something and warn: missing images, nodes and "
        "objects that it does not support",
        0,
        1,
    ),
    Setting(
        "preview_samples",
        INT,
        32,
        "Preview Samples",
        "Samples per pixel of the rendered viewport and of material, world and light previews",
        1,
        1024,
        1024,
        native=False,
    ),
    Setting(
        "vector_with_motion_blur",
        BOOL,
        False,
        "Vector Pass",
        "Fill pass Vector although the picture has motion blur: whoever blurs by it would blur twice",
        0,
        1,
        native=False,
    ),
    Setting(
        "use_temporal",
        BOOL,
        True,
        "Temporal",
        "In animations half of the samples follow those of the frame before, and neighbouring frames are reconstructed together: less "
        "flicker at the same cost. Not with integrator PATH, or reconstruction NONE",
        0,
        1,
        native=False,
    ),
    Setting(
        "window_size",
        INT,
        10,
        "Window",
        "Frames that are reconstructed together; as many are sampled before the first one comes",
        2,
        100,
        20,
        native=False,
    ),
    Setting(
        "window_overlap",
        INT,
        5,
        "Overlap",
        "Frames that a window shares with the next one, at most half of it",
        1,
        50,
        10,
        native=False,
    ),
    Setting(
        "frame_store",
        FOLDER,
        "",
        "Frame Store",
        "Folder in which raw frames are kept (samples, gradients, half-buffers): animations go on from there, and the command-line tool "
        "reads them; empty = none",
        native=False,
    ),
)

BY_NAME = {setting.name: setting for setting in SETTINGS}

TEST_SWITCHES = ("independent_sampler", "first_sample")
"""Native settings that exist on the command line only."""

FROM_BLENDER = ("width", "height", "frame", "film_transparent", "use_sky", "alpha_threshold", "threads")
"""Native settings that Blender's own properties give."""

OF_COMPONENTS = frozenset(("use_decomposition", "components", "component_replays"))
"""Of final renders alone: previews and the viewport show the picture as one."""


def fill(settings: Any, properties: Any, left_out: Collection[str] = ()) -> None:
    """Copies the scene's values (attributes of `properties`) into a native.Settings; those left out are not even looked at."""
    for setting in native_settings():
        if setting.name not in left_out:
            setattr(settings, setting.name, native_value(setting, getattr(properties, setting.name)))


def native_value(setting: Setting, value: Any) -> Any:
    if setting.kind == ENUM:
        return setting.value_of(value)
    if setting.kind != TEXT:
        return value
    encoded = value.encode()
    if len(encoded) > setting.maximum:
        raise Failure(f"{setting.label} ({setting.name}) is longer than {setting.maximum:.0f} bytes")
    return encoded


def native_settings() -> Iterator[Setting]:
    return (setting for setting in SETTINGS if setting.native)
