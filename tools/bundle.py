"""Copies the library and all libraries that it needs to one folder, so that it uses none of the host process's.

    bundle.py LIBRARY FOLDER

Libraries that every system has are left out. The others find each other by $ORIGIN and get a soname that no library
of Blender has: libOpenColorIO.so.2.1 becomes libgradus_OpenColorIO.so.2.1. TBB keeps its soname, because two copies of
TBB in one process would be two thread pools; the one loaded first serves both. The same is done for libgradus_flow.so,
if it was built; libgradus.so loads it on demand. Nothing is done if FOLDER is up to date.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

# The C and C++ run-time libraries must be those of the process. They exist wherever Blender runs.
BASE = (
    "linux-vdso",
    "ld-linux",
    "libc.so",
    "libm.so",
    "libdl.so",
    "libpthread.so",
    "librt.so",
    "libstdc++.so",
    "libgcc_s.so",
)
SHARED_WITH_HOST = ("libtbb.so",)
LOADED_LATER = ("libgradus_flow.so",)


def run(*command: str | Path) -> str:
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def needed(library: Path) -> list[str]:
    """Returns the sonames that a library needs, without those of BASE."""
    return [name for name in run("patchelf", "--print-needed", library).split() if not name.startswith(BASE)]


def resolved(library: Path) -> dict[str, Path]:
    """Returns the files of all libraries that a library needs, directly or indirectly, by their sonames."""
    found = {}
    for line in run("ldd", library).splitlines():
        name, arrow, location = line.strip().partition(" => ")
        if not arrow or name.startswith(BASE):
            continue
        if location.startswith("not found"):
            raise SystemExit(f"bundle: {library.name} needs {name}, which was not found")
        found[name] = Path(location.rsplit(" (", 1)[0])
    return found


def loaded_later(library: Path) -> list[Path]:
    """Returns the libraries in a library's folder that it loads on demand."""
    return [path for name in LOADED_LATER if (path := library.parent / name).exists()]


def private_name(soname: str) -> str:
    """Returns the soname that a library gets in the bundle."""
    return soname if soname.startswith(SHARED_WITH_HOST) else "libgradus_" + soname.removeprefix("lib")


def place(source: Path, target: Path, soname: str | None) -> None:
    """Copies a library without symbols, and renames it and the libraries that it needs."""
    shutil.copyfile(source, target)
    target.chmod(0o755)
    run("strip", "--strip-unneeded", target)
    foreign = [name for name in needed(target) if private_name(name) != name]
    renames = [argument for name in foreign for argument in ("--replace-needed", name, private_name(name))]
    # One change in each call, because patchelf 0.14 loses some changes that are made together.
    run("patchelf", "--set-rpath", "$ORIGIN", target)
    if soname:
        run("patchelf", "--set-soname", soname, target)
    if renames:
        run("patchelf", *renames, target)


def bundle(library: Path, folder: Path) -> None:
    """Fills a new folder and moves its files into `folder`, so that running processes keep their mapped old files."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".new-", dir=folder) as name:
        new = Path(name)
        place(library.resolve(), new / "libgradus.so", None)
        closure = resolved(library)
        for later in loaded_later(library):
            place(later.resolve(), new / later.name, later.name)
            closure |= resolved(later)
        for soname, path in closure.items():
            place(path.resolve(), new / private_name(soname), private_name(soname))
        for old in folder.glob("*.so*"):
            if not (new / old.name).exists():
                old.unlink()
        for file in new.iterdir():
            os.replace(file, folder / file.name)


def main() -> int:
    library, folder = Path(sys.argv[1]), Path(sys.argv[2])
    states = [path.stat() for path in (library, *loaded_later(library))]
    sources = " ".join(f"{state.st_size} {state.st_mtime_ns}" for state in states)
    stamp = f"{sources} {hashlib.sha256(Path(__file__).read_bytes()).hexdigest()}\n"
    marker = folder / ".stamp"
    if marker.exists() and marker.read_text() == stamp and (folder / "libgradus.so").exists():
        return 0
    bundle(library, folder)
    marker.write_text(stamp)
    return 0


if __name__ == "__main__":
    sys.exit(main())
