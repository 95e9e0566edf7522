"""Settings of Cycles that have a counterpart here: bounces, caustics, clamps, Filter Glossy, film.

A scene that was made for Cycles keeps them: unless Follow Cycles is off, they stand for those that were never set for
Gradus.
"""

from __future__ import annotations

from typing import Any

from . import settings
from .export.collect import is_portal

SAME_NAME = (
    "max_bounces",
    "diffuse_bounces",
    "glossy_bounces",
    "transmission_bounces",
    "transparent_max_bounces",
    "blur_glossy",
    "caustics_reflective",
    "caustics_refractive",
    "film_exposure",
    "film_transparent_glass",
    "film_transparent_roughness",
    "filter_width",
)

_NAMES = {name: name for name in SAME_NAME} | {
    "clamp_direct": "sample_clamp_direct",
    "clamp_indirect": "sample_clamp_indirect",
    "pixel_filter": "pixel_filter_type",
}
"""The name that Cycles has for each setting. The identifiers of pixel filters are the same."""

# Types of nodes with which the light of a world is the same in all directions, so that Cycles does not sample it.
_SAME_IN_ALL_DIRECTIONS = {
    "OUTPUT_WORLD",
    "BACKGROUND",
    "ADD_SHADER",
    "MIX_SHADER",
    "RGB",
    "VALUE",
    "MATH",
    "MIX",
    "MIX_RGB",
    "BLACKBODY",
    "LIGHT_PATH",
    "REROUTE",
    "FRAME",
}


def values(scene: Any) -> dict[str, Any]:
    """Returns values for settings of Gradus from the scene's Cycles settings, or {} if Cycles is disabled."""
    cycles = getattr(scene, "cycles", None)
    return {} if cycles is None else {ours: getattr(cycles, theirs) for ours, theirs in _NAMES.items()}


def copy(scene: Any) -> None:
    """Copies the settings of Cycles."""
    for name, value in values(scene).items():
        setattr(scene.gradus, name, value)


def untouched(scene: Any) -> dict[str, Any]:
    """Returns the settings of Cycles that differ from those of Gradus and were never set for Gradus in this scene."""
    ours = scene.gradus
    return {
        name: value
        for name, value in values(scene).items()
        if not ours.is_property_set(name) and getattr(ours, name) != value
    }


def owner(scene: Any, name: str, is_followed: bool) -> tuple[Any, str]:
    """Returns what has the value of a setting that renders use: the settings of Gradus or of Cycles, and its name."""
    cycles = getattr(scene, "cycles", None) if is_followed and name in _NAMES else None
    if cycles is None or scene.gradus.is_property_set(name):
        return scene.gradus, name
    return cycles, _NAMES[name]


def warnings(scene: Any, given: set[str], is_followed: bool) -> list[str]:
    """Returns warnings about settings that differ from Cycles. given: settings that the command line sets."""
    differing = {} if is_followed else untouched(scene)
    listed = ", ".join(
        f"{settings.BY_NAME[name].label} ({name}) {_text(getattr(scene.gradus, name))} instead of {_text(value)}"
        for name, value in differing.items()
        if name not in given
    )
    ignored = ", ".join(_ignored(scene))
    texts = {
        "Settings differ from those that the scene has for Cycles (use Light Paths > Copy from Cycles)": listed,
        "Cycles would follow settings that Gradus does not have": ignored,
    }
    return [f"{start}: {items}" for start, items in texts.items() if items]


def clamp_warnings(depsgraph: Any, clamp_direct: float) -> list[str]:
    """Returns a warning if direct light is clamped and Cycles chooses among several lights or triangles that emit.

    What is chosen rarely adds more at once, so that a clamp cuts more of it. The light tree, which Cycles has since
    3.5, chooses between lights and the world much as Gradus does. What is hidden from the render of the depsgraph does
    not count.
    """
    scene = depsgraph.scene
    has_tree = getattr(getattr(scene, "cycles", None), "use_light_tree", False)
    if clamp_direct <= 0.0:
        return []
    lights, surfaces = _counts(depsgraph)
    has_world = scene.world is not None and not has_tree
    if lights + has_world + 2 * surfaces < 2:
        return []
    return [
        f"Clamp Direct is {clamp_direct:g}: Cycles chooses among lights, and among the triangles of surfaces that emit "
        "light, in another way than Gradus, so that it clamps other parts of it"
    ]


_COMMON_LIMIT = 8  # of transparent surfaces, which is Blender's default


def transparency_warnings(depsgraph: Any, transparent_max_bounces: int) -> list[str]:
    """Returns a warning if paths may reach the limit of transparent surfaces by lights that they cross.

    Cycles counts each light of some size that a ray of the camera or of a bounce crosses as such a surface, and ends
    the path at the limit.
    """
    count = sum(_can_be_crossed(obj) for obj in depsgraph.objects if obj.type == "LIGHT")
    if count == 0 or (count < transparent_max_bounces and transparent_max_bounces >= _COMMON_LIMIT):
        return []
    return [
        f"Transparent Max Bounces is {transparent_max_bounces}: Cycles also counts the lights that a ray crosses, and "
        "shows nothing behind the last one"
    ]


def _can_be_crossed(obj: Any) -> bool:
    """Returns whether rays meet the light, because it has a size and the camera or bounces see it."""
    light = obj.data
    size = {"AREA": 1.0, "SUN": 0.0}.get(light.type, getattr(light, "shadow_soft_size", 0.0))
    by_bounces = getattr(getattr(light, "cycles", None), "use_multiple_importance_sampling", True)
    return size > 0.0 and (by_bounces or getattr(obj, "visible_camera", True))


def _counts(depsgraph: Any) -> tuple[int, int]:
    """Returns the numbers of lights and of surfaces that emit."""
    lights = sum(obj.type == "LIGHT" for obj in depsgraph.objects)
    return lights, sum(obj.type != "LIGHT" and _emits(obj) for obj in depsgraph.objects)


def _emits(obj: Any) -> bool:
    """Returns whether a material of the object has a node that emits light."""
    materials = (slot.material for slot in obj.material_slots)
    return any(material is not None and _has_emission(material.node_tree) for material in materials)


def _has_emission(tree: Any) -> bool:
    """Returns whether a node tree has a node that emits light, also within groups."""
    return tree is not None and any(
        _has_emission(node.node_tree) if node.type == "GROUP" else _is_emission(node) for node in tree.nodes
    )


def _is_emission(node: Any) -> bool:
    if node.type not in {"EMISSION", "BSDF_PRINCIPLED"}:
        return False
    strength = node.inputs["Strength" if node.type == "EMISSION" else "Emission Strength"]
    color = next(node.inputs[name] for name in ("Color", "Emission Color", "Emission") if name in node.inputs)
    return _may_be_positive(strength, [strength.default_value]) and _may_be_positive(color, color.default_value[:3])


def _may_be_positive(socket: Any, values: list[float]) -> bool:
    return socket.is_linked or any(value > 0.0 for value in values)


def _ignored(scene: Any) -> list[str]:
    """Returns the settings of Cycles that were chosen, change its picture and have no counterpart."""
    cycles = getattr(scene, "cycles", None)
    if cycles is None:
        return []
    switches = {
        "Fast GI Approximation": cycles.use_fast_gi,
        "Use Pixel Jitter": getattr(cycles, "use_pixel_jitter", False),  # of developers, since 5.2
        "Texture Limit": scene.render.use_simplify and cycles.texture_limit_render != "OFF",
        "World > Max Bounces": _limits_world(scene),
        "Rolling Shutter": scene.render.use_motion_blur and cycles.rolling_shutter_type != "NONE",
    }
    return [name for name, is_on in switches.items() if is_on]


def _limits_world(scene: Any) -> bool:
    """Returns whether Cycles leaves samples of the world as a light out of paths with more bounces than its limit.

    It samples a world of one colour, or one whose sampling is off, only through portals.
    """
    of_world = getattr(scene.world and scene.world.original, "cycles", None)
    if of_world is None or of_world.max_bounces >= scene.cycles.max_bounces:
        return False
    is_sampled = of_world.sampling_method != "NONE" and not _is_plain(scene.world)
    lights = (obj for obj in scene.objects if obj.type == "LIGHT" and not obj.hide_render)
    return is_sampled or any(is_portal(light.data) for light in lights)


def _is_plain(world: Any) -> bool:
    """Returns whether the world has only nodes that are the same in all directions."""
    tree = world.node_tree if getattr(world, "use_nodes", True) else None
    return tree is None or {node.type for node in tree.nodes} <= _SAME_IN_ALL_DIRECTIONS


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
