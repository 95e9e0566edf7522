"""What nodes need before a change of one property or input shows: images, curves, and values of other properties."""

from __future__ import annotations

from collections.abc import Callable
from fnmatch import fnmatch
from typing import Any

import bpy

from . import sockets, stages

NOT_MADE = {
    "ShaderNodeOutputLineStyle": "is for Freestyle",
    "ShaderNodeUVAlongStroke": "is for Freestyle",
}
"""Nodes that no engine renders in a material, and why."""

WORLD_NODES = ("ShaderNodeBackground", "ShaderNodeTexSky", "ShaderNodeTexEnvironment", "ShaderNodeOutputWorld")
"""Nodes that are shown in a world."""

LIGHT_NODES = ("ShaderNodeOutputLight", "ShaderNodeLightFalloff", "ShaderNodeTexIES")
"""Nodes that are shown in a light."""

NOISY_NODES = ("ShaderNodeAmbientOcclusion", "ShaderNodeBevel", "ShaderNodeLightPath")
"""Nodes with values that need samples."""

SETTINGS: dict[tuple[str, str], dict[str, Any]] = {
    ("ShaderNodeMix", "blend_type"): {"data_type": "RGBA"},
    ("ShaderNodeMix", "clamp_result"): {"data_type": "RGBA"},
    ("ShaderNodeMix", "factor_mode"): {"data_type": "VECTOR"},
    ("ShaderNodeTexVoronoi", "distance"): {"feature": "F2"},
    ("ShaderNodeTexVoronoi", "normalize"): {"feature": "F1"},
    ("ShaderNodeTexWave", "rings_direction"): {"wave_type": "RINGS"},
    ("ShaderNodeTexImage", "projection_blend"): {"projection": "BOX"},
    ("ShaderNodeTangent", "axis"): {"direction_type": "RADIAL"},
    ("ShaderNodeTangent", "uv_map"): {"direction_type": "UV_MAP"},
    ("ShaderNodeNormalMap", "uv_map"): {"space": "TANGENT"},
    ("ShaderNodeTexSky", "turbidity"): {"sky_type": "HOSEK_WILKIE"},
    ("ShaderNodeTexSky", "ground_albedo"): {"sky_type": "HOSEK_WILKIE"},
    ("ShaderNodeTexSky", "sun_direction"): {"sky_type": "PREETHAM"},
    ("ShaderNodeValToRGB", "color_ramp.hue_interpolation"): {"color_ramp.color_mode": "HSV"},
    ("ShaderNodeBsdfHairPrincipled", "*"): {},
}
"""Values of other properties with which a property has an effect, by node and property."""

INPUTS: dict[tuple[str, str], dict[str, Any]] = {
    ("ShaderNodeBsdfPrincipled", "Coat*"): {"Coat Weight": 1.0},
    ("ShaderNodeBsdfPrincipled", "Clearcoat*"): {"Clearcoat": 1.0},
    ("ShaderNodeBsdfPrincipled", "Sheen*"): {"Sheen Weight": 1.0, "Sheen": 1.0},
    ("ShaderNodeBsdfPrincipled", "Emission*"): {
        "Emission Strength": 0.5,
        "Emission Color": (0.7, 0.4, 0.9, 1.0),
        "Emission": (0.7, 0.4, 0.9, 1.0),
    },
    ("ShaderNodeBsdfPrincipled", "Anisotropic*"): {"Metallic": 1.0, "Anisotropic": 0.7, "Roughness": 0.3},
    ("ShaderNodeBsdfPrincipled", "Tangent"): {"Metallic": 1.0, "Anisotropic": 0.7, "Roughness": 0.3},
    ("ShaderNodeBsdfPrincipled", "Subsurface*"): {"Subsurface Weight": 1.0, "Subsurface": 1.0},
    ("ShaderNodeBsdfPrincipled", "Transmission Roughness"): {"Transmission": 1.0, "Roughness": 0.1},
    ("ShaderNodeBsdfPrincipled", "Transmission"): {"Roughness": 0.2},
    ("ShaderNodeBsdfPrincipled", "Thin Film*"): {"Thin Film Thickness": 400.0, "Roughness": 0.2},
    ("ShaderNodeBsdfPrincipled", "Specular*"): {"Roughness": 0.2},
    ("ShaderNodeBsdfPrincipled", "Diffuse Roughness"): {"Specular IOR Level": 0.0},
    ("ShaderNodeBsdfMetallic", "Thin Film*"): {"Thin Film Thickness": 400.0},
    ("ShaderNodeBsdfGlass", "Thin Film*"): {"Thin Film Thickness": 400.0},
    # A pixel of these small pictures is the step of bumps before 4.2, over which a product of patterns is not straight.
    ("ShaderNodeVectorDisplacement", "Scale"): {"Vector": (0.6, 0.8, 0.4, 1.0)},
    ("ShaderNodeWireframe", "use_pixel_size"): {"Size": 5.0},
    ("ShaderNodeBsdfMetallic", "Rotation"): {"Anisotropy": 0.7},
    ("ShaderNodeBsdfMetallic", "Tangent"): {"Anisotropy": 0.7},
    ("ShaderNodeBsdfGlossy", "Rotation"): {"Anisotropy": 0.7, "Roughness": 0.3},
    ("ShaderNodeBsdfGlossy", "Tangent"): {"Anisotropy": 0.7, "Roughness": 0.3},
    ("ShaderNodeBsdfAnisotropic", "Rotation"): {"Anisotropy": 0.7, "Roughness": 0.3},
    ("ShaderNodeBsdfAnisotropic", "Tangent"): {"Anisotropy": 0.7, "Roughness": 0.3},
}
"""Values of inputs, those that exist, with which another input or a property has an effect, by node and name of it."""

STRINGS = {"uv_map": "Second", "attribute_name": "Second", "layer_name": "Col"}
"""Other values of texts."""

INNER = {
    "ShaderNodeValToRGB": ("color_ramp",),
    "ShaderNodeRGBCurve": ("mapping",),
    "ShaderNodeVectorCurve": ("mapping",),
    "ShaderNodeFloatCurve": ("mapping",),
}
"""Structures within nodes whose properties count as well; textures have their mapping."""

SKIPPED = (
    "location*",
    "width*",
    "height",
    "color",
    "select",
    "show_*",
    "hide",
    "use_custom_color",
    "warning_propagation",
    "bl_*",
    "label",
    "parent",
    "dimensions",
    "color_tag",
    "active_*",
    "is_active_output",
    "use_auto_update",
    "tone",
    "image_user",
)
"""Properties that do not concern the picture."""


def settings_for(kind: str, path: str) -> dict[str, Any]:
    return SETTINGS.get((kind, path), {})


def inputs_for(kind: str, name: str) -> dict[str, Any]:
    for (node, pattern), values in INPUTS.items():
        if node == kind and fnmatch(name, pattern):
            return values
    return {}


def _image(node: Any) -> None:
    node.image = stages.pattern_image()


def _curve(node: Any) -> None:
    for index, curve in enumerate(node.mapping.curves):
        curve.points.new(0.4, 0.2 + 0.15 * index)
    node.mapping.update()


def _ramp(node: Any) -> None:
    ramp = node.color_ramp
    ramp.elements[0].color, ramp.elements[1].color = (0.8, 0.1, 0.2, 1.0), (0.1, 0.6, 0.3, 0.7)
    ramp.elements.new(0.45).color = (0.2, 0.3, 0.9, 0.9)


def _group(node: Any) -> None:
    tree = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket("Value", in_out="INPUT", socket_type="NodeSocketFloat")
        tree.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    else:
        tree.inputs.new("NodeSocketFloat", "Value")
        tree.outputs.new("NodeSocketColor", "Color")
    first, last, ramp = (tree.nodes.new(name) for name in ("NodeGroupInput", "NodeGroupOutput", "ShaderNodeValToRGB"))
    _ramp(ramp)
    tree.links.new(first.outputs[0], ramp.inputs[0])
    tree.links.new(ramp.outputs[0], last.inputs[0])
    node.node_tree = tree


def _luminaire(node: Any) -> None:
    text = bpy.data.texts.new("luminaire.ies")
    text.write(
        "IESNA:LM-63-1995\nTILT=NONE\n1 1000 1 5 3 1 2 0 0 0\n1 1 50\n0 15 30 60 90\n0 90 180\n"
        "1000 900 200 10 0\n1000 700 400 50 0\n1000 500 900 20 0\n"
    )
    node.ies = text


def _layer(node: Any) -> None:
    node.layer_name = "Col"


def _attribute(node: Any) -> None:
    node.attribute_name = "Col"
    bpy.context.scene.view_layers[0]["Col"] = bpy.context.scene["Col"] = (0.3, 0.6, 0.2)
    for obj in bpy.context.scene.objects:
        obj["Col"] = (0.7, 0.4, 0.5)


def _number(node: Any) -> None:
    node.outputs[0].default_value = 0.4


def _color(node: Any) -> None:
    node.outputs[0].default_value = (0.3, 0.6, 0.4, 1.0)


def _normal(node: Any) -> None:
    node.outputs[0].default_value = (0.3, 0.4, 0.866)


def _rays(node: Any) -> None:
    # The mean normal of few rays is made to length 1, so that it depends on how the engine distributes them.
    node.samples = 16


def _bundle(node: Any) -> None:
    node.bundle_items.new("RGBA", sockets.ITEM)


def _evaluation(node: Any) -> None:
    node.output_items.new("RGBA", sockets.ITEM)


PREPARE: dict[str, Callable[[Any], None]] = {
    "ShaderNodeTexImage": _image,
    "ShaderNodeTexEnvironment": _image,
    "ShaderNodeRGBCurve": _curve,
    "ShaderNodeVectorCurve": _curve,
    "ShaderNodeFloatCurve": _curve,
    "ShaderNodeValToRGB": _ramp,
    "ShaderNodeGroup": _group,
    "ShaderNodeTexIES": _luminaire,
    "ShaderNodeVertexColor": _layer,
    "ShaderNodeAttribute": _attribute,
    "ShaderNodeValue": _number,
    "ShaderNodeRGB": _color,
    "ShaderNodeNormal": _normal,
    "ShaderNodeBevel": _rays,
    "NodeCombineBundle": _bundle,
    "NodeSeparateBundle": _bundle,
    "NodeEvaluateClosure": _evaluation,
}
"""Functions that give a new node what it shows."""
