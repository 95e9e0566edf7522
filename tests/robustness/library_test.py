"""H5, I7: a library that is missing or wrong, and options, as a farm sees them."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from support.application import Outcome

ROOT = Path(__file__).resolve().parent.parent.parent
SMALL = (
    "import bpy; r = bpy.context.scene.render; r.resolution_percentage = 5; "
    "print('REGISTERED', hasattr(bpy.types.Scene, 'gradus'))"
)


def missing(library: Path) -> None:
    library.unlink()


def wrong_architecture(library: Path) -> None:
    content = bytearray(library.read_bytes())
    content[18:20] = (183).to_bytes(2, "little")  # e_machine: AArch64
    library.write_bytes(content)


def truncated(library: Path) -> None:
    content = library.read_bytes()
    library.write_bytes(content[: len(content) // 2])


def old(library: Path) -> None:
    source = library.with_suffix(".c")
    source.write_text(
        "unsigned gradus_version(void) { return 1; }\nunsigned long gradus_abi_hash(void) { return 1; }\n"
    )
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source], check=True)


def frame(blender: Callable[..., Outcome], out: Path, *arguments: str, **options: object) -> Outcome:
    head = ["--addons", "gradus", "-E", "GRADUS", "--python-expr", SMALL, "-o", f"{out}/f_####", "-F", "PNG", "-f", "1"]
    return blender(*head, "--", "--gradus-samples", "1", *arguments, **options)


@pytest.mark.parametrize("damage", [missing, wrong_architecture, truncated, old])
def test_h5_bad_library_is_one_clear_error(
    blender: Callable[..., Outcome], tmp_path: Path, damage: Callable[[Path], None]
) -> None:
    addon = tmp_path / "gradus"
    shutil.copytree(ROOT / "addon" / "gradus", addon, symlinks=True)
    damage(addon / "lib" / "libgradus.so")
    outcome = frame(blender, tmp_path, addon=addon)
    assert outcome.code == 1, outcome.output
    assert "REGISTERED True" in outcome.output
    errors = [line for line in outcome.output.splitlines() if line.startswith("Error: ")]
    assert len(errors) == 1, outcome.output
    assert "ibrary" in errors[0] and "libgradus.so" in errors[0], errors
    assert not list(tmp_path.glob("f_*"))


def test_i7_good_options(blender: Callable[..., Outcome], tmp_path: Path) -> None:
    outcome = frame(blender, tmp_path, "--other-tool", "7", "--gradus-integrator", "path", "--gradus-seed=3")
    assert outcome.code == 0, outcome.output
    assert (tmp_path / "f_0001.png").exists()


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--gradus-sampels", "4"), "sampels"),
        (("--gradus-samples", "many"), "many"),
        (("--gradus-integrator", "magic"), "magic"),
        (("--gradus-samples", "0"), "samples"),
    ],
)
def test_i7_bad_options_are_named(
    blender: Callable[..., Outcome], tmp_path: Path, arguments: tuple[str, ...], named: str
) -> None:
    outcome = frame(blender, tmp_path, *arguments)
    assert outcome.code == 1, outcome.output
    assert any(line.startswith("Error: ") and named in line for line in outcome.output.splitlines()), outcome.output
    assert not list(tmp_path.glob("f_*"))
