"""One process that renders ranges of frames of one scene (animation_worker.py)."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from animation_modes import is_temporal, per_frame
from animation_scenes import Animation
from animation_variants import Variant
from renderers import RefusedError, Worker


class AnimationRenderer:
    script = "animation_worker.py"

    def __init__(self, animation: Animation, variant: Variant) -> None:
        self.animation, self.variant = animation, variant
        self._folder = tempfile.TemporaryDirectory()
        self.folder = Path(self._folder.name)
        script = Path(__file__).with_name(self.script)
        self._worker = Worker([sys.executable, str(script), str(animation.scene.path), *(str(s) for s in variant.size)])

    def render(self, mode: str, samples: int, seed: int, **more: Any) -> tuple[np.ndarray, dict]:
        """Pictures (frames, height, width, 3) and what they took."""
        out = self.folder / "frames.npy"
        answer = self.render_to(out, mode, samples, seed, **more)
        return np.load(out).astype(np.float64), answer

    def render_to(self, out: Path, mode: str, samples: int, seed: int, **more: Any) -> dict:
        job = {"mode": mode, "samples": samples, "seed": seed, "frames": self.animation.frames, "out": str(out)}
        return self.ask(job | {"shutter": self.variant.shutter} | more)

    def ask(self, job: dict) -> dict:
        return self._worker.ask(job)

    def vectors(self, samples: int) -> np.ndarray:
        """Pass Vector (frames, height, width, 4)."""
        return self.render("path", samples, 1000, vectors=True)[0]

    def refusal(self, mode: str) -> str:
        """Why a mode does not work here, or nothing. Two frames of two samples, which also loads libraries, and is not counted."""
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
