"""Makes a scene of glass and mirrors that all renderers can load: flat facets, and light from a mesh.

usage: make_faceted.py FILE
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy

sys.path.append(str(Path(__file__).resolve().parents[2] / "sample_blends"))
from builders import boxes, common  # noqa: E402


def ball(name: str, center: common.Vector, radius: float, material: bpy.types.Material) -> None:
    """Adds an icosphere of 320 facets."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=radius, location=center)
    bpy.context.object.name = name
    bpy.context.object.data.materials.append(material)


def mirror() -> bpy.types.Material:
    def build(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        node = tree.nodes.new("ShaderNodeBsdfGlossy")
        node.inputs["Color"].default_value = (0.9, 0.85, 0.7, 1.0)
        node.inputs["Roughness"].default_value = 0.0
        return node.outputs[0]

    return common.material("Mirror", build)


def main() -> None:
    common.reset()
    common.settings(640, 360)
    common.world((0, 0, 0), 0.0)
    gray, red, green = (
        common.diffuse(name, color)
        for name, color in (("Gray", (0.7,) * 3), ("Red", (0.6, 0.1, 0.05)), ("Green", (0.1, 0.5, 0.2)))
    )
    boxes.room(3.2, 2.4, 2.0, {"floor": gray, "ceiling": gray, "back": gray, "left": red, "right": green})
    common.quad(
        "Light",
        [(-0.5, -0.4, 1.99), (-0.5, 0.4, 1.99), (0.5, 0.4, 1.99), (0.5, -0.4, 1.99)],
        common.emission("Light", (1, 0.95, 0.9), 8.0),
    )
    ball("Mirror", (-0.7, 0.3, 0.5), 0.5, mirror())
    ball("Glass", (0.65, -0.2, 0.45), 0.45, common.glass("Glass"))
    common.camera((0, -4.2, 1.1), (0, 0, 0.9), lens=42)
    path = Path(sys.argv[1])
    path.parent.mkdir(parents=True, exist_ok=True)
    common.save(path)


main()
