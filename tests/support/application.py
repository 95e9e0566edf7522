"""Blender as an application of its own: what a user or a farm starts."""

from __future__ import annotations

import os
import signal
import subprocess
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent


@dataclass
class Outcome:
    code: int  # 124 if the time limit was exceeded
    output: str  # stdout and stderr
    seconds: float


def scripts(folder: Path, addon: Path = ROOT / "addon" / "gradus") -> Path:
    """Creates a scripts folder for BLENDER_USER_SCRIPTS that contains the add-on only. Returns its path."""
    (folder / "addons").mkdir(parents=True)
    (folder / "addons" / "gradus").symlink_to(addon, target_is_directory=True)
    return folder


def environment(folder: Path, addon: Path = ROOT / "addon" / "gradus", **changes: str | None) -> dict[str, str]:
    """Returns the environment of a process that finds the add-on, but not the user's settings.

    A change to None removes a variable.
    """
    result = {key: value for key, value in os.environ.items() if not key.startswith("BLENDER_")}
    result["PATH"] = "/usr/bin:/bin:" + result.get(
        "PATH", ""
    )  # Blender's Python takes its modules from the folder of the first python3.11 in PATH
    result["BLENDER_USER_SCRIPTS"] = str(scripts(folder / "scripts", addon))
    result["BLENDER_USER_CONFIG"] = str(folder / "config")
    for key, value in changes.items():
        result.pop(key, None)
        if value is not None:
            result[key] = value
    return result


def start(*arguments: str | Path, env: Mapping[str, str | None] | None = None, addon: Path = ROOT / "addon" / "gradus",
          folder: Path | None = None) -> subprocess.Popen:  # fmt: skip
    """Starts `blender -b --factory-startup -noaudio ARGUMENTS` and returns the process, whose stdout must be read."""
    folder = folder or Path(tempfile.mkdtemp(prefix="gradus-test-"))
    return subprocess.Popen(
        [os.environ.get("BLENDER") or "blender", "-b", "--factory-startup", "-noaudio", *map(str, arguments)],
        env=environment(folder, addon, **(env or {})),
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True,
    )  # fmt: skip


def run(*arguments: str | Path, limit: float = 120, env: Mapping[str, str | None] | None = None,
        addon: Path = ROOT / "addon" / "gradus") -> Outcome:  # fmt: skip
    """Runs Blender to its end. The add-on is available, but enabled only by the arguments "--addons", "gradus"."""
    with tempfile.TemporaryDirectory(prefix="gradus-test-") as folder:
        begin = time.monotonic()
        process = start(*arguments, env=env, addon=addon, folder=Path(folder))
        try:
            output, _ = process.communicate(timeout=limit)
            code = process.returncode
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            output, _ = process.communicate()
            code = 124
        return Outcome(code, output.decode("utf-8", "replace"), time.monotonic() - begin)
