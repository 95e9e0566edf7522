"""What is compared: each mode is one line of a table. `apply` sets it on a Blender scene; no Blender is needed to read the table."""

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
    return {"integrator": integrator, "reconstruction": reconstruction, "denoiser": denoiser}


# Plain path tracing by both: light tree on; no guiding, clamps, filter glossy, adaptive sampling or denoiser.
_CYCLES_PLAIN = {
    "use_light_tree": True, "use_guiding": False, "use_adaptive_sampling": False, "use_denoising": False,
    "blur_glossy": 0.0, "sample_clamp_direct": 0.0, "sample_clamp_indirect": 0.0, "use_animated_seed": True,
}  # fmt: skip
_DENOISER = {
    "use_denoising": True, "denoiser": "OPENIMAGEDENOISE", "denoising_quality": "HIGH", "denoising_prefilter": "ACCURATE",
    "denoising_input_passes": "RGB_ALBEDO_NORMAL",
}  # fmt: skip

MODES = {
    "path": Mode("Gradus PT", GRADUS, _gradus("PATH", "NONE")),
    "gradient-none": Mode("Gradus G-PT, not reconstructed", GRADUS, _gradus("GRADIENT", "NONE")),
    "gradient-l2": Mode("Gradus G-PT + L2", GRADUS, _gradus("GRADIENT", "L2")),
    "gradient-weighted": Mode("Gradus G-PT + WEIGHTED", GRADUS, _gradus("GRADIENT", "WEIGHTED")),
    "gradient-l1": Mode("Gradus G-PT + L1", GRADUS, _gradus("GRADIENT", "L1")),
    "path-regularized": Mode("Gradus PT + REGULARIZED", GRADUS, _gradus("PATH", "REGULARIZED")),
    "gradient-regularized": Mode("Gradus G-PT + REGULARIZED", GRADUS, _gradus("GRADIENT", "REGULARIZED")),
    "path-denoised": Mode("Gradus PT + denoiser", GRADUS, _gradus("PATH", "NONE", "OIDN")),
    "regularized-denoised": Mode("Gradus PT + REGULARIZED + denoiser", GRADUS, _gradus("PATH", "REGULARIZED", "OIDN")),
    "l2-denoised": Mode("Gradus G-PT + L2 + denoiser", GRADUS, _gradus("GRADIENT", "L2", "OIDN")),
    "l1-denoised": Mode("Gradus G-PT + L1 + denoiser", GRADUS, _gradus("GRADIENT", "L1", "OIDN")),
    "gradient-denoised": Mode("Gradus G-PT + WEIGHTED + denoiser", GRADUS, _gradus("GRADIENT", "WEIGHTED", "OIDN")),
    "auto-denoised": Mode("Gradus AUTO + AUTO denoiser", GRADUS, _gradus("AUTO", "AUTO", "AUTO")),
    "auto": Mode("Gradus AUTO", GRADUS, _gradus("AUTO", "AUTO")),
    "auto-l2": Mode("Gradus AUTO + L2", GRADUS, _gradus("AUTO", "L2")),
    "cycles": Mode("Cycles", CYCLES, _CYCLES_PLAIN),
    "cycles-denoised": Mode("Cycles + denoiser", CYCLES, _CYCLES_PLAIN | _DENOISER),
    "cycles-shipped": Mode("Cycles as shipped", CYCLES),
    "mitsuba": Mode("Mitsuba PT", MITSUBA),
}
REFERENCES = {GRADUS: "path", CYCLES: "cycles", MITSUBA: "mitsuba"}  # each engine against its own converged image

ESTIMATES_ERROR = {name for name, mode in MODES.items() if mode.settings.get("denoiser") == "NONE"}  # of the image that is compared

_CYCLES_OWN = {name for mode in MODES.values() if mode.engine == CYCLES for name in mode.settings}


def apply(scene: Any, mode: Mode, samples: int, seed: int) -> None:
    """Sets engine and settings; raises ValueError for what this Blender or this version of Gradus refuses."""
    scene.render.engine = mode.engine
    target = scene.gradus if mode.engine == GRADUS else scene.cycles
    target.samples, target.seed = samples, seed
    settings = mode.settings
    if mode.engine == GRADUS:
        target.noise_threshold = 0.0
    else:
        known = {setting for setting in _CYCLES_OWN if hasattr(target, setting)}  # Blender 3.4 has no light tree
        settings = {setting: value for setting, value in settings.items() if setting in known}
        for setting in known:
            target.property_unset(setting)
    for setting, value in settings.items():
        if setting not in target.bl_rna.properties:  # assigned all the same, it would mean nothing
            raise ValueError(f"{setting} does not exist here")
        try:
            setattr(target, setting, value)
        except TypeError as error:
            raise ValueError(f"{setting} {value} does not exist here") from error
