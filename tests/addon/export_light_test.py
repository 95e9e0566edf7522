"""Lights have the units of the running Blender, compared with closed forms. light_render_test.py tests images."""

from __future__ import annotations

import math
from typing import Any

import bpy
import pytest
from support import recording

BEFORE_40 = bpy.app.version < (4, 0, 0)
HAS_NORMALIZE = bpy.app.version >= (4, 5, 0)
NO_SHADOW, SPOT_COSINE, DISK_FACING = 1, 2, 4


def _export(scene: bpy.types.Scene, kind: str, scale: tuple[float, float, float] = (1, 1, 1), **settings: Any) -> Any:
    recording.add_camera()
    data = bpy.data.lights.new("Light", kind)
    for name, value in settings.items():
        setattr(data, name, value)
    recording.add(data, "Light").scale = scale
    (light,) = recording.export(scene)[0].lights
    return light


@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_point(scene: bpy.types.Scene, radius: float) -> None:
    light = _export(scene, "POINT", energy=100.0, shadow_soft_size=radius, color=(1.0, 0.5, 0.25))
    assert list(light.strength) == pytest.approx([100 / (4 * math.pi) * c for c in (1.0, 0.5, 0.25)])
    assert light.radius == pytest.approx(radius)
    assert bool(light.flags & DISK_FACING), "soft falloff is the default from 4.1 on, and the only way before"


def test_spot(scene: bpy.types.Scene) -> None:
    light = _export(scene, "SPOT", energy=100.0, spot_size=1.2, spot_blend=0.3)
    assert light.strength[0] == pytest.approx(100 / (4 * math.pi))
    assert (light.cone, light.blend) == (pytest.approx(1.2), pytest.approx(0.3))
    assert bool(light.flags & SPOT_COSINE) == BEFORE_40


@pytest.mark.parametrize(
    "shape, factor", [("SQUARE", 1.0), ("RECTANGLE", 2.0), ("DISK", math.pi / 4), ("ELLIPSE", math.pi / 2)]
)
def test_area(scene: bpy.types.Scene, shape: str, factor: float) -> None:
    """The radiance is P/(4A) before 4.0 and P/(pi A) from then on, where A includes the scale of the object."""
    light = _export(scene, "AREA", (3.0, 0.5, 1.0), energy=100.0, shape=shape, size=0.5, size_y=1.0, spread=1.0)
    area = 0.25 * 1.5 * factor
    assert light.strength[0] == pytest.approx(100 / ((4 if BEFORE_40 else math.pi) * area), rel=1e-5)
    assert light.size[0] == pytest.approx(1.5)
    assert light.size[1] == pytest.approx(0.5 * (1.0 if shape in {"RECTANGLE", "ELLIPSE"} else 0.5))
    assert light.spread == pytest.approx(1.0)


def test_sun(scene: bpy.types.Scene) -> None:
    light = _export(scene, "SUN", energy=2.0, angle=0.5)
    assert light.strength[0] == pytest.approx(2.0)
    radiance = light.sun_radiance_per_irradiance or 1.0 / (math.pi * math.sin(0.25) ** 2)
    irradiance = 2.0 * radiance * math.pi * math.sin(0.25) ** 2
    assert irradiance == pytest.approx(1.9684 if BEFORE_40 else 2.0, abs=1e-4)


@pytest.mark.skipif(not HAS_NORMALIZE, reason="exposure, normalize and temperature came with 4.5")
@pytest.mark.parametrize(
    "kind, settings, expected",
    [
        ("POINT", {"shadow_soft_size": 0.5}, 100 * 0.25),
        ("POINT", {"shadow_soft_size": 0.0}, 100 / math.pi),
        ("SPOT", {"shadow_soft_size": 0.5}, 100 * 0.25),
        ("AREA", {"size": 0.2}, 100 / math.pi),
        ("SUN", {"angle": 0.5}, 100 * math.pi * math.sin(0.25) ** 2),
    ],
)
def test_without_normalisation(scene: bpy.types.Scene, kind: str, settings: dict[str, float], expected: float) -> None:
    assert _export(scene, kind, energy=100.0, normalize=False, **settings).strength[0] == pytest.approx(expected)


@pytest.mark.skipif(not HAS_NORMALIZE, reason="exposure, normalize and temperature came with 4.5")
def test_exposure_and_temperature(scene: bpy.types.Scene) -> None:
    light = _export(scene, "SUN", energy=1.0, exposure=1.5, use_temperature=True, temperature=3000.0)
    assert list(light.strength) == pytest.approx([2**1.5 * c for c in (1.7708, 0.8443, 0.2722)], rel=1e-3)


def test_constant_emission_is_folded(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    data = bpy.data.lights.new("Light", "POINT")
    data.energy = 4 * math.pi
    data.use_nodes = True
    node = data.node_tree.nodes["Emission"]
    node.inputs["Color"].default_value = (1.0, 0.5, 0.0, 1.0)
    node.inputs["Strength"].default_value = 3.0
    recording.add(data, "Light")
    (light,) = recording.export(scene)[0].lights
    assert list(light.strength) == pytest.approx([3.0, 1.5, 0.0])
    assert light.material == 0


def test_a_light_with_a_muted_link_to_its_output_emits_nothing(scene: bpy.types.Scene) -> None:
    """Regression: the emission of the node behind the muted link was used."""
    from gradus.export import light

    data = bpy.data.lights.new("Light", "POINT")
    data.use_nodes = True
    data.node_tree.links[0].is_muted = True
    assert light.constant_emission(data) in (None, (0.0, 0.0, 0.0))


def test_linked_emission_becomes_a_program(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    data = bpy.data.lights.new("Light", "POINT")
    data.use_nodes = True
    tree = data.node_tree
    value = tree.nodes.new("ShaderNodeValue")
    tree.links.new(value.outputs[0], tree.nodes["Emission"].inputs["Strength"])
    recording.add(data, "Light")
    recorded, _ = recording.export(scene)
    assert recorded.lights[0].material in recorded.materials


@pytest.mark.parametrize("energy", [0.0, -5.0, 1e38])
def test_e4_extreme_energy_passes_through(scene: bpy.types.Scene, energy: float) -> None:
    light = _export(scene, "SUN", energy=energy)
    assert math.isfinite(light.strength[0])


@pytest.mark.parametrize("cone", [math.radians(1), math.pi])
def test_e4_extreme_cones(scene: bpy.types.Scene, cone: float) -> None:
    assert _export(scene, "SPOT", spot_size=cone).cone == pytest.approx(cone)


def test_e4_sizes_of_zero(scene: bpy.types.Scene) -> None:
    light = _export(scene, "AREA", (0.0, 1.0, 1.0), energy=10.0, size=1.0)
    assert list(light.strength) == [0.0, 0.0, 0.0]


def test_visibility_and_shadow(scene: bpy.types.Scene) -> None:
    recording.add_camera()
    data = bpy.data.lights.new("Light", "POINT")
    obj = recording.add(data, "Light")
    obj.visible_camera, obj.visible_glossy = True, False
    if not BEFORE_40:
        data.use_shadow = False
    (light,) = recording.export(scene)[0].lights
    assert light.visibility & 1 and not light.visibility & 4
    assert bool(light.flags & NO_SHADOW) == (not BEFORE_40)
