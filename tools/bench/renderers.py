"""The processes that render a scene: one Blender for Gradus and Cycles, and one Mitsuba where it can load the scene."""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import hosts
import numpy as np
from modes import MITSUBA, MODES
from paths import HERE, ROOT
from scenes import Scene

MITSUBA_PYTHON = ROOT / ".venv" / "bench" / "bin" / "python3"
MITSUBA_READY = ROOT / ".venv" / "bench" / ".stamp"  # written by set-up when the environment is complete


class RefusedError(RuntimeError):
    """A mode does not work here, or not with this scene; the text says why."""


class Worker:
    """A process that answers jobs one after another: lines of JSON, each answer prefixed by RESULT."""

    def __init__(self, command: list[str]) -> None:
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )

    def ask(self, job: dict[str, Any]) -> dict[str, Any]:
        """Returns the answer to a job; raises RefusedError if the worker cannot do it."""
        assert self._process.stdin
        self._process.stdin.write(json.dumps(job) + "\n")
        self._process.stdin.flush()
        answer = self.answer()
        if "error" in answer:
            raise RefusedError(answer["error"])
        return answer

    def answer(self) -> dict[str, Any]:
        """Returns the next answer; raises RuntimeError if the process has ended."""
        assert self._process.stdout
        for line in self._process.stdout:
            if line.startswith("RESULT "):
                return json.loads(line.removeprefix("RESULT "))
        raise RuntimeError(f"the renderer ended with code {self._process.wait()}")

    def close(self) -> None:
        if self._process.stdin:
            self._process.stdin.close()
        try:
            self._process.wait(timeout=30)
        except subprocess.TimeoutExpired:
            self._process.kill()


def blender_worker(script: str, *arguments: object) -> Worker:
    """Starts a script of this folder in the Blender of the peers."""
    return Worker([*hosts.module_command(HERE / script), *map(str, arguments)])


class Renderers:
    """All engines on one scene at one size."""

    def __init__(self, scene: Scene, size: tuple[int, int]) -> None:
        self._folder = tempfile.TemporaryDirectory()
        self._size = size
        self._blender = blender_worker("worker.py", scene.path, *size)
        self._mitsuba: Worker | None = None
        self._compiled: set[int] = set()  # sample counts for which Mitsuba has compiled its kernels

    def render(
        self, mode: str, samples: int, seed: int, bounces: int | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Returns the image and the worker's answer. `bounces` replaces all bounce limits of the file."""
        job: dict[str, Any] = {"mode": mode, "samples": samples, "seed": seed}
        if bounces is not None:
            job["bounces"] = bounces
        return self._ask(job)

    def estimated_error(self, mode: str, samples: int, seed: int) -> np.ndarray:
        """Returns the pass Error (height, width) of the same image, which is rendered again because the pass takes
        time.
        """
        return self._ask({"mode": mode, "samples": samples, "seed": seed, "error": True})[0][:, :, 3]

    def store_film(self, mode: str, samples: int, seed: int, path: Path) -> None:
        """Renders an image and stores its film in a file."""
        self._ask({"mode": mode, "samples": samples, "seed": seed, "film": str(path)})

    def _ask(self, job: dict[str, Any]) -> tuple[np.ndarray, dict[str, Any]]:
        out = Path(self._folder.name) / "image.npy"
        job["out"] = str(out)
        if MODES[job["mode"]].engine == MITSUBA:
            worker = self._mitsuba_worker()
            if job["samples"] not in self._compiled:  # a first run compiles kernels, whose time does not count
                worker.ask(job)
                self._compiled.add(job["samples"])
        else:
            worker = self._blender
        answer = worker.ask(job)
        return np.load(out).astype(np.float64), answer

    def refusal(self, mode: str) -> str:
        """Returns why a mode does not work here, or "".

        Renders one sample, which also loads libraries and is not counted.
        """
        try:
            self.render(mode, 1, 999)
        except RefusedError as error:
            return str(error)
        return ""

    def _mitsuba_worker(self) -> Worker:
        if self._mitsuba is None:
            if not MITSUBA_READY.exists():
                raise RefusedError("Mitsuba is not installed: tools/setup/setup bench")
            scene = Path(self._folder.name) / "scene.npz"
            self._blender.ask({"mitsuba_scene": str(scene)})
            self._mitsuba = Worker(
                [str(MITSUBA_PYTHON), str(HERE / "mitsuba_worker.py"), str(scene), *map(str, self._size)]
            )
        return self._mitsuba

    def close(self) -> None:
        for worker in (self._blender, self._mitsuba):
            if worker:
                worker.close()
        self._folder.cleanup()
