"""Traces rays through the C API: the Depth pass of a 9×9 image of one triangle at a distance of 2."""

from __future__ import annotations

from array import array
from ctypes import byref, c_uint64, sizeof
from typing import Any

from gradus import native

IDENTITY = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
SIZE = 9


def struct(kind: type, **fields: Any) -> Any:
    value = kind()
    value.struct_size = sizeof(kind)
    for name, field in fields.items():
        current = getattr(value, name)
        if isinstance(field, tuple):
            current[:] = field
        else:
            setattr(value, name, field)
    return value


def triangle_scene(library: native.Library, device: int) -> int:
    scene = c_uint64()
    library.scene_create(device, byref(scene))
    positions = array("f", (-1, -1, -2, 1, -1, -2, 0, 1, -2))
    vertices, corners = array("i", (0, 1, 2)), array("I", (0, 1, 2))
    mesh = struct(
        native.Mesh, key_count=1, vertex_count=3, positions=native.pointer(positions), corner_count=3,
        corner_vertices=native.pointer(vertices), triangle_count=1, triangle_corners=native.pointer(corners),
        face_count=1, normal_domain=native.Domain.FACE, generated_size=(1.0, 1.0, 1.0),
    )  # fmt: skip
    library.scene_set_mesh(scene.value, 1, byref(mesh))
    meshes, matrices = array("Q", (1,)), array("f", IDENTITY)
    instances = struct(native.Instances, count=1, meshes=native.pointer(meshes), matrices=native.pointer(matrices))
    library.scene_set_instances(scene.value, byref(instances))
    window = (-1.0, 1.0, -1.0, 1.0)
    camera = struct(
        native.Camera, type=native.CameraType.PERSPECTIVE, matrix=IDENTITY, matrix_previous=IDENTITY,
        matrix_next=IDENTITY, window=window, window_previous=window, window_next=window,
        clip_start=0.1, clip_end=100.0, aperture_ratio=1.0,
    )  # fmt: skip
    library.scene_set_camera(scene.value, byref(camera))
    library.scene_commit(scene.value, None, None)
    return scene.value


def depths(library: native.Library) -> array:
    """Returns the Depth pass, row 0 at the bottom."""
    device = c_uint64()
    library.device_create(byref(struct(native.DeviceSettings, threads=1)), byref(device))
    scene = triangle_scene(library, device.value)
    settings = struct(native.Settings)
    library.settings_default(byref(settings))
    settings.width = settings.height = SIZE
    settings.samples = 1
    settings.noise_threshold = 0.0
    settings.integrator = native.Integrator.PATH
    settings.reconstruction = native.Reconstruction.NONE
    settings.passes = 1 << native.Pass.DEPTH
    render = c_uint64()
    library.render_start(scene, byref(settings), byref(render))
    library.render_wait(render.value, 30.0)
    pixels = array("f", bytes(4 * SIZE * SIZE))
    library.render_read_pass(render.value, native.Pass.DEPTH, native.pointer(pixels), len(pixels))
    library.render_release(render.value)
    library.scene_release(scene)
    library.device_release(device.value)
    return pixels


def check() -> None:
    """Requires that the centre shows the triangle at distance 2 and the upper left corner nothing."""
    pixels = depths(native.load())
    centre, corner = pixels[SIZE * (SIZE // 2) + SIZE // 2], pixels[SIZE * (SIZE - 1)]
    assert abs(centre - 2.0) < 1e-3, f"depth {centre} where 2 was expected"
    assert corner > 1e3, f"depth {corner} where nothing is"
