"""The processes that render a scene: one with bpy for Gradus and Cycles, and one with Mitsuba where it can load the scene."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from modes import MITSUBA, MODES
from scenes import ROOT, Scene

HERE = Path(__file__).parent
MITSUBA_PYTHON = ROOT / ".venv/bench/bin/python3"
MITSUBA_READY = ROOT / ".venv/bench/.stamp"  # written when all of it is installed


class RefusedError(RuntimeError):
    """A mode that does not work, or not for this scene; the text says why."""


class Worker:
    """One process with one scene loaded; does jobs one after another."""

    def __init__(self, command: list[str]) -> None:
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )  # fmt: skip

    def ask(self, job: dict) -> dict:
        assert self._process.stdin and self._process.stdout
        self._process.stdin.write(json.dumps(job) + "\n")
        self._process.stdin.flush()
        for line in self._process.stdout:
            if line.startswith("RESULT "):
                answer = json.loads(line[7:])
                if "error" in answer:
                    raise RefusedError(answer["error"])
                return answer
        raise RuntimeError(f"the renderer ended with code {self._process.wait()}")

    def close(self) -> None:
        if self._process.stdin:
            self._process.stdin.close()
        try:
            self._process.wait(timeout=30)
        except subprocess.TimeoutExpired:
            self._process.kill()


class Renderers:
    """All engines on one scene at one size."""

    def __init__(self, scene: Scene, size: tuple[int, int]) -> None:
        self._folder = tempfile.TemporaryDirectory()
        self._size = [str(s) for s in size]
        self._blender = Worker([sys.executable, str(HERE / "worker.py"), str(scene.path), *self._size])
        self._mitsuba: Worker | None = None
        self._compiled: set[int] = set()

    def render(self, mode: str, samples: int, seed: int, bounces: int | None = None) -> tuple[np.ndarray, dict]:
        job = {"mode": mode, "samples": samples, "seed": seed}
        if bounces is not None:
            job["bounces"] = bounces
        return self._ask(job)

    def estimated_error(self, mode: str, samples: int, seed: int) -> np.ndarray:
        """The pass Error (height, width) of the same image, rendered again: it takes time of its own."""
        return self._ask({"mode": mode, "samples": samples, "seed": seed, "error": True})[0][:, :, 3]

    def store_frame(self, mode: str, samples: int, seed: int, path: Path) -> None:
        """Renders a raw frame into a file."""
        self._ask({"mode": mode, "samples": samples, "seed": seed, "frame": str(path)})

    def _ask(self, job: dict) -> tuple[np.ndarray, dict]:
        out = Path(self._folder.name) / "image.npy"
        job["out"] = str(out)
        worker, mode, samples = self._blender, job["mode"], job["samples"]
        if MODES[mode].engine == MITSUBA:
            worker = self._mitsuba_worker()
            if samples not in self._compiled:  # not counted: its kernels are compiled for each number of samples, once
                worker.ask(job)
                self._compiled.add(samples)
        answer = worker.ask(job)
        return np.load(out).astype(np.float64), answer

    def refusal(self, mode: str) -> str:
        """Why a mode does not work here, or nothing. A first render of one sample, which also loads libraries, and is not counted."""
        try:
            self.render(mode, 1, 999)
        except RefusedError as error:
            return str(error)
        return ""

    def _mitsuba_worker(self) -> Worker:
        if self._mitsuba is None:
            if not MITSUBA_READY.exists():
                raise RefusedError("Mitsuba is not installed: tools/setup/setup bench")
            twin = Path(self._folder.name) / "twin.npz"
            self._blender.ask({"twin": str(twin)})
            self._mitsuba = Worker([str(MITSUBA_PYTHON), str(HERE / "mitsuba_worker.py"), str(twin), *self._size])
        return self._mitsuba

    def close(self) -> None:
        for worker in (self._blender, self._mitsuba):
            if worker:
                worker.close()
        self._folder.cleanup()
