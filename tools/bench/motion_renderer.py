"""One process that renders ranges of frames of one scene with its components (motion_worker.py), and the tool that follows their motion."""

from __future__ import annotations

import json
import subprocess
from typing import Any

import numpy as np
from animation_renderer import AnimationRenderer
from motion_metrics import Passes
from renderers import RefusedError
from scenes import ROOT

TOOL = ROOT / "build" / "native" / "gradus"


class MotionRenderer(AnimationRenderer):
    script = "motion_worker.py"

    def passes(self, mode: str, samples: int, seed: int, frames: tuple[int, int], wanted: tuple[str, ...]) -> Passes:
        """The picture and passes that motion_worker.py knows by these names, each (frames, height, width, channels)."""
        out = self.folder / "passes.npz"
        self.render_to(out, mode, samples, seed, frames=frames, passes=wanted)
        with np.load(out) as stored:
            return {name: stored[name].astype(np.float64) for name in stored.files}

    def track(self, frame: int, checked: int) -> dict[str, Any]:
        """What `gradus motion` says of a frame."""
        scene = self.folder / "scene.gradus"
        self.ask({"scene": str(scene), "frame": frame, "shutter": self.variant.shutter})
        found = subprocess.run(
            [str(TOOL), "motion", str(scene), "--check", str(checked), "--threads", "0"], capture_output=True, text=True, check=False
        )
        scene.unlink()
        if found.returncode != 0:
            raise RuntimeError(found.stderr.strip())
        return json.loads(found.stdout)

    def refusal(self, mode: str) -> str:
        """Why a mode does not work here, or nothing; a try that is not counted, and loads libraries."""
        first = self.animation.frames[0]
        try:
            self.render(mode, 2, 999, frames=(first, first + 1))
        except RefusedError as error:
            return str(error)
        return ""
