"""The table of passes: names of all versions of Blender, channels and switches."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
from gradus import passes
from gradus.abi import ComponentPass, Pass

# From Blender's documentation and source.
NAMES = {
    Pass.COMBINED: ("Combined", "Combined", 4),
    Pass.NOISY_IMAGE: ("Noisy Image", "Noisy Image", 4),
    Pass.DEPTH: ("Depth", "Depth", 1),
    Pass.MIST: ("Mist", "Mist", 1),
    Pass.NORMAL: ("Normal", "Normal", 3),
    Pass.POSITION: ("Position", "Position", 3),
    Pass.UV: ("UV", "UV", 3),
    Pass.VECTOR: ("Vector", "Vector", 4),
    Pass.OBJECT_INDEX: ("IndexOB", "Object Index", 1),
    Pass.MATERIAL_INDEX: ("IndexMA", "Material Index", 1),
    Pass.EMISSION: ("Emit", "Emission", 3),
    Pass.ENVIRONMENT: ("Env", "Environment", 3),
    Pass.DIFFUSE_DIRECT: ("DiffDir", "Diffuse Direct", 3),
    Pass.DIFFUSE_INDIRECT: ("DiffInd", "Diffuse Indirect", 3),
    Pass.DIFFUSE_COLOR: ("DiffCol", "Diffuse Color", 3),
    Pass.GLOSSY_DIRECT: ("GlossDir", "Glossy Direct", 3),
    Pass.GLOSSY_INDIRECT: ("GlossInd", "Glossy Indirect", 3),
    Pass.GLOSSY_COLOR: ("GlossCol", "Glossy Color", 3),
    Pass.TRANSMISSION_DIRECT: ("TransDir", "Transmission Direct", 3),
    Pass.TRANSMISSION_INDIRECT: ("TransInd", "Transmission Indirect", 3),
    Pass.TRANSMISSION_COLOR: ("TransCol", "Transmission Color", 3),
    Pass.AMBIENT_OCCLUSION: ("AO", "Ambient Occlusion", 3),
    Pass.DENOISING_NORMAL: ("Denoising Normal", "Denoising Normal", 3),
    Pass.DENOISING_ALBEDO: ("Denoising Albedo", "Denoising Albedo", 3),
    Pass.DENOISING_DEPTH: ("Denoising Depth", "Denoising Depth", 1),
    Pass.SAMPLE_COUNT: ("Debug Sample Count", "Debug Sample Count", 1),
    Pass.GRADIENT_X: ("Gradient X", "Gradient X", 3),
    Pass.GRADIENT_Y: ("Gradient Y", "Gradient Y", 3),
    Pass.VARIANCE: ("Variance", "Variance", 3),
    Pass.ERROR: ("Error", "Error", 1),
}


def test_names_before_and_since_5_0() -> None:
    for info in passes.TABLE:
        if info.plane in NAMES:
            old, new, channels = NAMES[info.plane]
            assert (info.blender_name((4, 5, 15)), info.blender_name((5, 0, 1)), info.channels) == (old, new, channels)
    assert NAMES.keys() <= {info.plane for info in passes.TABLE}


def test_never_two_channels() -> None:
    assert {info.channels for info in passes.TABLE} <= {1, 3, 4}


def test_each_plane_once() -> None:
    planes = [info.plane for info in passes.TABLE]
    assert len(planes) == len(set(planes))


def layer(**on: bool) -> SimpleNamespace:
    ours = {name.removeprefix("gradus_"): value for name, value in on.items() if name.startswith("gradus_")}
    infos = (*passes.TABLE, *passes.COMPONENT_TABLE)
    defaults = dict.fromkeys(
        (info.switch.removeprefix("gradus.") for info in infos if info.switch.startswith("gradus.")), False
    )
    channels = {f"use_pass_cryptomatte_{kind}": False for kind in ("object", "material", "asset")}
    channels |= {"pass_cryptomatte_depth": 6, "aovs": (), "lightgroups": ()}
    return SimpleNamespace(gradus=SimpleNamespace(**(defaults | ours)), **(channels | on))


def listed(view_layer: SimpleNamespace, reconstructed: bool = False, extra: tuple = ()) -> list[Pass]:
    return [
        info.plane for info in passes.list_passes(view_layer, reconstructed, (), passes.ExtraPasses(frozenset(extra)))
    ]


def test_only_what_is_enabled() -> None:
    assert listed(layer()) == [Pass.COMBINED]
    assert listed(layer(use_pass_z=True, use_pass_vector=False)) == [Pass.COMBINED, Pass.DEPTH]
    assert listed(layer(gradus_use_pass_gradients=True)) == [
        Pass.COMBINED,
        Pass.GRADIENT_X,
        Pass.GRADIENT_Y,
        Pass.GRADIENT_T,
        Pass.GRADIENT_T_CORRESPONDENCE,
    ]
    assert listed(layer(), extra=(Pass.VARIANCE,)) == [Pass.COMBINED, Pass.VARIANCE]


def test_switches_exist_in_this_blender() -> None:
    view_layer = bpy.context.scene.view_layers[0]
    for info in (*passes.TABLE, *passes.COMPONENT_TABLE):
        if info.switch.startswith("gradus."):
            assert hasattr(view_layer.gradus, info.switch.removeprefix("gradus."))
        elif info.switch.startswith("use_"):
            assert hasattr(view_layer, info.switch), info.switch


def test_mask() -> None:
    assert passes.mask([info for info in passes.TABLE if info.plane in (Pass.COMBINED, Pass.DEPTH)]) == 0b101


# -------------------------------------------------------------------------------- components


def named(
    view_layer: SimpleNamespace, components: tuple[str, ...], extra: passes.ExtraPasses = passes.NO_EXTRA
) -> list[str]:
    return [info.name for info in passes.list_passes(view_layer, False, components, extra)]


def test_each_component_has_the_passes_that_are_switched_on() -> None:
    assert named(layer(gradus_use_pass_components=True), ("Diffuse", "A_1")) == ["Combined", "Path Diffuse", "Path A_1"]
    assert named(layer(gradus_use_pass_component_motion=True), ("A",)) == [
        "Combined",
        "Path A Motion",
        "Path A Tracked",
    ]
    assert named(layer(gradus_use_pass_component_index=True), ("A",)) == [
        "Combined",
        "Path A Object Index",
        "Path A Face Index",
    ]
    assert named(layer(gradus_use_pass_components=True), ()) == ["Combined"]
    wanted = passes.ExtraPasses(component_planes=frozenset((ComponentPass.NORMAL,)))
    assert named(layer(), ("A",), wanted) == ["Combined", "Path A Normal"]


def test_names_of_the_longest_component_fit_into_blender_s_64_bytes() -> None:
    assert all(len(part.of("X" * 24).name) < 64 for part in passes.COMPONENT_TABLE)


def test_color_of_a_component_is_not_taken_for_combined() -> None:
    """Both planes have the number 0."""
    color, combined = passes.COMPONENT_TABLE[0].of("Diffuse"), passes.TABLE[0]
    assert color.plane not in frozenset((Pass.COMBINED,))
    assert (passes.mask([color]), passes.component_mask([color])) == (0, 1)
    assert (passes.mask([combined]), passes.component_mask([combined])) == (1, 0)


def test_motion_passes_need_the_times_around_the_frame() -> None:
    parts = [part.of("A") for part in passes.COMPONENT_TABLE]
    assert [info.name for info in (*passes.TABLE, *parts) if info.is_motion] == [
        "Vector", "Path A Motion", "Path A Tracked", "Path A Irradiance Motion", "Path A Irradiance Tracked"
    ]  # fmt: skip
