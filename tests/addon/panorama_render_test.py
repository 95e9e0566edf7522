"""Panoramas against Cycles, pixel by pixel: visible points, distances, and the outside of the image circle."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import pytest
from mathutils import Vector
from support import images, recording

EXACT = {
    "samples": 1,
    "integrator": "PATH",
    "reconstruction": "NONE",
    "pixel_filter": "GAUSSIAN",
    "filter_width": 0.01,
    "max_bounces": 0,
}
RADIUS = 50.0

# Settings of the camera, the panorama and the frame.
CASES: dict[str, tuple[str, dict[str, Any], dict[str, Any]]] = {
    "equirectangular": ("EQUIRECTANGULAR", {}, {}),
    "limits": (
        "EQUIRECTANGULAR",
        {"latitude_min": -0.5, "latitude_max": 1.2, "longitude_min": -2.0, "longitude_max": 0.7},
        {},
    ),
    "shifted": ("EQUIRECTANGULAR", {}, {"shift": (0.1, -0.2)}),
    "cube face": ("EQUIANGULAR_CUBEMAP_FACE", {}, {"shift": (0.1, -0.2)}),
    "mirror ball": ("MIRRORBALL", {}, {"aspect": (2.0, 1.0)}),
    "equidistant": ("FISHEYE_EQUIDISTANT", {}, {}),
    "equidistant, wide": ("FISHEYE_EQUIDISTANT", {"fisheye_fov": 4.0}, {"size": (20, 34), "shift": (0.1, -0.2)}),
    "equisolid": ("FISHEYE_EQUISOLID", {"fisheye_lens": 11.0}, {}),
    "equisolid, portrait": (
        "FISHEYE_EQUISOLID",
        {"fisheye_fov": 2.0, "fisheye_lens": 15.0},
        {"size": (20, 34), "aspect": (1.0, 2.0)},
    ),
    "equisolid, vertical fit": ("FISHEYE_EQUISOLID", {}, {"fit": "VERTICAL", "shift": (0.1, -0.2)}),
    "polynomial": ("FISHEYE_LENS_POLYNOMIAL", {}, {"fit": "HORIZONTAL", "size": (20, 34)}),
    "polynomial, bent": (
        "FISHEYE_LENS_POLYNOMIAL",
        {
            "fisheye_fov": 2.5,
            "fisheye_polynomial_k0": 0.01,
            "fisheye_polynomial_k1": -0.1,
            "fisheye_polynomial_k2": 0.001,
        },
        {"aspect": (1.0, 1.5)},
    ),
    "cylinder": ("CENTRAL_CYLINDRICAL", {}, {"shift": (0.1, -0.2)}),
    "cylinder, limits": (
        "CENTRAL_CYLINDRICAL",
        {
            "central_cylindrical_range_u_min": -2.0,
            "central_cylindrical_range_u_max": 1.0,
            "central_cylindrical_range_v_min": -0.5,
            "central_cylindrical_range_v_max": 1.5,
            "central_cylindrical_radius": 2.0,
        },
        {},
    ),
}


def _prepare(scene: bpy.types.Scene) -> None:
    """Adds a ball around the camera."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=RADIUS)
    images.prepare(scene)
    scene.world = bpy.data.worlds.new("World")
    scene.world.mist_settings.depth = 2 * RADIUS
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising, cycles.max_bounces = 1, False, False, 0
    cycles.pixel_filter_type, cycles.filter_width = "GAUSSIAN", 0.01
    layer = scene.view_layers[0]
    layer.use_pass_position = layer.use_pass_z = layer.use_pass_normal = layer.use_pass_mist = True


def _camera(scene: bpy.types.Scene, kind: str, settings: dict[str, Any], frame: dict[str, Any]) -> bpy.types.Object:
    camera = recording.add_camera(
        type="PANO", sensor_width=36.0, sensor_height=20.0, sensor_fit=frame.get("fit", "AUTO")
    )
    camera.location, camera.rotation_euler = (1.0, -2.0, 3.0), (1.1, 0.2, 0.4)
    camera.data.shift_x, camera.data.shift_y = frame.get("shift", (0.0, 0.0))
    panorama = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
    if kind not in panorama.bl_rna.properties["panorama_type"].enum_items:
        pytest.skip(f"Blender {bpy.app.version_string} has no {kind}")
    panorama.panorama_type = kind
    for name, value in settings.items():
        setattr(panorama, name, value)
    render = scene.render
    render.resolution_x, render.resolution_y = frame.get("size", (36, 24))
    render.pixel_aspect_x, render.pixel_aspect_y = frame.get("aspect", (1.0, 1.0))
    if hasattr(render.image_settings, "use_exr_interleave"):
        render.image_settings.use_exr_interleave = (
            True  # 5.0 cannot write multipart files of images without square pixels
        )
    return camera


def _both(scene: bpy.types.Scene, render: Callable[..., Any]) -> tuple[Any, Any]:
    ours = render(scene, **EXACT)
    scene.render.engine = "CYCLES"
    return ours, render(scene)


@pytest.mark.parametrize("case", CASES)
def test_shows_what_cycles_shows(scene: bpy.types.Scene, render: Callable[..., Any], case: str) -> None:
    _prepare(scene)
    _camera(scene, *CASES[case])
    ours, cycles = _both(scene, render)
    seen, ours_seen = (np.any(passes["Position"] != 0.0, axis=2) for passes in (cycles, ours))
    assert (seen != ours_seen).sum() <= 1, "an outline may pass through the middle of a pixel"
    seen &= ours_seen
    assert seen.any()
    # A hundredth of a pixel, the width of the filter, is up to 2 * pi * RADIUS / 24 / 100 wide.
    away = np.linalg.norm(ours["Position"] - cycles["Position"], axis=2)[seen]
    assert np.percentile(away, 90) < 0.15 and away.max() < 1.0
    assert np.allclose(ours["Depth"][seen], cycles["Depth"][seen], rtol=5e-3)
    assert np.allclose(ours["Mist"][seen], cycles["Mist"][seen], atol=5e-3)
    assert np.allclose(ours["Normal"][seen], cycles["Normal"][seen], atol=0.15)


@pytest.mark.parametrize("transparent", [False, True])
def test_outside_of_the_image_circle_is_black_and_opaque(
    scene: bpy.types.Scene, render: Callable[..., Any], transparent: bool
) -> None:
    """As in Cycles, there are no rays outside of the image circle."""
    _prepare(scene)
    bpy.data.objects.remove(scene.objects["Sphere"])
    world = scene.world
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.25, 0.5, 1.0, 1.0)
    scene.render.film_transparent = transparent
    _camera(scene, "FISHEYE_EQUIDISTANT", {}, {"size": (24, 24)})
    ours, cycles = _both(scene, render)
    assert np.array_equal(ours["Combined"][0, 0], (0, 0, 0, 1))
    assert np.allclose(ours["Combined"][12, 12], (0, 0, 0, 0) if transparent else (0.25, 0.5, 1, 1))
    assert np.allclose(ours["Combined"], cycles["Combined"], atol=1e-5)


@pytest.mark.parametrize("kind", ["EQUIRECTANGULAR", "MIRRORBALL"])
def test_window_coordinates_are_those_of_the_picture(
    scene: bpy.types.Scene, render: Callable[..., Any], kind: str
) -> None:
    """Cycles of 3.4 mirrors those of fisheyes, later versions do not."""
    _prepare(scene)
    material = bpy.data.materials.new("Window")
    material.use_nodes = True
    tree = material.node_tree
    emission, where = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(where.outputs["Window"], emission.inputs["Color"])
    tree.links.new(
        emission.outputs[0], next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL").inputs["Surface"]
    )
    scene.objects["Sphere"].data.materials.append(material)
    _camera(scene, kind, {}, {"size": (24, 24)})
    ours, cycles = _both(scene, render)
    assert np.allclose(ours["Combined"], cycles["Combined"], atol=2e-3)
    assert np.allclose(ours["Combined"][12, 6], (6.5 / 24, 12.5 / 24, 0, 1), atol=2e-3)


@pytest.mark.parametrize("kind", ["EQUIRECTANGULAR", "MIRRORBALL", "FISHEYE_EQUIDISTANT"])
def test_depth_of_field_has_the_shape_that_it_has_in_cycles(
    scene: bpy.types.Scene, render: Callable[..., Any], kind: str
) -> None:
    """A small light far out of focus has the shape of the aperture: triangular and stretched."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.25)
    images.prepare(scene)
    camera = _camera(scene, kind, {}, {"size": (24, 24)})
    scene.objects["Sphere"].location = camera.matrix_basis @ Vector((0.3, 0.4, -2.0))
    material = bpy.data.materials.new("Light")
    material.use_nodes = True
    material.node_tree.nodes.clear()
    emission, output = (material.node_tree.nodes.new(f"ShaderNode{name}") for name in ("Emission", "OutputMaterial"))
    emission.inputs["Strength"].default_value = 100.0
    material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
    scene.objects["Sphere"].data.materials.append(material)
    dof = camera.data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop, dof.aperture_blades = True, 0.7, 0.05, 3
    dof.aperture_ratio, dof.aperture_rotation = 1.5, 0.3
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising, cycles.max_bounces = 2048, False, False, 0
    cycles.pixel_filter_type = "BOX"
    settings = EXACT | {"samples": 2048, "pixel_filter": "BOX"}
    ours = render(scene, **settings)["Combined"][..., 0]
    dof.aperture_rotation += math.pi / 3
    turned = render(scene, **settings)["Combined"][..., 0]
    dof.aperture_rotation -= math.pi / 3
    scene.render.engine = "CYCLES"
    theirs = render(scene)["Combined"][..., 0]

    def off(picture: np.ndarray) -> float:
        return np.abs(picture - theirs).sum() / theirs.sum()

    assert off(ours) < 0.08
    assert off(turned) > 3 * off(ours)
