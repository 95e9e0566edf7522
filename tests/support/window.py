"""Blender with a window on a screen of its own (Xvfb). xdotool controls it, and screenshots show it."""

from __future__ import annotations

import os
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from support import application

Size = tuple[int, int]
USUAL: Size = (1280, 800)
SMALL: Size = (640, 400)  # is drawn in a third of the CPU time; for tests that look at no panels


class Window:
    """A running Blender. `log` is its output so far."""

    def __init__(self, process: subprocess.Popen, display: str, folder: Path, size: Size) -> None:
        self.process, self.display, self.folder, self.size = process, display, folder, size

    @property
    def log(self) -> str:
        return (self.folder / "log").read_text(errors="replace")

    def wait_for(self, text: str, limit: float = 60) -> None:
        end = time.monotonic() + limit
        while text not in self.log:
            assert self.process.poll() is None, f"Blender ended with code {self.process.returncode}\n{self.log}"
            assert time.monotonic() < end, f"no '{text}' after {limit} s\n{self.log}"
            time.sleep(0.1)

    def press(self, key: str) -> None:
        """Presses a key while the mouse is in the middle of the window."""
        middle = [str(length // 2) for length in self.size]
        command = ["xdotool", "mousemove", *middle, "key", key]
        subprocess.run(command, env=os.environ | {"DISPLAY": self.display}, check=True, timeout=20)

    def screenshot(self) -> Path:
        path = self.folder / "screen.png"
        subprocess.run(["import", "-display", self.display, "-window", "root", path], check=True, timeout=30)
        return path


END = 60.0
"""Seconds within which a killed process ends, also on a machine with much other work."""


@contextmanager
def screen(size: Size = USUAL) -> Iterator[str]:
    """Runs an X server without a screen and yields its DISPLAY."""
    reader, writer = os.pipe()
    command = [
        "Xvfb",
        "-displayfd",
        str(writer),
        "-screen",
        "0",
        f"{size[0]}x{size[1]}x24",
        "+extension",
        "GLX",
        "-nolisten",
        "tcp",
    ]
    server = subprocess.Popen(command, pass_fds=[writer], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(writer)
    try:
        number = os.read(reader, 32).decode().strip()
        assert number, "Xvfb did not start"
        yield f":{number}"
    finally:
        os.close(reader)
        server.terminate()
        server.wait(END)


@contextmanager
def blender(script: str, size: Size = USUAL) -> Iterator[Window]:
    """Runs Blender 3.4 in a full-screen window with the add-on, and runs `script` as soon as the window exists."""
    with screen(size) as display, tempfile.TemporaryDirectory(prefix="gradus-window-") as name:
        folder = Path(name)
        (folder / "script.py").write_text(script)
        environment = application.environment(folder, DISPLAY=display, MESA_SHADER_CACHE_DIR=str(cache()))
        command = ["blender", "--factory-startup", "-noaudio", "--window-geometry", "0", "0", *map(str, size)]
        with (folder / "log").open("wb") as log:
            process = subprocess.Popen(
                [*command, "--addons", "gradus", "--python", str(folder / "script.py")],
                env=environment | {"PYTHONUNBUFFERED": "1"},
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )
        try:
            yield Window(process, display, folder, size)
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.wait(END)


def cache() -> Path:
    """Returns the folder of compiled shaders, which are kept between runs because they take ten seconds."""
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "gradus" / "mesa"
    folder.mkdir(parents=True, exist_ok=True)
    return folder
