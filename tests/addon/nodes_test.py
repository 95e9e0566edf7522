"""Translation of shader graphs to node programs, and replacements of unsupported nodes."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import bpy
import pytest
from support.nodes import Resources, new_material, op_names, output_of, show, socket, translate

pytestmark = pytest.mark.usefixtures("scene")

ROOT = Path(__file__).resolve().parent.parent.parent

# The nodes that the guide lists. Those that do not exist in a version of Blender are skipped there.
FAMILIES = tomllib.loads((ROOT / "schema" / "nodes.toml").read_text(encoding="utf-8"))["family"]
PROMISED = [kind for family in FAMILIES for _, kind in family["nodes"]]


def type_of(kind: str) -> str:
    """Returns the type of a node, of which the list leaves out "ShaderNode"."""
    return kind if "Node" in kind else f"ShaderNode{kind}"


# Outputs without translation of nodes that are translated.
NOT_YET = {("ShaderNodeNewGeometry", "Pointiness"), ("ShaderNodeNewGeometry", "Random Per Island")}


def add(material: bpy.types.Material, kind: str) -> bpy.types.Node:
    try:
        return material.node_tree.nodes.new(type_of(kind))
    except RuntimeError:
        pytest.skip(f"Blender {bpy.app.version_string} has no {type_of(kind)}")


def complete(node: bpy.types.Node) -> None:
    """Gives a node the data without which it has no effect of its own."""
    if node.bl_idname == "ShaderNodeTexIES":
        node.ies = bpy.data.texts.new("profile")
        node.ies.write("TILT=NONE\n1 1000 1 2 1 1 2 0 0 0\n1 1 50\n0 90\n0\n9 0\n")


def native_check(library: object, program: object) -> None:
    """Checks that the library accepts a program."""
    from gradus import native

    lib = native.load()
    device, scene = native.abi.ctypes.c_uint64(), native.abi.ctypes.c_uint64()
    settings = native.DeviceSettings()
    settings.threads = 1
    lib.device_create(native.byref(settings), native.byref(device))
    lib.scene_create(device, native.byref(scene))
    struct, keep = program.to_native(native)
    lib.scene_set_material(scene, 1, native.byref(struct))
    lib.scene_commit(scene, None, None)
    del keep
    lib.scene_release(scene)
    lib.device_release(device)


@pytest.mark.parametrize("kind", PROMISED)
def test_e5_promised_nodes_do_not_fall_back(kind: str) -> None:
    for index in range(len(add(new_material(), kind).outputs)):
        material = new_material()
        node = add(material, kind)
        complete(node)
        output = node.outputs[index]
        if (node.bl_idname, output.identifier) in NOT_YET:
            continue
        show(material, output)
        program = translate(material)
        assert not program.uses_fallback, program.warnings
        assert not program.warnings or kind == "LightPath"  # of which emission is named
        assert program.surface >= 0 or kind in {"MixShader", "AddShader"}


def test_every_translated_node_is_in_the_list_of_the_guide() -> None:
    from gradus.nodes import node

    assert set(node._translators) == {type_of(kind) for kind in PROMISED}


def test_programs_of_promised_nodes_compile(library: object) -> None:
    """The library accepts the program of each node."""
    for kind in PROMISED:
        if not hasattr(bpy.types, type_of(kind)):
            continue
        material = new_material(kind)
        try:
            node = material.node_tree.nodes.new(type_of(kind))
        except RuntimeError:
            continue
        complete(node)
        show(material, node.outputs[0])
        native_check(library, translate(material))


def test_e5_unknown_node_falls_back_with_one_warning() -> None:
    material = new_material("Painted wall")
    node = material.node_tree.nodes.new("ShaderNodeBsdfHair")
    node.name = "My hair"
    node.inputs["Color"].default_value = (1.0, 0.5, 0.25, 1.0)
    show(material, node.outputs[0])
    program = translate(material)
    assert program.uses_fallback
    assert len(program.warnings) == 1
    assert "Painted wall" in program.warnings[0]
    assert "My hair" in program.warnings[0]
    assert op_names(program) == ["DIFFUSE"]
    assert program.inputs[0][2][:3] == pytest.approx((1.0, 0.5, 0.25))


@pytest.mark.parametrize("output", ["Color", "Density"])
def test_e5_unknown_texture_is_grey(output: str) -> None:
    material = new_material()
    node = add(material, "TexPointDensity")
    show(material, node.outputs[output])
    program = translate(material)
    assert program.uses_fallback
    assert program.inputs[0][2][:3] == (0.5, 0.5, 0.5)
    assert len(program.warnings) == 1 and "is replaced by grey" in program.warnings[0]


@pytest.mark.skipif(bpy.app.version < (5, 2, 0), reason="thin walls came with 5.2")
def test_e5_subsurface_in_thin_walls_is_named_in_a_warning() -> None:
    material = new_material()
    node = material.node_tree.nodes.new("ShaderNodeBsdfPrincipled")
    node.inputs["Subsurface Weight"].default_value = 0.5
    show(material, node.outputs[0])
    assert not translate(material).warnings
    node.inputs["Thin Wall"].default_value = True
    program = translate(material)
    assert len(program.warnings) == 1 and "thin wall" in program.warnings[0]


def light_path(tree: Any, output: str) -> bpy.types.NodeSocket:
    return tree.nodes.new("ShaderNodeLightPath").outputs[output]


DIFFERENT = (
    "Is Diffuse Ray",
    "Is Glossy Ray",
    "Is Reflection Ray",
    "Ray Length",
    "Diffuse Depth",
    "Glossy Depth",
    "Transparent Depth",
)
SAME = ("Is Camera Ray", "Is Shadow Ray", "Is Singular Ray", "Ray Depth")


@pytest.mark.parametrize("output", DIFFERENT + SAME)
def test_e5_light_paths_of_sampled_emission_are_named(output: str) -> None:
    material = new_material("Glow")
    show(material, light_path(material.node_tree, output))
    program = translate(material)
    assert not program.uses_fallback
    assert program.warnings == (
        [f"Glow: its emission depends on {output}, which Cycles evaluates differently"] if output in DIFFERENT else []
    )
    if hasattr(material.cycles, "emission_sampling"):
        material.cycles.emission_sampling = "NONE"
    else:
        material.cycles.sample_as_light = False
    assert not translate(material).warnings


def mixed(tree: Any, first: str, second: str) -> bpy.types.Node:
    """Returns a mix of two shaders whose factor is a Light Path."""
    node = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(light_path(tree, "Is Glossy Ray"), node.inputs[0])
    for kind, target in ((first, node.inputs[1]), (second, node.inputs[2])):
        tree.links.new(tree.nodes.new(f"ShaderNode{kind}").outputs[0], target)
    return node


def test_e5_light_paths_are_named_only_where_they_change_emission() -> None:
    material = new_material()
    tree = material.node_tree
    show(material, mixed(tree, "BsdfDiffuse", "Emission").outputs[0])
    assert len(translate(material).warnings) == 1
    show(material, mixed(tree, "BsdfDiffuse", "BsdfGlossy").outputs[0])
    assert not translate(material).warnings
    added = tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(mixed(tree, "BsdfDiffuse", "BsdfGlossy").outputs[0], added.inputs[0])
    tree.links.new(tree.nodes.new("ShaderNodeEmission").outputs[0], added.inputs[1])
    show(material, added.outputs[0])
    assert not translate(material).warnings
    principled = tree.nodes.new("ShaderNodeBsdfPrincipled")
    principled.inputs["Emission Strength"].default_value = 1.0
    socket(principled.inputs, "Base Color").default_value = (0.5, 0.5, 0.5, 1.0)
    tree.links.new(light_path(tree, "Is Diffuse Ray"), principled.inputs["Base Color"])
    show(material, principled.outputs[0])
    assert not translate(material).warnings
    name = "Emission Color" if "Emission Color" in principled.inputs else "Emission"
    tree.links.new(light_path(tree, "Is Diffuse Ray"), principled.inputs[name])
    assert len(translate(material).warnings) == 1


@pytest.mark.parametrize("output, named", [("Ray Depth", True), ("Is Diffuse Ray", False)])
def test_e5_light_paths_of_lights_are_named_by_their_depths(output: str, named: bool) -> None:
    light = bpy.data.lights.new("Light", "AREA")
    light.use_nodes = True
    tree = light.node_tree
    emission = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeEmission")
    tree.links.new(light_path(tree, output), emission.inputs["Strength"])
    assert len(translate(light, "LIGHT").warnings) == named


def test_e5_unknown_value_node_passes_through(monkeypatch: pytest.MonkeyPatch) -> None:
    from gradus.nodes import node as registry

    monkeypatch.delitem(registry._translators, "ShaderNodeDisplacement")  # stands for a node of a later Blender
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    node = nodes.new("ShaderNodeDisplacement")
    color = nodes.new("ShaderNodeRGB")
    color.outputs[0].default_value = (0.1, 0.2, 0.3, 1.0)
    links.new(color.outputs[0], node.inputs["Normal"])
    show(material, node.outputs["Displacement"])
    program = translate(material)
    assert len(program.warnings) == 1
    assert program.inputs[0][2][:3] == pytest.approx((0.1, 0.2, 0.3))


def test_a_light_without_a_readable_profile_is_as_in_cycles() -> None:
    material = new_material()
    node = add(material, "TexIES")
    node.inputs["Strength"].default_value = 0.5
    show(material, node.outputs[0])
    program = translate(material)
    assert op_names(program)[0] == "MATH" and len(program.warnings) == 1
    assert "100 everywhere, as in Cycles" in program.warnings[0]


def test_shader_to_rgb_is_not_linked() -> None:
    """Regression: what followed it was black. In Cycles the next node has its own default."""
    material = new_material()
    ramp = add(material, "ValToRGB")
    ramp.inputs["Fac"].default_value = 0.25
    closure, node = add(material, "BsdfDiffuse"), add(material, "ShaderToRGB")
    links = material.node_tree.links
    links.new(closure.outputs[0], node.inputs[0])
    links.new(node.outputs[0], ramp.inputs["Fac"])
    show(material, ramp.outputs["Color"])
    program = translate(material)
    assert op_names(program) == ["RAMP", "EMISSION"]
    assert program.inputs[0][2][0] == 0.25
    assert len(program.warnings) == 1 and "Shader to RGB" in program.warnings[0]


def test_e5_no_surface_is_no_program() -> None:
    assert translate(new_material()).surface == -1


def test_e5_loop_through_links_ends() -> None:
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    first, second = nodes.new("ShaderNodeGamma"), nodes.new("ShaderNodeGamma")
    links.new(first.outputs[0], second.inputs["Color"])
    links.new(second.outputs[0], first.inputs["Color"])
    show(material, second.outputs[0])
    assert (translate(material).surface >= 0) == (bpy.app.version < (5, 0, 0))  # there Blender drops the loop


def test_e5_loop_through_muted_nodes_ends() -> None:
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    first, second, third = (nodes.new("ShaderNodeGamma") for _ in range(3))
    links.new(first.outputs[0], second.inputs["Color"])
    links.new(second.outputs[0], third.inputs["Color"])
    links.new(third.outputs[0], first.inputs["Color"])
    first.mute = second.mute = True
    show(material, third.outputs[0])
    assert (translate(material).surface >= 0) == (bpy.app.version < (5, 0, 0))


def nested_group(depth: int) -> bpy.types.NodeTree:
    """Returns nested groups, of which the innermost doubles a colour."""
    tree = bpy.data.node_groups.new(f"Group {depth}", "ShaderNodeTree")
    if hasattr(tree, "interface"):
        tree.interface.new_socket("In", in_out="INPUT", socket_type="NodeSocketColor")
        tree.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketColor")
    else:
        tree.inputs.new("NodeSocketColor", "In")
        tree.outputs.new("NodeSocketColor", "Out")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    if depth == 0:
        inner = tree.nodes.new("ShaderNodeBrightContrast")
        inner.inputs["Bright"].default_value = 0.25
        inner_in, inner_out = inner.inputs["Color"], inner.outputs[0]
    else:
        inner = tree.nodes.new("ShaderNodeGroup")
        inner.node_tree = nested_group(depth - 1)
        inner_in, inner_out = inner.inputs[0], inner.outputs[0]
    reroute = tree.nodes.new("NodeReroute")
    tree.links.new(start.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], inner_in)
    tree.links.new(inner_out, end.inputs[0])
    return tree


def test_e5_groups_eight_deep() -> None:
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    group = nested_group(7)
    for color in ((0.1, 0.2, 0.3, 1.0), (0.5, 0.5, 0.5, 1.0)):
        node = nodes.new("ShaderNodeGroup")
        node.node_tree = group
        node.inputs[0].default_value = color
    add_node = nodes.new("ShaderNodeMixRGB")
    first, second = (node for node in nodes if node.bl_idname == "ShaderNodeGroup")
    links.new(first.outputs[0], add_node.inputs["Color1"])
    links.new(second.outputs[0], add_node.inputs["Color2"])
    show(material, add_node.outputs[0])
    program = translate(material)
    assert not program.uses_fallback
    assert op_names(program) == ["BRIGHT_CONTRAST", "BRIGHT_CONTRAST", "MIX_COLOR", "EMISSION"]
    assert [program.inputs[i][2][:3] for i in (0, 3)] == [pytest.approx((0.1, 0.2, 0.3)), (0.5, 0.5, 0.5)]


def test_group_without_output_or_tree_is_not_linked() -> None:
    material = new_material()
    node = material.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = bpy.data.node_groups.new("Empty", "ShaderNodeTree")
    assert translate(material).surface == -1


def test_muted_node_passes_its_input_through() -> None:
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    color, gamma = nodes.new("ShaderNodeRGB"), nodes.new("ShaderNodeGamma")
    color.outputs[0].default_value = (0.3, 0.6, 0.9, 1.0)
    links.new(color.outputs[0], gamma.inputs["Color"])
    gamma.mute = True
    show(material, gamma.outputs[0])
    program = translate(material)
    assert op_names(program) == ["EMISSION"]
    assert program.inputs[0][2][:3] == pytest.approx((0.3, 0.6, 0.9))


def test_a_muted_node_without_a_link_passes_nothing_on() -> None:
    """As in Cycles, it is 0 before 5.0, and no link from then on. Regression: it passed the value of its socket on."""
    material = new_material()
    gamma = add(material, "Gamma")
    gamma.inputs["Color"].default_value = (0.4, 0.5, 0.6, 1.0)
    gamma.mute = True
    show(material, gamma.outputs[0])
    expected = (1.0, 1.0, 1.0) if bpy.app.version >= (5, 0, 0) else (0.0, 0.0, 0.0)
    assert translate(material).inputs[0][2][:3] == expected  # the default of the emission


def test_muted_links_are_ignored() -> None:
    material = new_material()
    node = material.node_tree.nodes.new("ShaderNodeEmission")
    show(material, node.outputs[0])
    material.node_tree.links[0].is_muted = True
    assert translate(material).surface == -1


def test_output_for_cycles_is_preferred() -> None:
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    output_of(material).target = "EEVEE"
    other = nodes.new("ShaderNodeOutputMaterial")
    other.target = "CYCLES"
    emission, diffuse = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeBsdfDiffuse")
    links.new(diffuse.outputs[0], output_of(material).inputs["Surface"])
    links.new(emission.outputs[0], other.inputs["Surface"])
    assert op_names(translate(material)) == ["EMISSION"]


def test_color_to_float_is_luminance_and_vector_to_float_the_mean() -> None:
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    color, vector, math = nodes.new("ShaderNodeRGB"), nodes.new("ShaderNodeCombineXYZ"), nodes.new("ShaderNodeMath")
    vector.inputs["X"].default_value = 3.0
    links.new(color.outputs[0], math.inputs[0])
    color.outputs[0].default_value = (0.0, 1.0, 0.0, 1.0)
    links.new(vector.outputs[0], math.inputs[1])
    show(material, math.outputs[0])
    program = translate(material)
    assert op_names(program) == ["COMBINE", "AVERAGE", "MATH", "EMISSION"]
    assert program.inputs[4][2][0] == pytest.approx(0.7152)


def test_value_as_surface_is_emission() -> None:
    material = new_material()
    color = material.node_tree.nodes.new("ShaderNodeRGB")
    material.node_tree.links.new(color.outputs[0], output_of(material).inputs["Surface"])
    assert op_names(translate(material)) == ["EMISSION"]


def test_equal_nodes_are_stored_once() -> None:
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    image = bpy.data.images.new("pixels", 4, 4)
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    mix = nodes.new("ShaderNodeMixShader")
    links.new(texture.outputs["Alpha"], mix.inputs[0])
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    links.new(texture.outputs["Color"], diffuse.inputs["Color"])
    links.new(diffuse.outputs[0], mix.inputs[2])
    show(material, mix.outputs[0])
    resources = Resources()
    program = translate(material, resources=resources)
    assert resources.images == [image]
    assert op_names(program).count("IMAGE") == 1


def test_principled_of_this_version() -> None:
    material = new_material()
    node = material.node_tree.nodes.new("ShaderNodeBsdfPrincipled")
    show(material, node.outputs[0])
    expected = "PRINCIPLED_3" if bpy.app.version < (4, 0, 0) else "PRINCIPLED"
    assert op_names(translate(material)) == [expected]
    node.inputs["Alpha"].default_value = 0.5
    assert op_names(translate(material)) == [expected, "TRANSPARENT", "MIX_SHADER"]


def test_attribute_names_are_requested() -> None:
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    color, uv = nodes.new("ShaderNodeVertexColor"), nodes.new("ShaderNodeUVMap")
    color.layer_name, uv.uv_map = "Tint", "Second"
    mix = nodes.new("ShaderNodeMixRGB")
    links.new(color.outputs["Color"], mix.inputs["Color1"])
    links.new(uv.outputs[0], mix.inputs["Color2"])
    show(material, mix.outputs[0])
    assert translate(material).attribute_names == {"Tint", "Second"}


def test_deep_chains_translate() -> None:
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    last = nodes.new("ShaderNodeRGB").outputs[0]
    for _ in range(600):
        node = nodes.new("ShaderNodeGamma")
        links.new(last, node.inputs["Color"])
        last = node.outputs[0]
    show(material, last)
    program = translate(material)
    assert len(program.nodes) == 601
    assert not program.warnings


def test_world_and_light() -> None:
    world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.bl_idname == "ShaderNodeBackground")
    background.inputs["Strength"].default_value = 2.0
    program = translate(world, "WORLD")
    assert op_names(program) == ["EMISSION"]
    assert program.inputs[1][2][0] == 2.0
    light = bpy.data.lights.new("Light", "POINT")
    assert op_names(translate(light, "LIGHT")) == ["EMISSION"]


def test_without_nodes_the_viewport_color_is_used() -> None:
    if bpy.app.version >= (5, 0, 0):
        pytest.skip("materials always have nodes from 5.0 on")
    material = bpy.data.materials.new("Plain")
    material.diffuse_color = (0.2, 0.4, 0.6, 1.0)
    program = translate(material)
    assert op_names(program) == ["DIFFUSE"]
    assert program.inputs[0][2][:3] == pytest.approx((0.2, 0.4, 0.6))


def test_displacement_is_translated_with_its_method() -> None:
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    target = output_of(material).inputs["Displacement"]
    links.new(nodes.new("ShaderNodeDisplacement").outputs[0], target)
    program = translate(material)
    assert not program.warnings and not program.uses_fallback
    assert op_names(program)[program.displacement.node] == "DISPLACEMENT"
    before = program.content()
    owner = material if hasattr(material, "displacement_method") else material.cycles
    owner.displacement_method = "DISPLACEMENT" if owner.displacement_method != "DISPLACEMENT" else "BUMP"
    assert translate(material).content() != before
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Normal"], target)
    program = translate(material)
    assert op_names(program)[program.displacement.node] == "GEOMETRY"


def test_a_constant_displacement_is_a_node() -> None:
    material = new_material()
    nodes, links = material.node_tree.nodes, material.node_tree.links
    color = nodes.new("ShaderNodeRGB")
    links.new(color.outputs[0], output_of(material).inputs["Displacement"])
    program = translate(material)
    assert op_names(program)[program.displacement.node] == "VECTOR_MATH"
    color.outputs[0].default_value = (0.0, 0.0, 0.0, 1.0)
    assert translate(material).displacement is None


def test_a_surface_around_a_volume_is_clear_and_not_black() -> None:
    material = new_material("Fog")
    tree = material.node_tree
    volume = tree.nodes.new("ShaderNodeVolumePrincipled")
    tree.links.new(volume.outputs[0], output_of(material).inputs["Volume"])
    program = translate(material)
    assert op_names(program) == ["TRANSPARENT"]
    assert program.inputs[0][2][:3] == (1.0, 1.0, 1.0)
    assert program.uses_fallback
    assert program.warnings == ["Fog: volume is not supported and is left out"]


def test_a_volume_inside_a_surface_leaves_the_surface() -> None:
    material = new_material("Murky glass")
    tree = material.node_tree
    volume, glass = tree.nodes.new("ShaderNodeVolumeAbsorption"), tree.nodes.new("ShaderNodeBsdfGlass")
    tree.links.new(volume.outputs[0], output_of(material).inputs["Volume"])
    show(material, glass.outputs[0])
    program = translate(material)
    assert op_names(program) == ["GLASS"]
    assert program.warnings == ["Murky glass: volume is not supported and is left out"]


def test_the_volume_of_a_world_is_named() -> None:
    world = bpy.data.worlds.new("Haze")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    tree = world.node_tree
    volume = tree.nodes.new("ShaderNodeVolumeScatter")
    end = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputWorld")
    tree.links.new(volume.outputs[0], end.inputs["Volume"])
    program = translate(world, "WORLD")
    assert program.warnings == ["Haze: volume is not supported and is left out"]
    assert op_names(program) == ["EMISSION"]


def test_programs_have_as_many_inputs_as_operations_take() -> None:
    from gradus.nodes import ops

    for kind in PROMISED:
        material = new_material(kind)
        try:
            node = material.node_tree.nodes.new(type_of(kind))
        except RuntimeError:
            continue
        show(material, node.outputs[0])
        for record in translate(material).nodes:
            assert record[3] <= ops.INPUTS[ops.Op(record[0])], (kind, ops.Op(record[0]).name)


def test_socket_helper_finds_identifiers() -> None:
    material = new_material()
    node = material.node_tree.nodes.new("ShaderNodeMath")
    assert socket(node.inputs, "Value_001") == node.inputs[1]
