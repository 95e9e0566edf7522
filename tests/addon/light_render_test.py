"""Units of lights: the irradiance of all light types on a white diffuse plane, against closed forms.

The plane is at the origin and faces up, and the light is 3 m above it. The value of a pixel is irradiance / pi.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import pytest
from support import recording

BEFORE_40 = bpy.app.version < (4, 0, 0)
DISTANCE = 3.0


def _receiver(scene: bpy.types.Scene, node: str = "ShaderNodeBsdfDiffuse", **inputs: float) -> None:
    """Adds a small white plane that fills the view of an orthographic camera below the light."""
    material = bpy.data.materials.new("White")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    surface, output = tree.nodes.new(node), tree.nodes.new("ShaderNodeOutputMaterial")
    surface.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    for name, value in inputs.items():
        surface.inputs[name].default_value = value
    tree.links.new(surface.outputs[0], output.inputs["Surface"])
    mesh = recording.grid(1, 0.04)
    mesh.materials.append(material)
    recording.add(mesh, "Receiver")
    camera = recording.add_camera(type="ORTHO", ortho_scale=0.01, clip_start=0.01)
    camera.location.z = 1.0
    scene.world = None
    scene.render.resolution_x = scene.render.resolution_y = 16


@pytest.fixture
def irradiance(scene: bpy.types.Scene, render: Callable[..., Any]) -> Callable[..., np.ndarray]:
    """Returns a function that renders a light: irradiance(type, place=…, scale=…, **settings).

    It returns the mean RGB of the image.
    """

    def measure(
        kind: str,
        place: tuple[float, float, float] = (0, 0, DISTANCE),
        scale: tuple[float, ...] = (1, 1, 1),
        **settings: Any,
    ) -> np.ndarray:
        _receiver(scene)
        data = bpy.data.lights.new("Light", kind)
        for name, value in settings.items():
            setattr(data, name, value)
        recording.add(data, "Light", place).scale = scale
        passes = render(scene, samples=64, integrator="PATH", reconstruction="NONE", max_bounces=0)
        return math.pi * passes["Combined"][:, :, :3].mean(axis=(0, 1))

    return measure


def _rectangle(width: float, height: float, keep: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> float:
    """Returns the form factor times pi of a horizontal light, whose shape `keep` defines, seen from straight below."""
    x, y = np.meshgrid((np.arange(400) + 0.5) / 400 - 0.5, (np.arange(400) + 0.5) / 400 - 0.5)
    squared = (x * width) ** 2 + (y * height) ** 2 + DISTANCE**2
    return float((keep(x, y) * DISTANCE**2 / squared**2).sum() * width * height / 400**2)


def test_point(irradiance: Callable[..., np.ndarray]) -> None:
    found = irradiance("POINT", energy=100.0, shadow_soft_size=0.0, color=(1.0, 0.5, 0.25))
    assert found == pytest.approx(100 / (4 * math.pi) / DISTANCE**2 * np.array((1.0, 0.5, 0.25)), rel=1e-4)


def test_point_with_radius_is_a_facing_disk(irradiance: Callable[..., np.ndarray]) -> None:
    found = irradiance("POINT", energy=100.0, shadow_soft_size=0.5)
    assert found[0] == pytest.approx(100 / (4 * math.pi) / (DISTANCE**2 + 0.25), rel=0.01)


@pytest.mark.skipif(bpy.app.version < (4, 1, 0), reason="soft falloff came with 4.1")
def test_point_with_radius_as_a_sphere(irradiance: Callable[..., np.ndarray]) -> None:
    found = irradiance("POINT", energy=100.0, shadow_soft_size=0.5, use_soft_falloff=False)
    assert found[0] == pytest.approx(100 / (4 * math.pi) / DISTANCE**2, rel=0.01)


@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_spot(irradiance: Callable[..., np.ndarray], angle: float) -> None:
    """At an angle to its axis, a spot has an additional cosine before 4.0, and a smooth edge."""
    place = (DISTANCE * math.sin(angle), 0.0, DISTANCE * math.cos(angle))
    found = irradiance("SPOT", place, energy=100.0, shadow_soft_size=0.0, spot_size=1.0, spot_blend=0.5)
    edge = (math.cos(angle) - math.cos(0.5)) / ((1 - math.cos(0.5)) * 0.5)
    smooth = 1.0 if edge >= 1 else edge * edge * (3 - 2 * edge)
    extra = math.cos(angle) if BEFORE_40 else 1.0
    assert found[0] == pytest.approx(100 / (4 * math.pi) / DISTANCE**2 * math.cos(angle) * extra * smooth, rel=1e-3)


@pytest.mark.parametrize("angle", [0.0, 0.1, 0.5])
def test_sun(irradiance: Callable[..., np.ndarray], angle: float) -> None:
    expected = 2.0 * (2 * (1 / math.cos(angle / 2) - 1) / math.tan(angle / 2) ** 2 if BEFORE_40 and angle > 0 else 1.0)
    assert irradiance("SUN", energy=2.0, angle=angle)[0] == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("shape", ["SQUARE", "RECTANGLE", "DISK", "ELLIPSE"])
def test_area(irradiance: Callable[..., np.ndarray], shape: str) -> None:
    found = irradiance("AREA", scale=(1.0, 2.0, 1.0), energy=100.0, shape=shape, size=0.5, size_y=1.0)
    width, height = 0.5, 2.0 * (1.0 if shape in {"RECTANGLE", "ELLIPSE"} else 0.5)
    round_shape = shape in {"DISK", "ELLIPSE"}
    area = width * height * (math.pi / 4 if round_shape else 1.0)
    radiance = 100 / ((4 if BEFORE_40 else math.pi) * area)
    keep = (lambda x, y: x * x + y * y < 0.25) if round_shape else (lambda x, y: np.ones_like(x))
    assert found[0] == pytest.approx(radiance * _rectangle(width, height, keep), rel=0.02)


@pytest.mark.parametrize("spread, factor", [(2.0, 7.62246), (0.5, 119.334)])
def test_area_with_spread(irradiance: Callable[..., np.ndarray], spread: float, factor: float) -> None:
    """The factors were measured with Cycles 3.4. In 4.5 and 5.0 they are larger by 4/pi."""
    found = irradiance("AREA", energy=100.0, shape="SQUARE", size=0.2, spread=spread)
    assert found[0] == pytest.approx(factor * (1.0 if BEFORE_40 else 4 / math.pi), rel=0.02)


def test_area_lights_emit_on_one_side(irradiance: Callable[..., np.ndarray]) -> None:
    assert irradiance("AREA", place=(0, 0, -0.5), energy=100.0)[0] == 0.0


@pytest.mark.skipif(bpy.app.version < (4, 5, 0), reason="exposure and normalize came with 4.5")
@pytest.mark.parametrize(
    "kind, settings, expected",
    [
        ("POINT", {"shadow_soft_size": 0.0, "exposure": 1.5}, 2.50087),
        ("POINT", {"shadow_soft_size": 0.0, "normalize": False}, 3.53677),
        ("POINT", {"shadow_soft_size": 0.5, "normalize": False}, 2.70272),
        ("AREA", {"size": 0.2, "normalize": False}, 0.14126),
        ("SUN", {"angle": 0.5, "normalize": False, "energy": 2.0}, 0.38459),
    ],
)
def test_exposure_and_normalize(
    irradiance: Callable[..., np.ndarray], kind: str, settings: dict[str, Any], expected: float
) -> None:
    """The expected values were measured with Cycles 4.5."""
    assert irradiance(kind, **{"energy": 100.0, **settings})[0] == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("roughness, wanted", [(0.0, 0.0), (0.6, 1.0)])
def test_rays_pass_through_lights_without_multiple_importance(
    roughness: float, wanted: float, scene: bpy.types.Scene, render: Callable[..., Any]
) -> None:
    """As in Cycles, a mirror does not show them, while their light on diffuse surfaces is unchanged."""
    _receiver(scene, "ShaderNodeBsdfAnisotropic", Roughness=roughness)
    data = bpy.data.lights.new("Light", "AREA")
    recording.add(data, "Light", (0, 0, DISTANCE))
    means = []
    for multiple in (True, False):
        data.cycles.use_multiple_importance_sampling = multiple
        passes = render(scene, samples=256, integrator="PATH", reconstruction="NONE", max_bounces=1)
        means.append(float(passes["Combined"][:, :, :3].mean()))
    assert means[0] > 0.1
    assert means[1] == pytest.approx(wanted * means[0], rel=0.03)
