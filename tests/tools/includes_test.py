"""The check of the direction of includes (tools/checks/includes.py) finds every kind of violation."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools"))
from checks import includes  # noqa: E402

SCENE = "namespace gradus::scene {\nstruct Scene;\n}\n"


def problems(folder: Path, files: dict[str, str]) -> list[str]:
    for name, text in files.items():
        path = folder / "native" / "src" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return list(includes.problems(folder / "native" / "src"))


def test_includes_of_folders_above_and_of_the_own_folder_are_allowed(tmp_path: Path) -> None:
    (tmp_path / "native" / "include" / "gradus").mkdir(parents=True)
    (tmp_path / "native" / "include" / "gradus" / "gradus.h").write_text("")
    names = ('"light/tree.h"', '"scene/parts/part.h"', '"near.h"', "<vector>", '"gradus/gradus.h"')
    includes_above = "".join(f"#include {name}\n" for name in names)
    files = {
        "base/types.h": "namespace gradus {\nusing A = int;\n}\n",
        "scene/scene.h": includes_above + SCENE,
        "scene/parts/part.cpp": '#include "base/types.h"\nnamespace gradus::scene::parts {\n}\n',
        "scene/fake.c": "int fake;\n",
        "api/entry.cpp": 'extern "C" void gradus_entry() {}\n',
        "api/exports.map": "anything",
    }
    assert problems(tmp_path, files) == []


@pytest.mark.parametrize(
    ("file", "text", "expected"),
    [
        ("scene/scene.h", '#include "api/device.h"\n' + SCENE, "scene/ may not include api/device.h"),
        ("scene/parts/part.h", '  #  include "film/film.h"\n' + SCENE, "scene/ may not include film/film.h"),
        (
            "reconstruct/poisson/l2.h",
            '#include "reconstruct/regression/moments.h"\nnamespace gradus::reconstruct {\n}\n',
            "reconstruct/poisson/ may not include reconstruct/regression/moments.h",
        ),
        ("scene/scene.h", '#include "elsewhere/x.h"\n' + SCENE, "in no folder of the list"),
        ("scene/scene.h", "namespace gradus {\nstruct Scene;\n}\n", "declares nothing in namespace gradus::scene"),
        (
            "scene/scene.h",
            SCENE + "namespace gradus {\nstruct A;\n}\n",
            "opens namespace gradus, which is that of base/",
        ),
        ("scene/scene.h", SCENE + "namespace gradus::api {\nstruct Device;\n}\n", "opens namespace gradus::api"),
        ("scene/scene.h", "// namespace gradus::scene {\nint a;\n", "declares nothing in namespace gradus::scene"),
        ("base/types.h", "namespace gradus::scene {\n}\n", "declares nothing in namespace gradus"),
        ("oddments/x.h", "", "its folder is not in the list"),
        ("loose.h", "", "its folder is not in the list"),
    ],
)
def test_a_dependency_in_the_wrong_direction_is_named(tmp_path: Path, file: str, text: str, expected: str) -> None:
    found = problems(tmp_path, {file: text})
    assert found
    assert any(line.startswith(f"{file}: ") and expected in line for line in found)


def test_forward_declarations_of_folders_above_are_allowed(tmp_path: Path) -> None:
    assert problems(tmp_path, {"scene/scene.h": "namespace gradus::light {\nclass Tree;\n}\n" + SCENE}) == []
