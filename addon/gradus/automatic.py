"""What AUTO stands for before there is a render: passes are registered and panels are drawn without the library.

The library decides when it plans a render (native/src/output/options.h, native/src/render/plan.h). method_of() is the
only place where the add-on repeats its rules; tests/addon/automatic_test.py compares them with plans. This module does
not use Blender.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .setting_table import DENOISER_MINIMUM_SAMPLES

FROM_GRADIENTS = ("L2", "L1")
"""Reconstructions that need gradients, and weigh the picture against them."""

DENOISED_FROM = {"NONE": math.inf, "AUTO": DENOISER_MINIMUM_SAMPLES, "OIDN": 0}
"""Samples per pixel from which the picture is denoised, by the identifier of the setting.

In animations the samples of joined frames count, too.
"""


@dataclass(frozen=True)
class Method:
    """How a picture is made from samples. It may be simpler in the end: where gradients or a denoiser are missing."""

    reconstruction: str  # an identifier of settings.py other than AUTO
    has_gradients: bool  # whether the integrator can sample differences between pixels
    denoised_from: float  # samples per pixel from which a denoiser runs if there is one

    @property
    def is_refused(self) -> bool:
        """Returns whether the render ends with an error, because the reconstruction lacks gradients."""
        return self.reconstruction in FROM_GRADIENTS and not self.has_gradients

    @property
    def is_reconstructed(self) -> bool:
        """Returns whether Combined may differ from the sampled picture, which then gets a pass of its own."""
        return (self.reconstruction != "NONE" and not self.is_refused) or self.denoised_from < math.inf


def method_of(integrator: str, reconstruction: str, denoiser: str) -> Method:
    """Returns the method that these identifiers of settings.py stand for. A render refuses unknown ones."""
    has_gradients = integrator != "PATH"
    if reconstruction == "AUTO":
        reconstruction = "REGULARIZED" if has_gradients else "NONE"
    if denoiser == "AUTO" and reconstruction != "REGULARIZED":
        denoiser = "NONE"
    return Method(reconstruction, has_gradients, DENOISED_FROM.get(denoiser, math.inf))
