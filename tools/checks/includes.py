"""Checks that the folders of native/src depend on each other in one direction, and that each has its own namespace.

    includes.py [FOLDER]      default: native/src

A folder may include itself and the folders above it in FOLDERS. Its files declare things in gradus::<folder>; those of
base/ in gradus. A file may open the namespace of a folder above its own, for forward declarations.

A subfolder that SUBFOLDERS lists may include itself, those before it in the list, and the files of its folder that are
in no listed subfolder: in reconstruct/, poisson/ includes neither of the others, and regression/ not space_time/.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

FOLDERS = (
    "base", "schema", "image", "compare", "geometry", "camera", "guide", "bsdf", "shading", "light", "scene", "lpe",
    "film", "film_io", "path", "integrator", "gradient", "reconstruct", "motion", "output", "render", "animation",
    "api",
)  # fmt: skip
SUBFOLDERS = {"reconstruct": ("poisson", "regression", "space_time")}
ENDINGS = {".h", ".hpp", ".cpp", ".c"}
ROOT = Path(__file__).resolve().parents[2]

INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.M)
NAMESPACE = re.compile(r"^\s*(?:inline\s+)?namespace\s+gradus(?:::(\w+))?(?:::\w+)*\s*\{", re.M)
COMMENT_OR_TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"', re.S)


def problems(source: Path) -> Iterator[str]:
    """Yields a line for each include or namespace that violates the order. `source` is native/src."""
    for path in sorted(source.rglob("*")):
        if path.suffix in ENDINGS:
            yield from problems_of(path, source)


def problems_of(path: Path, source: Path) -> Iterator[str]:
    name = path.relative_to(source)
    folder = name.parts[0] if len(name.parts) > 1 else ""
    if folder not in FOLDERS:
        yield f"{name}: its folder is not in the list of tools/checks/includes.py"
        return
    allowed = FOLDERS[: FOLDERS.index(folder) + 1]
    text = path.read_text()
    includes = INCLUDE.findall(text)
    yield from problems_of_subfolder(name, includes)
    for included in includes:
        target = included.split("/")[0] if "/" in included else folder
        if target not in FOLDERS:
            if not (source.parent / "include" / included).is_file():
                yield f"{name}: includes {included}, which is in no folder of the list"
        elif target not in allowed:
            yield f"{name}: {folder}/ may not include {included}: {target}/ is below it"
    opened = {match or "base" for match in NAMESPACE.findall(without_comments(text))}
    defines_c_api = path.suffix == ".c" or folder == "api" or 'extern "C"' in text
    if folder not in opened and not defines_c_api:
        yield f"{name}: declares nothing in namespace {'gradus' if folder == 'base' else f'gradus::{folder}'}"
    for other in sorted(opened - set(allowed)):
        yield f"{name}: opens namespace gradus::{other}, which is not above {folder}/"
    if folder != "base" and "base" in opened:
        yield f"{name}: opens namespace gradus, which is that of base/"


def problems_of_subfolder(name: Path, includes: list[str]) -> Iterator[str]:
    """Yields a line for each include that violates the order of SUBFOLDERS. `name` is relative to native/src."""
    order = SUBFOLDERS.get(name.parts[0], ())
    if name.parts[1] not in order:
        return
    below = order[order.index(name.parts[1]) + 1 :]
    for included in includes:
        target = Path(included) if "/" in included else name.parent / included
        if target.parts[0] == name.parts[0] and target.parts[1] in below:
            yield f"{name}: {name.parts[1]}/ may not include {included}: {target.parts[1]}/ is below it"


def without_comments(text: str) -> str:
    return COMMENT_OR_TEXT.sub('""', text)


def main() -> int:
    source = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "native" / "src"
    found = list(problems(source))
    print("\n".join(found) or "includes: all folders depend on folders above them only")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
