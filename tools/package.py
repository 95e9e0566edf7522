"""Makes dist/gradus-<version>.zip: the folder of the add-on with the library and all libraries that it needs.

Blender 3.4 to 4.1 installs it as an add-on, later versions also as an extension: both accept a zip with a single folder
at its top level. The same sources give the same bytes.
"""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import bundle
import tomllib

ROOT = Path(__file__).resolve().parent.parent
ADDON = ROOT / "addon" / "gradus"
EMBREE_LICENSE = "share/doc/embree3/LICENSE.txt"
OPENCV_PACKAGE = "libopencv-video-dev"


def version() -> str:
    """Returns the version, on which the manifest, bl_info, the header and the build must agree."""
    header = (ROOT / "native" / "include" / "gradus" / "gradus.h").read_text()
    numbers = [re.search(rf"GRADUS_VERSION_{part} (\d+)", header).group(1) for part in ("MAJOR", "MINOR", "PATCH")]
    tree = ast.parse((ADDON / "__init__.py").read_text())
    info = next(
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info"
    )
    found = {
        "gradus.h": ".".join(numbers),
        "bl_info": ".".join(map(str, info["version"])),
        "blender_manifest.toml": tomllib.loads((ADDON / "blender_manifest.toml").read_text())["version"],
        "CMakeLists.txt": re.search(r"project\(gradus VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()).group(
            1
        ),
    }
    if len(set(found.values())) != 1:
        raise SystemExit(f"package: versions differ: {found}")
    return found["gradus.h"]


def owner(library: Path) -> str | None:
    """Returns Debian's package of a file."""
    for path in (
        library,
        Path("/usr") / library.relative_to("/"),
        Path("/") / library.relative_to("/usr") if library.is_relative_to("/usr") else None,
    ):
        if path:
            answer = subprocess.run(["dpkg-query", "-S", str(path)], capture_output=True, text=True, check=False)
            if answer.returncode == 0:
                return answer.stdout.partition(":")[0]
    return None


def licenses() -> dict[str, bytes]:
    """Returns the licence texts of the libraries in lib/ by their file names in the zip."""
    texts = {"LICENSE": (ROOT / "LICENSE").read_bytes()}
    library = ROOT / "build" / "native" / "libgradus.so"
    later = bundle.loaded_later(library)
    if later:  # OpenCV is linked into this library
        texts["lib/licenses/opencv.txt"] = Path(f"/usr/share/doc/{OPENCV_PACKAGE}/copyright").read_bytes()
    for path in {soname: path for part in (library, *later) for soname, path in bundle.resolved(part).items()}.values():
        package = owner(path.resolve())
        if package is None:
            raise SystemExit(f"package: no licence known for {path}")
        texts[f"lib/licenses/{package}.txt"] = Path(f"/usr/share/doc/{package}/copyright").read_bytes()
    cache = (ROOT / "build" / "CMakeCache.txt").read_text()
    embree = Path(re.search(r"^GRADUS_EMBREE_ROOT:PATH=(.*)$", cache, re.M).group(1))
    texts["lib/licenses/embree.txt"] = (embree / EMBREE_LICENSE).read_bytes()
    return texts


def addon_files() -> dict[str, Path]:
    sources = [path for path in ADDON.rglob("*") if path.is_file() and path.relative_to(ADDON).parts[0] != "lib"]
    files = {str(path.relative_to(ADDON)): path for path in sources if path.suffix != ".pyc"}
    libraries = {f"lib/{path.name}": path for path in (ADDON / "lib").glob("*.so*")}
    if "lib/libgradus.so" not in libraries:
        raise SystemExit("package: addon/gradus/lib has no library: make build")
    return files | libraries


def write(target: Path) -> None:
    contents = {name: path.read_bytes() for name, path in addon_files().items()} | licenses()
    partial = target.with_suffix(".part")
    with zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED) as file:
        for name in sorted(contents):
            entry = zipfile.ZipInfo(f"gradus/{name}", date_time=(2020, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if ".so" in name else 0o100644) << 16
            file.writestr(entry, contents[name])
    os.replace(partial, target)


def main() -> int:
    target = ROOT / "dist" / f"gradus-{version()}.zip"
    target.parent.mkdir(exist_ok=True)
    write(target)
    print(f"package: {target.relative_to(ROOT)}, {target.stat().st_size / 1e6:.1f} MB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
