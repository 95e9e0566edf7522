"""One process that renders ranges of frames of one scene (animation_worker.py)."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from animation_modes import is_temporal, per_frame
from animation_scenes import Animation
from animation_variants import Variant
from renderers import RefusedError, blender_worker


class AnimationRenderer:
    """Renders one animation in one variant."""

    script = "animation_worker.py"

    def __init__(self, animation: Animation, variant: Variant) -> None:
        self.animation, self.variant = animation, variant
        self._folder = tempfile.TemporaryDirectory()
        self.folder = Path(self._folder.name)
        self._worker = blender_worker(self.script, animation.scene.path, *variant.size)

    def render(self, mode: str, samples: int, seed: int, **more: Any) -> tuple[np.ndarray, dict[str, Any]]:
        """Returns the pictures (frames, height, width, 3) and the worker's answer."""
        out = self.folder / "frames.npy"
        answer = self.render_to(out, mode, samples, seed, **more)
        return np.load(out).astype(np.float64), answer

    def render_to(self, out: Path, mode: str, samples: int, seed: int, **more: Any) -> dict[str, Any]:
        """Renders into a file and returns the worker's answer. `more` are further entries of the job."""
        job = {"mode": mode, "samples": samples, "seed": seed, "frames": self.animation.frames, "out": str(out)}
        return self.ask(job | {"shutter": self.variant.shutter} | more)

    def ask(self, job: dict[str, Any]) -> dict[str, Any]:
        return self._worker.ask(job)

    def refusal(self, mode: str) -> str:
        """Returns why a mode does not work here, or "".

        Renders two frames, which also loads libraries and is not counted.
        """
        try:
            tried = self._try(mode)
            if is_temporal(mode) and np.array_equal(tried, self._try(per_frame(mode))):
                return "its frames are reconstructed one by one"
        except RefusedError as error:
            return str(error)
        return ""

    def _try(self, mode: str) -> np.ndarray:
        first = self.animation.frames[0]
        return self.render(mode, 2, 999, frames=[first, first + 1])[0]

    def close(self) -> None:
        self._worker.close()
        self._folder.cleanup()
