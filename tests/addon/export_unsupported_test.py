"""Warnings about everything that a scene contains and Gradus does not render."""

from __future__ import annotations

import bpy
import pytest
from gradus import passes
from support import recording
from support.nodes import new_material, output_of

OF_CHANNELS = {f"use_pass_cryptomatte_{kind}" for kind in ("object", "material", "asset")}
# Switches of older versions, whose light belongs to the diffuse passes today.
OF_SUBSURFACE = {f"use_pass_subsurface_{part}" for part in ("direct", "indirect", "color")}
COMBINED_OR_OF_BLENDER = {"use_pass_combined", "use_pass_cryptomatte_accurate", "use_pass_grease_pencil"}
"""Switches of view layers that need no pass of Gradus' table."""


def warnings(scene: bpy.types.Scene) -> list[str]:
    return recording.export(scene)[1].warnings


@pytest.fixture
def plane(scene: bpy.types.Scene) -> bpy.types.Object:
    recording.add_camera()
    return recording.add(recording.grid(1), "Plane")


def test_nothing_is_left_out_of_an_ordinary_scene(scene: bpy.types.Scene, plane: bpy.types.Object) -> None:
    recording.add(
        bpy.data.lights.new("Light", "POINT"), "Light"
    ).is_shadow_catcher = True  # Blender's default for lights
    assert warnings(scene) == []


def test_a_world_without_shadows_is_named(scene: bpy.types.Scene, plane: bpy.types.Object) -> None:
    scene.world = bpy.data.worlds.new("World")
    if not hasattr(getattr(scene.world, "cycles", None), "use_shadows"):
        pytest.skip("came with Blender 5.2")
    assert warnings(scene) == []
    scene.world.cycles.use_shadows = False
    assert warnings(scene) == ["World 'World': its light is shadowed, although its setting Shadows is off"]


def test_hair_particles_are_named(scene: bpy.types.Scene, plane: bpy.types.Object) -> None:
    modifier = plane.modifiers.new("Fur", "PARTICLE_SYSTEM")
    settings = modifier.particle_system.settings
    settings.type, settings.render_type = "HAIR", "PATH"
    assert warnings(scene) == ["Object 'Plane': hair particles are not supported"]
    scene.view_layers[0].use_strand = False
    assert warnings(scene) == []
    scene.view_layers[0].use_strand = True
    settings.render_type = "OBJECT"
    assert warnings(scene) == []


@pytest.mark.parametrize("has_volume", [False, True])
def test_a_smoke_domain_is_no_box(scene: bpy.types.Scene, plane: bpy.types.Object, has_volume: bool) -> None:
    """Regression: the box of the domain hid what was in it."""
    modifier = plane.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    recorded, _ = recording.export(scene)
    assert recorded.instances["count"] == 0
    material = new_material("Smoke")
    if has_volume:
        volume = material.node_tree.nodes.new("ShaderNodeVolumePrincipled")
        material.node_tree.links.new(volume.outputs[0], output_of(material).inputs["Volume"])
    plane.data.materials.append(material)
    expected = ["Object 'Plane' is left out: volumes are not supported"]
    assert warnings(scene) == (expected if has_volume else [])
    modifier.domain_settings.domain_type = "LIQUID"
    assert recording.export(scene)[0].instances["count"] == 1


def test_a_camera_of_scale_0_is_named(scene: bpy.types.Scene, plane: bpy.types.Object) -> None:
    """Regression: the picture was black without a warning. Cycles fills it with the colour of the world."""
    scene.camera.scale = (1.0, 1.0, 0.0)
    assert warnings(scene) == ["Camera 'Camera' has scale 0, so that its direction is undefined"]


def switch_on_all_passes(owner: bpy.types.bpy_struct) -> set[str]:
    """Switches all passes of a view layer, or of Cycles' settings of it, on and returns the names of the switches."""
    names = {item.identifier for item in owner.bl_rna.properties}
    names = {name for name in names if name.startswith(("use_pass_", "pass_render"))}
    for name in names:
        setattr(owner, name, True)
    return names


def test_passes_that_are_not_made_are_named(scene: bpy.types.Scene, plane: bpy.types.Object) -> None:
    """Regression: all but Cryptomatte were left out without a warning."""
    layer = scene.view_layers[0]
    known = {info.switch for info in (*passes.TABLE, *passes.OF_VOLUMES)}
    known |= COMBINED_OR_OF_BLENDER | OF_CHANNELS | OF_SUBSURFACE | {"use_pass_shadow_catcher"}
    known |= {"use_pass_shadow"} if bpy.app.version >= (4, 0, 0) else set()  # then a pass of EEVEE alone
    missing = {layer.bl_rna.properties[name].name for name in switch_on_all_passes(layer) - known}
    if hasattr(layer, "cycles"):  # Cycles' add-on is on
        asked = switch_on_all_passes(layer.cycles) - known
        missing |= {layer.cycles.bl_rna.properties[name].name for name in asked}
    if not missing:
        assert warnings(scene) == []
        return
    (warning,) = warnings(scene)
    start = f"View layer '{layer.name}': not supported are the passes "
    assert warning.startswith(start)
    assert sorted(warning.removeprefix(start).split(", ")) == sorted(missing)


def test_kinds_that_are_not_rendered_are_named(scene: bpy.types.Scene, plane: bpy.types.Object) -> None:
    recording.add(bpy.data.volumes.new("Smoke"), "Smoke")
    assert warnings(scene) == ["Object 'Smoke' is left out: volumes are not supported"]
