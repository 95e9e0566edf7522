"""A user can install the zip and render in all hosts, on a Debian without development packages."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
pytestmark = pytest.mark.application

# Mounts live in a namespace of their own and end with it; the root folder is written to only under /work.
ENTER = """
set -e
mount -t proc proc "$ROOTFS/proc"
mount --bind "$WORK" "$ROOTFS/work"
for venv in bpy45 bpy50 bpy52; do
  if [ -d "$VENVS/$venv" ]; then mount --bind "$VENVS/$venv" "$ROOTFS/opt/$venv"; fi
done
if [ -n "$PYTHON" ]; then mount --bind "$PYTHON" "$ROOTFS/opt/python"; fi
path=/usr/sbin:/usr/bin:/sbin:/bin
set -- PATH=$path LC_ALL=C.UTF-8 TMPDIR=/work chroot "$ROOTFS" "$@"
exec env -i PYTHONPATH="$MODULES" LD_LIBRARY_PATH="${PYTHON:+/opt/python/lib}" HOME=/work/home "$@"
"""


@pytest.fixture(scope="module")
def package() -> Path:
    subprocess.run(["/usr/bin/python3", str(ROOT / "tools" / "package.py")], check=True, cwd=ROOT)
    return max((ROOT / "dist").glob("gradus-*.zip"), key=lambda path: path.stat().st_mtime)


@pytest.fixture(scope="module")
def bare_root() -> Path:
    if (
        os.geteuid() != 0
        or not shutil.which("unshare")
        or subprocess.run(["unshare", "-m", "true"], check=False).returncode
    ):
        pytest.skip("needs root and mount namespaces")
    return Path(
        subprocess.run(
            [str(ROOT / "tools" / "bare_root.sh")], check=True, stdout=subprocess.PIPE, text=True
        ).stdout.strip()
    )


def enter(bare_root: Path, work: Path, *command: str, python: str = "", modules: str = "") -> str:
    """Runs a command in the root folder and returns its output.

    `python` is the prefix of an interpreter for /opt/python, `modules` the PYTHONPATH of the command.
    """
    environment = os.environ | {"ROOTFS": str(bare_root), "WORK": str(work), "VENVS": str((ROOT / ".venv").resolve())}
    environment |= {"PYTHON": python, "MODULES": modules}
    done = subprocess.run(
        ["unshare", "-m", "sh", "-c", ENTER, "sh", *command],
        env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        timeout=120, check=False,
    )  # fmt: skip
    output = done.stdout.decode("utf-8", "replace")
    assert done.returncode == 0, output
    return output


def prepare(work: Path, package: Path) -> None:
    (work / "home").mkdir()
    shutil.copy(package, work / "gradus.zip")
    shutil.copy(ROOT / "tests" / "support" / "in_bare_root.py", work)


def check_picture(path: Path) -> None:
    """Expects Blender's default cube, lit, in front of a dark grey world."""
    assert path.exists(), "no picture"
    image = oiio.ImageInput.open(str(path))
    spec = image.spec()
    pixels = np.asarray(image.read_image("float")).reshape(spec.height, spec.width, spec.nchannels)
    image.close()
    assert (spec.width, spec.height) == (96, 54)
    luminance = pixels[..., :3].mean(axis=2)
    assert luminance[20:34, 40:56].mean() > 1.5 * luminance[:4, :4].mean() > 0.0


def test_application_3_4(package: Path, bare_root: Path, tmp_path: Path) -> None:
    prepare(tmp_path, package)
    script = ["--python-exit-code", "3", "--python", "/work/in_bare_root.py", "--", "/work/gradus.zip", "/work/out.png"]
    output = enter(bare_root, tmp_path, "blender", "-b", *script, "install")
    assert "IN-BARE-ROOT-FINISHED install" in output, output
    output = enter(
        bare_root, tmp_path, "blender", "-b", *script, "render"
    )  # a new process: enabled by the saved settings
    assert "IN-BARE-ROOT-FINISHED render" in output, output
    check_picture(tmp_path / "out.png")


@pytest.mark.parametrize("module", ["bpy45", "bpy50"])
def test_module(package: Path, bare_root: Path, tmp_path: Path, module: str) -> None:
    prepare(tmp_path, package)
    script = ["/work/in_bare_root.py", "/work/gradus.zip", "/work/out.png"]
    output = enter(bare_root, tmp_path, f"/opt/{module}/bin/python3", *script, "both")
    check_module(output, tmp_path)


def test_module_with_a_python_of_its_own(package: Path, bare_root: Path, tmp_path: Path) -> None:
    """Blender 5.2 needs Python 3.13, which Debian 12 does not have: the interpreter of the environment is used."""
    interpreter = ROOT / ".venv" / "bpy52" / "bin" / "python3"
    if not interpreter.exists():
        pytest.skip("needs .venv/bpy52, and so a Python 3.13")
    prefix = subprocess.run(
        [interpreter, "-c", "import sys; print(sys.base_prefix)"], check=True, stdout=subprocess.PIPE, text=True
    )
    prepare(tmp_path, package)
    command = ["/opt/python/bin/python3.13", "/work/in_bare_root.py", "/work/gradus.zip", "/work/out.png", "both"]
    modules = "/opt/bpy52/lib/python3.13/site-packages"
    check_module(enter(bare_root, tmp_path, *command, python=prefix.stdout.strip(), modules=modules), tmp_path)


def check_module(output: str, work: Path) -> None:
    assert "IN-BARE-ROOT-FINISHED both" in output, output
    assert "bl_ext.user_default.gradus" in output
    check_picture(work / "out.png")
