#!/usr/bin/env python3
"""Writes addon/gradus/nodes/ops.py from gradus_nodes.h: the operations and their modes as Python enums."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
HEADER = ROOT / "native" / "include" / "gradus" / "gradus_nodes.h"
TARGET = ROOT / "addon" / "gradus" / "nodes" / "ops.py"

# Enum of the header: class in Python, prefix of its values.
ENUMS = {
    "GradusGeometryMode": ("Geometry", "GEOMETRY_"),
    "GradusTexCoordMode": ("TexCoord", "TEX_COORD_"),
    "GradusTangentMode": ("Tangent", "TANGENT_"),
    "GradusLightPathMode": ("LightPath", "LIGHT_PATH_"),
    "GradusNormalSpace": ("NormalSpace", "NORMAL_"),
    "GradusProjection": ("Projection", "PROJECTION_"),
    "GradusNoiseType": ("NoiseType", "NOISE_"),
    "GradusGradientMode": ("Gradient", "GRADIENT_"),
    "GradusSkyMode": ("Sky", "SKY_"),
    "GradusMappingMode": ("Mapping", "MAPPING_"),
    "GradusBlend": ("Blend", "BLEND_"),
    "GradusMath": ("Math", "MATH_"),
    "GradusVectorMath": ("VectorMath", "VECTOR_"),
    "GradusMapRange": ("MapRange", "MAP_RANGE_"),
    "GradusCurves": ("Curves", "CURVES_"),
    "GradusColorModel": ("ColorModel", "COLOR_"),
}


def operations(text: str) -> list[tuple[str, int, int, int]]:
    """Name, value, inputs, outputs of each operation."""
    return [(name, int(v), int(i), int(o)) for name, v, i, o in re.findall(r"^  X\((\w+), (\d+), (\d+), (\d+), [01]\)", text, re.M)]


def enum_values(text: str, enum: str, prefix: str) -> list[tuple[str, int]]:
    body = re.search(rf"typedef enum {enum} \{{(.*?)\}} {enum};", text, re.S)
    values, following = [], 0
    for name, value in re.findall(r"(GRADUS_\w+)(?: = (\d+))?", re.sub(r"/\*.*?\*/", "", body[1], flags=re.S)):
        following = int(value) if value else following
        if not name.endswith("_COUNT"):
            values.append((name.removeprefix("GRADUS_" + prefix), following))
        following += 1
    return values


def generate(text: str) -> str:
    """The module's source."""
    lines = ['"""Operations of gradus_nodes.h and their modes. Written by tools/nodes/generate_ops.py; a test compares both."""']
    lines += ["", "from __future__ import annotations", "", "from enum import IntEnum", "", "", "class Op(IntEnum):"]
    rows = operations(text)
    lines += [f"    {name} = {value}" for name, value, _, _ in rows]
    for enum, (python, prefix) in ENUMS.items():
        lines += ["", "", f"class {python}(IntEnum):"]
        lines += [f"    {name} = {value}" for name, value in enum_values(text, enum, prefix)]
    lines += ["", "", "INPUTS = {"] + [f"    Op.{name}: {inputs}," for name, _, inputs, _ in rows] + ["}"]
    lines += ['"""Number of inputs."""', "", "OUTPUTS = {"] + [f"    Op.{name}: {outputs}," for name, _, _, outputs in rows] + ["}"]
    lines += ['"""Number of outputs."""', ""]
    return "\n".join(lines)


if __name__ == "__main__":
    TARGET.write_text(generate(HEADER.read_text(encoding="utf-8")), encoding="utf-8")
