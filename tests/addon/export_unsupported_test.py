"""Warnings about everything that a scene contains and Gradus does not render."""

from __future__ import annotations

import bpy
import pytest
from gradus.export import shadow_terminator
from support import recording


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


def test_a_shading_offset_is_named(scene: bpy.types.Scene, plane: bpy.types.Object) -> None:
    owner = shadow_terminator.owner(plane)
    name = next(name for name in shadow_terminator.SHADING_OFFSETS if hasattr(owner, name))
    setattr(owner, name, 0.25)
    assert warnings(scene) == ["Object 'Plane': the shading offset of its shadow terminator is ignored"]


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


def test_a_shadow_catcher_is_named(scene: bpy.types.Scene, plane: bpy.types.Object) -> None:
    plane.is_shadow_catcher = True
    assert warnings(scene) == ["Object 'Plane' is a shadow catcher and is rendered as an ordinary surface"]


def test_a_camera_of_scale_0_is_named(scene: bpy.types.Scene, plane: bpy.types.Object) -> None:
    """Regression: the picture was black without a warning. Cycles fills it with the colour of the world."""
    scene.camera.scale = (1.0, 1.0, 0.0)
    assert warnings(scene) == ["Camera 'Camera' has scale 0, so that its direction is undefined"]


@pytest.mark.parametrize("kind", ["object", "material", "asset"])
def test_cryptomatte_is_named(scene: bpy.types.Scene, plane: bpy.types.Object, kind: str) -> None:
    layer = scene.view_layers[0]
    setattr(layer, f"use_pass_cryptomatte_{kind}", True)
    assert warnings(scene) == [f"View layer '{layer.name}': Cryptomatte passes are not supported"]


def test_light_linking_is_named(scene: bpy.types.Scene, plane: bpy.types.Object) -> None:
    light = recording.add(bpy.data.lights.new("Light", "POINT"), "Light")
    if not hasattr(light, "light_linking"):
        pytest.skip("no light linking in this Blender")
    light.light_linking.receiver_collection = bpy.data.collections.new("Lit")
    assert warnings(scene) == ["Object 'Light': light linking is ignored"]


def test_kinds_that_are_not_rendered_are_named(scene: bpy.types.Scene, plane: bpy.types.Object) -> None:
    recording.add(bpy.data.volumes.new("Smoke"), "Smoke")
    assert warnings(scene) == ["Object 'Smoke' is left out: volumes are not supported"]
