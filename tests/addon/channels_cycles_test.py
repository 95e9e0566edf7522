"""AOVs, light groups and Cryptomattes have the values of Cycles in the same Blender."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import OpenImageIO as oiio
import pytest
from support import compositing, images, recording
from support.nodes import new_material, output_of, socket

SIDE = 64


def add_aov(layer: bpy.types.ViewLayer, name: str, kind: str) -> None:
    aov = layer.aovs.add()
    aov.name, aov.type = name, kind


def output_to(tree: bpy.types.NodeTree, name: str, **inputs: Any) -> bpy.types.Node:
    """Adds an AOV Output node, whose inputs are linked to sockets or have values."""
    node = tree.nodes.new("ShaderNodeOutputAOV")
    setattr(node, "aov_name" if hasattr(node, "aov_name") else "name", name)
    for key, value in inputs.items():
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, node.inputs[key])
        else:
            node.inputs[key].default_value = value
    return node


def material(name: str, color: tuple[float, float, float], alpha: float = 1.0) -> bpy.types.Material:
    """Returns a diffuse material, mixed with Transparent by 1 - alpha."""
    made = new_material(name)
    tree = made.node_tree
    output = output_of(made)
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*color, 1.0)
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = alpha
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
    tree.links.new(diffuse.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    return made


def add_plane(name: str, size: float, place: tuple[float, float, float], surface: Any) -> bpy.types.Object:
    mesh = recording.grid(1, size, name)
    mesh.materials.append(surface)
    return recording.add(mesh, name, place)


@pytest.fixture
def layer(scene: bpy.types.Scene) -> bpy.types.ViewLayer:
    """The view layer of a scene with a floor, and a half and a mostly transparent plane above it."""
    recording.add_camera(type="ORTHO", ortho_scale=4.0)
    scene.render.resolution_x = scene.render.resolution_y = SIDE
    add_plane("Floor", 3.0, (0, 0, 0), material("Ground", (0.7, 0.6, 0.5)))
    add_plane("Half", 1.0, (-0.7, 0.7, 0.5), material("Half glass", (0.2, 0.5, 0.7), 0.6))
    add_plane("Veil ü", 1.0, (0.7, 0.7, 0.5), material('Thin "veil"', (0.9, 0.9, 0.9), 0.2))
    return scene.view_layers[0]


def render(scene: bpy.types.Scene, folder: Path, engine: str, samples: int, **settings: Any) -> images.Passes:
    scene.render.engine = engine
    if engine == "CYCLES":
        scene.cycles.samples, scene.cycles.use_denoising = samples, False
        scene.cycles.use_adaptive_sampling = False
        settings = {}
    else:
        settings = {"samples": samples, "reconstruction": "NONE", "integrator": "PATH", "denoiser": "NONE"} | settings
    return images.render(scene, folder, **settings)


def both(scene: bpy.types.Scene, folder: Path, samples: int) -> tuple[images.Passes, images.Passes]:
    return render(scene, folder, "CYCLES", samples), render(scene, folder, "GRADUS", samples)


def cells(image: np.ndarray, count: int = 8) -> np.ndarray:
    """Returns the means of count x count cells."""
    side = SIDE // count
    return image.reshape(count, side, count, side, -1).mean(axis=(1, 3))


def test_aovs_are_those_of_cycles(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path) -> None:
    """Colours and values, in groups, in the world, behind transparent surfaces, and with names of all kinds."""
    for name, kind in (("Mask", "COLOR"), ("Höhe_1", "VALUE"), ("a b", "COLOR"), ("a_b", "VALUE")):
        add_aov(layer, name, kind)
    ground = bpy.data.materials["Ground"].node_tree
    coordinates = socket(ground.nodes.new("ShaderNodeTexCoord").outputs, "Generated")
    output_to(ground, "Mask", Color=coordinates)
    output_to(ground, "a_b", Value=3.0)
    output_to(ground, "missing", Value=3.0)
    group = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    output_to(group, "Höhe_1", Value=0.25)
    inside = ground.nodes.new("ShaderNodeGroup")
    inside.node_tree = group
    output_to(bpy.data.materials["Half glass"].node_tree, "Mask", Color=(1.0, 0.0, 4.0, 1.0))
    output_to(bpy.data.materials['Thin "veil"'].node_tree, "Mask", Color=(0.0, 0.5, 0.0, 1.0))
    scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):
        scene.world.use_nodes = True
    output_to(scene.world.node_tree, "a b", Color=(0.1, 0.2, 0.3, 1.0))
    cycles, gradus = both(scene, tmp_path, 64)
    for name in ("Mask", "Höhe_1", "a b", "a_b"):
        expected, found = cells(cycles[name]), cells(gradus[name])
        assert expected.max() > 0.09
        np.testing.assert_allclose(found, expected, atol=0.06 * expected.max(), err_msg=name)
        assert abs(found.mean() - expected.mean()) < 0.01 * expected.mean(), name


def add_light(name: str, color: tuple[float, float, float], x: float, group: str) -> None:
    data = bpy.data.lights.new(name, "POINT")
    data.energy, data.color, data.shadow_soft_size = 60.0, color, 0.3
    light = recording.add(data, name, (x, 0, 1.5))
    light.lightgroup = group


def add_groups(scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> None:
    """Adds two lights, a shining plane and a world in groups, and a light in none."""
    for name in ("Key", "Fill", "Sky", "Unused"):
        bpy.ops.scene.view_layer_add_lightgroup(name=name)
    add_light("Red", (1.0, 0.2, 0.1), 1.0, "Key")
    add_light("Blue", (0.1, 0.2, 1.0), -1.0, "Fill")
    add_light("White", (1.0, 1.0, 1.0), 0.0, "")
    shining = material("Shining", (0.0, 0.0, 0.0))
    tree = shining.node_tree
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (0.1, 1.0, 0.1, 1.0)
    emission.inputs["Strength"].default_value = 5.0
    tree.links.new(emission.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    panel = add_plane("Panel", 0.5, (0.0, -0.8, 0.4), shining)
    panel.lightgroup = "Fill"
    scene.world = bpy.data.worlds.new("World")
    scene.world.lightgroup = "Sky"
    scene.world.color = (0.2, 0.2, 0.2)


def test_light_groups_are_those_of_cycles(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path) -> None:
    add_groups(scene, layer)
    cycles, gradus = both(scene, tmp_path, 256)
    for name in ("Combined_Key", "Combined_Fill", "Combined_Sky"):
        expected, found = cells(cycles[name]), cells(gradus[name])
        np.testing.assert_allclose(found, expected, atol=0.05 * expected.max(), err_msg=name)
        assert abs(found.mean() - expected.mean()) < 0.02 * expected.mean(), name
    assert not gradus["Combined_Unused"].any()


@pytest.mark.parametrize("reconstruction", ["REGULARIZED", "L1"])
def test_light_groups_add_up_to_the_reconstruction(
    scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path, reconstruction: str
) -> None:
    add_groups(scene, layer)
    bpy.data.objects["White"].lightgroup = "Key"
    gradus = render(scene, tmp_path, "GRADUS", 8, reconstruction=reconstruction, integrator="AUTO")
    combined = gradus["ViewLayer.Combined"][..., :3]
    total = sum(gradus[f"Combined_{name}"] for name in ("Key", "Fill", "Sky"))
    np.testing.assert_allclose(total, combined, atol=2e-3 * combined.max())
    assert np.abs(gradus["Noisy Image"][..., :3] - combined).mean() > 0.005 * combined.mean()


def metadata(path: Path) -> dict[str, dict[str, str]]:
    """Returns the metadata of the Cryptomattes in a file: by the name of each, its fields with that of its key."""
    spec = oiio.ImageInput.open(str(path)).spec()
    fields: dict[str, dict[str, str]] = {}
    for attribute in spec.extra_attribs:
        parts = attribute.name.split("/")
        if parts[0] == "cryptomatte":
            fields.setdefault(parts[1], {"key": parts[1]})[parts[2]] = attribute.value
    return {item["name"]: item for item in fields.values()}


def coverage(passes: images.Passes, kind: str, layers: int = 3) -> list[dict[float, float]]:
    """Returns the share of each identifier in each pixel."""
    planes = np.concatenate([passes[f"{kind}{layer:02d}"] for layer in range(layers)], axis=2).reshape(SIDE * SIDE, -1)
    return [dict(zip(pixel[::2].tolist(), pixel[1::2].tolist(), strict=True)) for pixel in planes]


def test_cryptomattes_are_those_of_cycles(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path) -> None:
    kinds = {"object": "CryptoObject", "material": "CryptoMaterial", "asset": "CryptoAsset"}
    for kind in kinds:
        setattr(layer, f"use_pass_cryptomatte_{kind}", True)
    layer.pass_cryptomatte_depth = 6
    root = recording.add(None, "Root")
    bpy.data.objects["Half"].parent = bpy.data.objects["Veil ü"]
    bpy.data.objects["Veil ü"].parent = root
    bare = recording.add(recording.grid(1, 0.6, "Bare"), "Bare", (0.7, -0.7, 0.4))  # has no material
    bare.parent = root
    collection = bpy.data.collections.new("Copied")
    collection.objects.link(add_plane("Copy", 0.5, (50, 0, 0), bpy.data.materials["Ground"]))
    instancer = recording.add(None, "Instancer", (-50.7, -0.7, 0.6))
    instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
    files = {}
    done = {}
    for engine in ("CYCLES", "GRADUS"):
        done[engine] = render(scene, tmp_path, engine, 64)
        files[engine] = tmp_path / f"{engine}.exr"
        images.use_exr(scene, files[engine])
        bpy.ops.render.render(write_still=True, scene=scene.name)
    expected, found = (metadata(files[engine]) for engine in ("CYCLES", "GRADUS"))
    assert set(found) == set(expected) == {f"ViewLayer.{name}" for name in kinds.values()}
    for kind in kinds.values():
        ours, theirs = found[f"ViewLayer.{kind}"], expected[f"ViewLayer.{kind}"]
        assert {key: ours[key] for key in ("key", "hash", "conversion")} == {
            key: theirs[key] for key in ("key", "hash", "conversion")
        }
        names = json.loads(ours["manifest"])
        shown = {np.array([int(digits, 16)], np.uint32).view(np.float32).item(): name for name, digits in names.items()}
        difference = 0.0
        pairs = zip(coverage(done["CYCLES"], kind), coverage(done["GRADUS"], kind), strict=True)
        for cycles, gradus in pairs:
            weights = {key: (cycles.get(key, 0.0), gradus.get(key, 0.0)) for key in cycles.keys() | gradus.keys()}
            assert all(key in shown for key, (_, weight) in weights.items() if weight > 0.0), kind
            difference += sum(abs(a - b) for a, b in weights.values())
        assert difference / SIDE**2 < 0.02, kind
        total = sum(sum(pixel.values()) for pixel in coverage(done["GRADUS"], kind)) / SIDE**2
        assert total > 0.4
    assert json.loads(found["ViewLayer.CryptoAsset"]["manifest"]).keys() >= {"Root", "Floor"}


# Names of every plane of Unicode: control characters, quotes, right to left, combining marks, emoji, private use.
STRANGE_NAMES = (
    "\x01\x07\x1b",
    "tab\tand\nnewline",
    '"quotes" \\ and {braces}: [0, 1]',
    "שלום مرحبا",
    "e\u0301\u0302\u200d\u202e",
    "👩‍👩‍👧‍👦 🇫🇷",
    "𝔊𝔯𝔞𝔡𝔲𝔰 𓀀",
    "\ue000\uffff\U0010ffff",
    "ｗｉｄｅ　漢字",
    "x" * 63,
    "é" * 31,
)


def test_cryptomattes_of_strange_names(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path) -> None:
    layer.use_pass_cryptomatte_object = layer.use_pass_cryptomatte_material = True
    names = set()  # as Blender keeps them
    for index, name in enumerate(STRANGE_NAMES):
        place = (-1.2 + 0.6 * (index % 5), -1.2 + 0.6 * (index // 5), 1.0)
        surface = material(name, (0.5, 0.5, 0.5))
        names |= {add_plane(name, 0.4, place, surface).name, surface.name}
    manifests = {}
    for engine in ("CYCLES", "GRADUS"):
        render(scene, tmp_path, engine, 4)
        images.use_exr(scene, tmp_path / f"{engine}.exr")
        bpy.ops.render.render(write_still=True, scene=scene.name)
        found = metadata(tmp_path / f"{engine}.exr")
        manifests[engine] = {name: fields["manifest"] for name, fields in found.items()}
    for key, text in manifests["GRADUS"].items():
        hashes = json.loads(text)
        assert names <= set(hashes), key
        # Cycles does not escape the names, so that its text need not be JSON.
        assert all(f'"{hashes[name]}"' in manifests["CYCLES"][key] for name in names), key


@pytest.mark.parametrize(
    "name", ["Combined", "Depth", "Noisy Image", "Error", "Path Diffuse", "CryptoObject00", "Mask"]
)
def test_aovs_with_the_name_of_a_pass(
    name: str, scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path
) -> None:
    """Such an AOV has its own values, or none if Blender or Gradus has a pass of this name; the others keep theirs."""
    add_aov(layer, name, "COLOR")
    add_aov(layer, "Other", "COLOR")
    layer.use_pass_z = layer.use_pass_cryptomatte_object = True
    tree = bpy.data.materials["Ground"].node_tree
    output_to(tree, name, Color=(0.25, 0.5, 2.0, 1.0))
    output_to(tree, "Other", Color=(4.0, 3.0, 2.0, 1.0))
    passes = {key.removeprefix("ViewLayer."): value for key, value in render(scene, tmp_path, "GRADUS", 1).items()}
    np.testing.assert_allclose(passes["Other"][10, 32, :3], (4.0, 3.0, 2.0), atol=1e-5)
    assert np.isfinite(passes["Combined"]).all()
    assert passes["Combined"].max() < 1.5
    if name == "Mask":
        np.testing.assert_allclose(passes["Mask"][10, 32, :3], (0.25, 0.5, 2.0), atol=1e-5)


def test_ranks_fall_and_levels_are_kept(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path) -> None:
    layer.use_pass_cryptomatte_object = True
    layer.pass_cryptomatte_depth = 3  # two layers, as in Cycles
    gradus = render(scene, tmp_path, "GRADUS", 16)
    assert {name for name in gradus if name.startswith("Crypto")} == {"CryptoObject00", "CryptoObject01"}
    weights = np.concatenate([gradus["CryptoObject00"][..., 1::2], gradus["CryptoObject01"][..., 1::2]], axis=2)
    assert (np.diff(weights, axis=2) <= 0.0).all()
    assert weights[..., 1].max() > 0.2
    assert weights.sum(axis=2).mean() < 1.01


def test_data_passes_show_the_first_surface_that_is_opaque_enough(
    scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path
) -> None:
    """Regression: they showed whatever surface the path scattered at."""
    layer.use_pass_z = layer.use_pass_object_index = layer.use_pass_normal = layer.use_pass_position = True
    bpy.data.objects.remove(bpy.data.objects["Veil ü"])  # it shows where the path happens to stop at it
    for number, obj in enumerate(scene.objects):
        obj.pass_index = number + 1
        obj.rotation_euler = (0.1 * number, 0.0, 0.0)
    scene.cycles.pixel_filter_type = scene.gradus.pixel_filter = "GAUSSIAN"
    scene.cycles.filter_width = scene.gradus.filter_width = 0.01  # the same positions at edges
    expected, found = both(scene, tmp_path, 16)
    names = [name for name in expected if "." in name and not name.endswith("Combined")]
    assert len(names) == 4
    for name in names:
        seen = np.abs(expected[name]).max(axis=2) < 1e4
        difference = np.abs(expected[name] - found[name]).max(axis=2)[seen]
        assert np.quantile(difference, 0.99) < 0.01, name


def test_passes_of_volumes_are_0(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path) -> None:
    """Regression: the passes were missing, and sockets of the compositor without a pass are 1."""
    if not hasattr(layer, "cycles"):
        pytest.skip("Cycles' add-on is off")
    layer.cycles.use_pass_volume_direct = layer.cycles.use_pass_volume_indirect = True
    gradus = render(scene, tmp_path, "GRADUS", 1)
    long = bpy.app.version >= (5, 0, 0)
    for name in ("Volume Direct", "Volume Indirect") if long else ("VolumeDir", "VolumeInd"):
        assert gradus[name].shape == (SIDE, SIDE, 3) and not gradus[name].any()


def test_cycles_asks_for_its_denoising_data(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path) -> None:
    if not hasattr(layer, "cycles"):
        pytest.skip("Cycles' add-on is off")
    layer.cycles.denoising_store_passes = True
    gradus = render(scene, tmp_path, "GRADUS", 1)
    assert {"Denoising Normal", "Denoising Albedo"} <= gradus.keys()
    assert gradus["Denoising Albedo"].max() > 0.5


def test_channels_of_animations(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path) -> None:
    """Light groups of every frame add up to it, and names are those of the frame although others are sampled ahead."""
    add_groups(scene, layer)
    bpy.data.objects["White"].lightgroup = "Key"
    layer.use_pass_cryptomatte_object = True
    for frame, x in ((1, 0.0), (3, 0.3)):
        scene.camera.location.x = x
        scene.camera.keyframe_insert("location", index=0, frame=frame)
    veil = bpy.data.objects["Veil ü"]
    for frame, hidden in ((1, False), (2, True)):
        veil.hide_render = hidden
        veil.keyframe_insert("hide_render", frame=frame)
    scene.frame_start, scene.frame_end = 1, 3
    scene.gradus.samples, scene.gradus.use_temporal = 8, True
    images.use_exr(scene, tmp_path / "frame_####.exr")
    bpy.ops.render.render(animation=True, scene=scene.name)
    for frame in range(1, 4):
        path = tmp_path / f"frame_{frame:04d}.exr"
        passes = images.read(path)
        combined = passes["ViewLayer.Combined"][..., :3]
        total = sum(passes[f"Combined_{name}"] for name in ("Key", "Fill", "Sky"))
        np.testing.assert_allclose(total, combined, atol=2e-3 * combined.max())
        names = json.loads(metadata(path)["ViewLayer.CryptoObject"]["manifest"])
        assert names.keys() >= {"Floor", "Half"} | ({"Veil ü"} if frame == 1 else set())


def test_a_pass_that_the_compositor_reads_and_gradus_does_not_make_is_an_error(
    scene: bpy.types.Scene, layer: bpy.types.ViewLayer, tmp_path: Path
) -> None:
    """A socket without its pass is 1: the picture would be wrong without a word."""
    if not hasattr(getattr(layer, "cycles", None), "pass_render_time"):
        pytest.skip("Cycles' add-on is off, or before 5.0")
    layer.cycles.pass_render_time = True
    scene.render.engine = "CYCLES"
    layer.update_render_passes()
    tree, render_layers, output = compositing.new_tree(scene)
    tree.links.new(render_layers.outputs["Render Time"], output)
    render(scene, tmp_path, "GRADUS", 1)  # without the compositor
    scene.render.use_compositing = True
    with pytest.raises(RuntimeError, match=r"reads pass 'Render Time' of view layer 'ViewLayer'"):
        render(scene, tmp_path, "GRADUS", 1)


def test_manifests_are_read_again_only_if_names_change(monkeypatch: pytest.MonkeyPatch) -> None:
    from gradus import cryptomatte
    from gradus.abi import ChannelKind

    read: list[bytes] = []
    loads = cryptomatte.json.loads
    monkeypatch.setattr(cryptomatte.json, "loads", lambda text: read.append(text) or loads(text))
    kind = ChannelKind.CRYPTOMATTE_OBJECT
    manifests = cryptomatte.Manifests()
    assert manifests.text(kind) == "{}"
    one, two = b'{"A":"01"}', b'{"B":"02"}'
    for _frame in range(3):
        manifests.add(kind, one, replaces=False)
    assert manifests.text(kind) == '{"A":"01"}' and read == [one]
    manifests.add(kind, two, replaces=False)  # the frames of an animation share their names
    manifests.add(kind, two, replaces=False)
    assert manifests.text(kind) == '{"A":"01","B":"02"}' and read == [one, two]
    manifests.add(kind, two, replaces=True)  # a still has only its own
    manifests.add(kind, two, replaces=True)
    assert manifests.text(kind) == '{"B":"02"}' and len(read) == 3
