"""Runs pytest inside a host: Blender as an application, a Python environment that has bpy, or plain Python.

    blender -b --python run_in_host.py -- ARGUMENTS            runs pytest once with these arguments
    blender -b --python run_in_host.py -- --serve DESCRIPTOR   runs pytest for every line that arrives at a socket
    python3 run_in_host.py -- --plain …                        the same without bpy, which then cannot be imported

A served line is a JSON list of pytest's arguments, and the answer to it is a line with pytest's exit code. The process
ends itself at once, without the interpreter's shutdown: the 4.5 module can hang there, and Blender's own exit code says
nothing about tests.
"""

from __future__ import annotations

import json
import os
import socket
import sys
from pathlib import Path

PLAIN = "--plain" in sys.argv
if PLAIN:
    sys.modules["bpy"] = None  # type: ignore[assignment]  # importing it fails, even if the environment has it
else:
    import bpy  # before anything that could load another TBB or Imath
import pytest  # noqa: E402

TESTS = Path(__file__).resolve().parent
ROOT = TESTS.parent


def run(arguments: list[str]) -> int:
    try:
        code = int(pytest.main([f"--rootdir={ROOT}", "-c", str(TESTS / "pytest.ini"), *arguments]))
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
    return code


class Surroundings:
    """The state of the process that a test file may change. restore() returns to the state before the first file."""

    def __init__(self) -> None:
        self.path, self.environment, self.folder = list(sys.path), dict(os.environ), os.getcwd()
        self.modules = set(sys.modules)

    def restore(self) -> None:
        sys.path[:] = self.path
        os.environ.clear()
        os.environ.update(self.environment)
        os.chdir(self.folder)
        for name in set(sys.modules) - self.modules:
            if self.is_of_tests(sys.modules[name]):
                del sys.modules[name]
        if not PLAIN:
            bpy.ops.wm.read_factory_settings()

    @staticmethod
    def is_of_tests(module: object) -> bool:
        """Returns whether a module belongs to the tests or tools of this checkout.

        The add-on stays loaded, as in Blender.
        """
        file = getattr(module, "__file__", None)
        return bool(file) and any(Path(file).is_relative_to(folder) for folder in (TESTS, ROOT / "tools"))


def serve(descriptor: int) -> None:
    surroundings = Surroundings()
    with socket.socket(fileno=descriptor) as channel, channel.makefile("r") as requests:
        for number, line in enumerate(requests):
            if number:
                surroundings.restore()
            channel.sendall(f"{run(json.loads(line))}\n".encode())


def main() -> None:
    arguments = [argument for argument in sys.argv[sys.argv.index("--") + 1 :] if argument != "--plain"]
    sys.argv = [sys.argv[0]]  # the add-on reads options after "--", and these are not its own
    sys.path[:0] = [str(TESTS), str(ROOT / "addon")]
    code = 2
    try:
        if arguments[:1] == ["--serve"]:
            serve(int(arguments[1]))
            code = 0
        else:
            code = run(arguments)
    finally:
        os._exit(code)


main()
