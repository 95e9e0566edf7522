"""Shaders that Cycles renders by formulas with faults are named, and only where pictures differ."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import pytest
from support.nodes import Graph, new_material, show, translate

pytestmark = pytest.mark.usefixtures("scene")

VERSION = tuple(bpy.app.version)
GLOSSY = "BsdfGlossy" if VERSION >= (4, 0, 0) else "BsdfAnisotropic"


def warnings(kind: str, inputs: dict[str, Any], **properties: Any) -> str:
    """Returns the warnings about a material of one shader, as one text."""
    material = new_material("Shown")
    graph = Graph(material)
    values = {name: value(graph) if callable(value) else value for name, value in inputs.items()}
    show(material, graph(kind, "BSDF", values, **properties))
    return "; ".join(translate(material).warnings)


def noise(graph: Graph) -> bpy.types.NodeSocket:
    return graph("TexNoise", "Fac")


def glossy(distribution: str, roughness: Any, anisotropy: float) -> str:
    return warnings(GLOSSY, {"Roughness": roughness, "Anisotropy": anisotropy}, distribution=distribution)


@pytest.mark.parametrize("anisotropy", [0.0, 0.4])
def test_anisotropic_beckmann_is_named_before_3_5(anisotropy: float) -> None:
    is_named = "Beckmann" in glossy("BECKMANN", 0.5, anisotropy)
    assert is_named == (VERSION < (3, 5, 0) and anisotropy != 0.0)
    assert glossy("GGX", 0.5, anisotropy) == ""


@pytest.mark.skipif(VERSION >= (4, 0, 0), reason="from 4.0 on Cycles, too, scales the light of single bounces")
def test_rough_and_anisotropic_walks_are_named_before_4() -> None:
    assert glossy("MULTI_GGX", 0.3, 0.0) == ""
    for roughness, anisotropy in ((0.3, 0.4), (0.5, 0.0), (noise, 0.0)):
        assert "several bounces" in glossy("MULTI_GGX", roughness, anisotropy)


def test_rough_ashikhmin_shirley_is_named() -> None:
    assert glossy("ASHIKHMIN_SHIRLEY", 0.5, 0.0) == ""
    for roughness, anisotropy in ((0.7, 0.0), (0.5, 0.5), (0.5, -0.5), (noise, 0.0)):
        assert "flat angle" in glossy("ASHIKHMIN_SHIRLEY", roughness, anisotropy)


@pytest.mark.parametrize("kind", ["BsdfGlass", "BsdfRefraction", "BsdfPrincipled"])
def test_rough_refraction_is_named(kind: str) -> None:
    transmission = "Transmission Weight" if VERSION >= (4, 0, 0) else "Transmission"
    given = {transmission: 1.0} if kind == "BsdfPrincipled" else {}
    named = ["refracts roughly" in warnings(kind, given | {"Roughness": value}) for value in (0.3, 0.6, noise)]
    assert named == [False, True, True]
    assert warnings("BsdfPrincipled", {"Roughness": 0.6}) == ""


def bumped(graph: Graph) -> bpy.types.NodeSocket:
    return graph("Bump", "Normal", {"Height": noise(graph)})


@pytest.mark.parametrize("kind", ["BsdfGlass", "BsdfRefraction", "BsdfPrincipled"])
def test_normals_of_refraction_are_named_before_4(kind: str) -> None:
    def slanted(graph: Graph) -> bpy.types.NodeSocket:
        return graph("VectorMath", "Vector", {"Vector": graph("NewGeometry", "Normal")}, operation="ABSOLUTE")

    def mapped(space: str) -> Callable[[Graph], bpy.types.NodeSocket]:
        return lambda graph: graph("NormalMap", "Normal", {"Color": noise(graph)}, space=space)

    transmission = "Transmission Weight" if VERSION >= (4, 0, 0) else "Transmission"
    given = {transmission: 1.0} if kind == "BsdfPrincipled" else {}
    given["Roughness"] = 0.2
    for normal in (bumped, mapped("TANGENT"), lambda graph: graph("NewGeometry", "True Normal")):
        assert warnings(kind, given | {"Normal": normal}) == ""
    for normal in (slanted, mapped("OBJECT")):
        assert ("viewer's side" in warnings(kind, given | {"Normal": normal})) == (VERSION < (4, 0, 0))
        assert warnings("BsdfPrincipled", {"Roughness": 0.2, "Normal": normal}) == ""


@pytest.mark.skipif(VERSION >= (4, 0, 0), reason="velvet became the node Sheen")
def test_bumps_of_velvet_are_named() -> None:
    assert warnings("BsdfVelvet", {}) == ""
    assert "has bumps" in warnings("BsdfVelvet", {"Normal": bumped})


@pytest.mark.skipif(not hasattr(bpy.types, "ShaderNodeBsdfRayPortal"), reason="portals came with 4.2")
def test_directions_of_portals_of_another_length_are_named() -> None:
    def position(graph: Graph) -> bpy.types.NodeSocket:
        return graph("NewGeometry", "Position")

    def incoming(graph: Graph) -> bpy.types.NodeSocket:
        return graph("NewGeometry", "Incoming")

    def normalized(graph: Graph) -> bpy.types.NodeSocket:
        return graph("VectorMath", "Vector", {"Vector": position(graph)}, operation="NORMALIZE")

    def named(direction: Any) -> bool:
        return "length is not 1" in warnings("BsdfRayPortal", {"Direction": direction})

    assert not any(named(kind) for kind in ((0.0, 0.0, 0.0), (0.0, 0.6, 0.8), incoming, normalized))
    is_old = VERSION < (5, 2, 0)
    assert [named(kind) for kind in ((0.0, 2.0, 0.0), position)] == [is_old, is_old]
