"""Renders frames of one scene with components (motion_worker.py), and runs the tool that checks their motion."""

from __future__ import annotations

import json
import subprocess
from typing import Any

import numpy as np
from animation_renderer import AnimationRenderer
from motion_metrics import Passes
from paths import TOOL
from renderers import RefusedError


class MotionRenderer(AnimationRenderer):
    """Renders one animation in one variant with components."""

    script = "motion_worker.py"

    def passes(self, mode: str, samples: int, seed: int, frames: tuple[int, int], wanted: tuple[str, ...]) -> Passes:
        """Returns picture and passes by the switches of motion_worker.py, each (frames, height, width, channels)."""
        out = self.folder / "passes.npz"
        self.render_to(out, mode, samples, seed, frames=frames, passes=wanted)
        with np.load(out) as stored:
            return {name: stored[name].astype(np.float64) for name in stored.files}

    def track(self, frame: int, checked: int) -> dict[str, Any]:
        """Returns what `gradus motion` finds in a frame, with so many pixels of each component checked against the
        truth.
        """
        scene = self.folder / "scene.gradus"
        self.ask({"scene": str(scene), "frame": frame, "shutter": self.variant.shutter})
        command = [str(TOOL), "motion", str(scene), "--check", str(checked), "--threads", "0"]
        found = subprocess.run(command, capture_output=True, text=True, check=False)
        scene.unlink()
        if found.returncode != 0:
            raise RuntimeError(found.stderr.strip())
        return json.loads(found.stdout)

    def refusal(self, mode: str) -> str:
        """Returns why a mode does not work here, or "".

        Renders two frames, which also loads libraries and is not counted.
        """
        first = self.animation.frames[0]
        try:
            self.render(mode, 2, 999, frames=(first, first + 1))
        except RefusedError as error:
            return str(error)
        return ""
