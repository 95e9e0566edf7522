"""Modes of the still benchmark: engine, settings and label of each. `apply` sets one on a Blender scene.

The table needs no Blender.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

GRADUS, CYCLES, MITSUBA = "GRADUS", "CYCLES", "MITSUBA"


@dataclass(frozen=True)
class Mode:
    label: str
    engine: str
    settings: dict[str, Any] = field(default_factory=dict)


def _gradus(integrator: str, reconstruction: str, denoiser: str = "NONE") -> dict[str, Any]:
    chosen: dict[str, Any] = {"integrator": integrator, "reconstruction": reconstruction, "denoiser": denoiser}
    chosen["use_guiding"] = reconstruction != "NONE"  # plain samples show the algorithm alone
    return chosen | {"blur_glossy": 0.0, "clamp_direct": 0.0, "clamp_indirect": 0.0}


# Cycles samples as Gradus does: with its light tree, but without guiding, clamps, filter glossy and adaptive sampling.
_CYCLES_PLAIN = {
    "use_light_tree": True,
    "use_guiding": False,
    "use_adaptive_sampling": False,
    "use_denoising": False,
    "blur_glossy": 0.0,
    "sample_clamp_direct": 0.0,
    "sample_clamp_indirect": 0.0,
    "use_animated_seed": True,
}
_CYCLES_DENOISER = {
    "use_denoising": True,
    "denoiser": "OPENIMAGEDENOISE",
    "denoising_quality": "HIGH",
    "denoising_prefilter": "ACCURATE",
    "denoising_input_passes": "RGB_ALBEDO_NORMAL",
}

MODES = {
    "path": Mode("Gradus PT", GRADUS, _gradus("PATH", "NONE")),
    "path-guided": Mode("Gradus PT with path guiding", GRADUS, _gradus("PATH", "NONE") | {"use_guiding": True}),
    "gradient-none": Mode("Gradus G-PT, not reconstructed", GRADUS, _gradus("GRADIENT", "NONE")),
    "gradient-l2": Mode("Gradus G-PT + L2", GRADUS, _gradus("GRADIENT", "L2")),
    "gradient-l1": Mode("Gradus G-PT + L1", GRADUS, _gradus("GRADIENT", "L1")),
    "path-regularized": Mode("Gradus PT + REGULARIZED", GRADUS, _gradus("PATH", "REGULARIZED")),
    "gradient-regularized": Mode("Gradus G-PT + REGULARIZED", GRADUS, _gradus("GRADIENT", "REGULARIZED")),
    "path-denoised": Mode("Gradus PT + denoiser", GRADUS, _gradus("PATH", "NONE", "OIDN")),
    "regularized-denoised": Mode("Gradus PT + REGULARIZED + denoiser", GRADUS, _gradus("PATH", "REGULARIZED", "OIDN")),
    "l2-denoised": Mode("Gradus G-PT + L2 + denoiser", GRADUS, _gradus("GRADIENT", "L2", "OIDN")),
    "l1-denoised": Mode("Gradus G-PT + L1 + denoiser", GRADUS, _gradus("GRADIENT", "L1", "OIDN")),
    "auto-denoised": Mode("Gradus AUTO", GRADUS, _gradus("AUTO", "AUTO", "AUTO")),
    "auto": Mode("Gradus AUTO without its denoiser", GRADUS, _gradus("AUTO", "AUTO")),
    "auto-l2": Mode("Gradus AUTO + L2", GRADUS, _gradus("AUTO", "L2")),
    "cycles": Mode("Cycles", CYCLES, _CYCLES_PLAIN),
    "cycles-guided": Mode("Cycles with path guiding", CYCLES, _CYCLES_PLAIN | {"use_guiding": True}),
    "cycles-denoised": Mode("Cycles + denoiser", CYCLES, _CYCLES_PLAIN | _CYCLES_DENOISER),
    "cycles-shipped": Mode("Cycles as shipped", CYCLES),
    "mitsuba": Mode("Mitsuba PT", MITSUBA),
}

# Each engine is compared with its own converged image by this mode.
REFERENCES = {GRADUS: "path", CYCLES: "cycles", MITSUBA: "mitsuba"}

# The pass Error estimates the error of the delivered image. It is compared with the true error of these modes.
ESTIMATES_ERROR = {name for name, mode in MODES.items() if mode.settings.get("denoiser") == "NONE"}

# Modes of the measures of speed alone.
WITHOUT_ERRORS = ("gradient-none", "path-guided", "cycles-guided")

_CYCLES_SETTINGS = {name for mode in MODES.values() if mode.engine == CYCLES for name in mode.settings}


def apply(scene: Any, mode: Mode, samples: int, seed: int) -> None:
    """Sets engine and settings; raises ValueError for a setting or value that this Blender or this version of Gradus
    does not have.

    Settings of Cycles that the mode does not name get their defaults, since modes follow one another in one scene.
    """
    scene.render.engine = mode.engine
    target = scene.gradus if mode.engine == GRADUS else scene.cycles
    target.samples, target.seed = samples, seed
    if mode.engine == GRADUS:
        target.noise_threshold = 0.0
    else:
        for name in _CYCLES_SETTINGS.intersection(target.bl_rna.properties.keys()):
            target.property_unset(name)
    for name, value in mode.settings.items():
        # Blender accepts any attribute: assigned all the same, an unknown one would have no effect.
        if name not in target.bl_rna.properties:
            raise ValueError(f"{name} does not exist here")
        try:
            setattr(target, name, value)
        except TypeError as error:
            raise ValueError(f"{name} {value} does not exist here") from error
