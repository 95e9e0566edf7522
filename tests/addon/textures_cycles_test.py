"""Procedural textures have the patterns of Cycles in the same Blender, pixel by pixel.

Coordinates are constant within a pixel, so that it does not matter where an engine puts its samples.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
from support import images, recording
from support.nodes import Graph, new_material, show

WIDTH, HEIGHT, COLUMNS = 64, 36, 4
TOLERANCE = 2e-5
DIMENSIONS = ("1D", "2D", "3D", "4D")
FEATURES = ("F1", "F2", "SMOOTH_F1")
METRICS = ("EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI")


def has_node(kind: str) -> bool:
    tree = bpy.data.materials.new("probe")
    if bpy.app.version < (5, 0, 0):
        tree.use_nodes = True
    try:
        tree.node_tree.nodes.new(f"ShaderNode{kind}")
    except RuntimeError:
        return False
    return True


HAS_GABOR, HAS_MUSGRAVE = has_node("TexGabor"), has_node("TexMusgrave")
HAS_OCTAVES = "normalize" in bpy.types.ShaderNodeTexVoronoi.bl_rna.properties


@pytest.fixture(scope="module")
def sheet() -> bpy.types.Scene:
    """Returns a scene with a column of 16×36 pixels for each of four materials, a unit of length for each pixel."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    images.prepare(scene)
    for column in range(COLUMNS):
        bpy.ops.mesh.primitive_plane_add(size=1.0, location=((column - 1.5) * WIDTH / COLUMNS, 0.0, 0.0))
        bpy.context.object.scale = (WIDTH / COLUMNS, HEIGHT, 1.0)
    recording.add_camera(type="ORTHO", ortho_scale=float(WIDTH)).location = (0.0, 0.0, 5.0)
    scene.world = bpy.data.worlds.new("World")
    return scene


def pixel(graph: Graph) -> bpy.types.NodeSocket:
    """Returns the lower left corner of the pixel, in pixels from the middle of the picture."""
    position = graph("NewGeometry", "Position")
    snapped = graph("VectorMath", "Vector", {"Vector": position}, operation="SNAP")
    snapped.node.inputs[1].default_value = (1.0, 1.0, 1.0)
    return snapped


def dot(graph: Graph, vector: bpy.types.NodeSocket, weights: tuple[float, float, float]) -> bpy.types.NodeSocket:
    product = graph("VectorMath", "Value", {"Vector": vector}, operation="DOT_PRODUCT")
    product.node.inputs[1].default_value = weights
    return product


def place(graph: Graph) -> dict[str, bpy.types.NodeSocket]:
    """Returns coordinates of 1 to 4 dimensions that vary over the picture, from about -3 to 3."""
    corner = pixel(graph)
    weights = {"X": (0.0917, 0.0113, 0.0), "Y": (-0.0217, 0.1131, 0.0), "Z": (0.0431, -0.0573, 0.0)}
    vector = graph("CombineXYZ", "Vector", {axis: dot(graph, corner, weights[axis]) for axis in "XYZ"})
    return {"Vector": vector, "W": dot(graph, corner, (0.0513, 0.0367, 0.0))}


def shown(graph: Graph, value: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Returns a value of any sign as a colour above 0."""
    scaled = graph("VectorMath", "Vector", {"Vector": value}, operation="MULTIPLY_ADD")
    scaled.node.inputs[1].default_value, scaled.node.inputs[2].default_value = (0.125,) * 3, (2.0,) * 3
    return scaled


def picture(scene: bpy.types.Scene, folder: Path, engine: str) -> np.ndarray:
    scene.render.engine = engine
    cycles = scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 1, False, False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    settings = {"samples": 2, "integrator": "PATH", "reconstruction": "NONE", "pixel_filter": "BOX"}
    image = images.render(scene, folder, filter_width=1.0, **settings)["Combined"][..., :3]
    return (image - 2.0) / 0.125


def compare(
    scene: bpy.types.Scene,
    folder: Path,
    outputs: list[Callable[[Graph], bpy.types.NodeSocket]],
    spread: float = 0.05,
    tolerance: float = TOLERANCE,
) -> None:
    """Shows up to four values in the columns and compares them. They vary by `spread` at least."""
    for index, item in enumerate(item for item in scene.objects if item.type == "MESH"):
        material = new_material()
        graph = Graph(material)
        show(material, shown(graph, outputs[index % len(outputs)](graph)))
        item.data.materials.clear()
        item.data.materials.append(material)
    expected, found = picture(scene, folder, "CYCLES"), picture(scene, folder, "GRADUS")
    for index in range(min(len(outputs), COLUMNS)):
        column = np.s_[:, index * WIDTH // COLUMNS : (index + 1) * WIDTH // COLUMNS]
        values, difference = expected[column], np.abs(expected[column] - found[column])
        assert values.std() >= spread, f"output {index} hardly varies"
        # A pixel may lie so close to the border of two cells that rounding decides between them.
        off = (difference > tolerance * (1.0 + np.abs(values))).any(axis=2)
        assert off.sum() <= 1, f"output {index}: {off.sum()} pixels, up to {difference.max()}"


# ------------------------------------------------------------------------------------------------ Voronoi


def voronoi(output: str, inputs: dict[str, Any], **properties: Any) -> Callable[[Graph], bpy.types.NodeSocket]:
    def make(graph: Graph) -> bpy.types.NodeSocket:
        return graph("TexVoronoi", output, {**place(graph), "Scale": 1.7, **inputs}, **properties)

    return make


def voronoi_outputs(dimensions: str) -> list[str]:
    places = {"1D": ["W"], "2D": ["Position"], "3D": ["Position"], "4D": ["Position", "W"]}
    return ["Distance", "Color", *places[dimensions]]


@pytest.mark.parametrize(
    ("dimensions", "feature", "metric"),
    [case for case in product(DIMENSIONS, FEATURES, METRICS) if case[0] != "1D" or case[2] == "EUCLIDEAN"],
)
def test_a9_cells(dimensions: str, feature: str, metric: str, sheet: bpy.types.Scene, tmp_path: Path) -> None:
    inputs = {"Randomness": 0.85, "Smoothness": 0.6, "Exponent": 1.6}
    kind = {"voronoi_dimensions": dimensions, "feature": feature, "distance": metric}
    compare(sheet, tmp_path, [voronoi(output, inputs, **kind) for output in voronoi_outputs(dimensions)])


@pytest.mark.parametrize("dimensions", DIMENSIONS)
def test_a9_edges_and_spheres(dimensions: str, sheet: bpy.types.Scene, tmp_path: Path) -> None:
    def of(feature: str, output: str, randomness: float) -> Callable[[Graph], bpy.types.NodeSocket]:
        return voronoi(output, {"Randomness": randomness}, voronoi_dimensions=dimensions, feature=feature)

    features = (("DISTANCE_TO_EDGE", "Distance"), ("N_SPHERE_RADIUS", "Radius"))
    outputs = [of(*feature, randomness) for feature in features for randomness in (1.0, 0.4)]
    compare(sheet, tmp_path, outputs, spread=0.02)


@pytest.mark.parametrize("inputs", [{"Smoothness": 0.0}, {"Smoothness": 3.0, "Randomness": 7.0}, {"Scale": 0.0}])
def test_a9_extremes_of_cells(inputs: dict[str, float], sheet: bpy.types.Scene, tmp_path: Path) -> None:
    """Inputs beyond the limits of sliders, which links can reach."""

    def of(output: str) -> Callable[[Graph], bpy.types.NodeSocket]:
        return lambda graph: voronoi(
            output,
            {name: graph("Math", "Value", {"Value": value}, operation="ADD") for name, value in linked.items()},
            feature="SMOOTH_F1",
        )(graph)

    linked = {name: value - 0.5 for name, value in inputs.items()}  # the other term of the sum is 0.5
    compare(sheet, tmp_path, [of(output) for output in ("Distance", "Color", "Position")], spread=0.0)


@pytest.mark.parametrize("exponent", [0.2, 0.5, 1.0, 8.0])
@pytest.mark.parametrize("feature", FEATURES)
def test_a9_exponents(feature: str, exponent: float, sheet: bpy.types.Scene, tmp_path: Path) -> None:
    """Small exponents give distances beyond 8, where those of Blender 3.4 end."""
    kind = {"feature": feature, "distance": "MINKOWSKI"}
    outputs = [voronoi(output, {"Exponent": exponent}, **kind) for output in ("Distance", "Color")]
    # The power of 1 / exponent multiplies the relative error of rounding.
    compare(sheet, tmp_path, outputs, spread=0.0, tolerance=TOLERANCE * max(1.0, exponent**-2))


@pytest.mark.skipif(not HAS_OCTAVES, reason="came with Blender 4.0")
@pytest.mark.parametrize("detail", [1.0, 2.4])
@pytest.mark.parametrize(("dimensions", "feature"), list(product(DIMENSIONS, (*FEATURES, "DISTANCE_TO_EDGE"))))
def test_a9_octaves_of_cells(
    dimensions: str, feature: str, detail: float, sheet: bpy.types.Scene, tmp_path: Path
) -> None:
    inputs = {"Detail": detail, "Roughness": 0.6, "Lacunarity": 2.3, "Randomness": 0.9, "Smoothness": 0.5}
    kind = {"voronoi_dimensions": dimensions, "feature": feature, "distance": "MANHATTAN"}
    names = ["Distance"] if feature == "DISTANCE_TO_EDGE" else voronoi_outputs(dimensions)
    for normalize in (False, True):
        outputs = [voronoi(name, inputs, **kind, normalize=normalize) for name in names]
        compare(sheet, tmp_path, outputs, spread=0.01)


# ------------------------------------------------------------------------------------------------ Musgrave, Gabor


@pytest.mark.skipif(not HAS_MUSGRAVE, reason="became a part of the Noise Texture in Blender 4.1")
@pytest.mark.parametrize("dimensions", DIMENSIONS)
@pytest.mark.parametrize(
    "kind", ["MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "FBM", "HETERO_TERRAIN"]
)
def test_a9_musgrave(kind: str, dimensions: str, sheet: bpy.types.Scene, tmp_path: Path) -> None:
    def of(detail: float, dimension: float, lacunarity: float) -> Callable[[Graph], bpy.types.NodeSocket]:
        inputs = {"Scale": 1.3, "Detail": detail, "Dimension": dimension, "Lacunarity": lacunarity}
        return lambda graph: graph(
            "TexMusgrave",
            "Fac",
            {**place(graph), **inputs, "Offset": 0.6, "Gain": 1.4},
            musgrave_type=kind,
            musgrave_dimensions=dimensions,
        )

    # Other lacunarities than 2 add errors of rounding in each octave.
    parameters = [(0.0, 2.0, 2.0), (0.4, 1.5, 2.2), (3.0, 0.7, 1.9), (5.6, 0.0, 2.0)]
    compare(sheet, tmp_path, [of(*values) for values in parameters], spread=0.0, tolerance=1e-4)


@pytest.mark.skipif(not HAS_GABOR, reason="came with Blender 4.3")
@pytest.mark.parametrize("anisotropy", [0.0, 0.7, 1.0])
@pytest.mark.parametrize("dimensions", ["2D", "3D"])
def test_a9_gabor(dimensions: str, anisotropy: float, sheet: bpy.types.Scene, tmp_path: Path) -> None:
    def of(output: str) -> Callable[[Graph], bpy.types.NodeSocket]:
        inputs = {
            "Scale": 1.4,
            "Frequency": 2.3,
            "Anisotropy": anisotropy,
            "Orientation 2D": 0.6,
            "Orientation 3D": (0.5, -0.7, 0.4),
        }
        return lambda graph: graph(
            "TexGabor", output, {"Vector": place(graph)["Vector"], **inputs}, gabor_type=dimensions
        )

    compare(sheet, tmp_path, [of(output) for output in ("Value", "Phase", "Intensity")])


# ------------------------------------------------------------------------------------------------ others


def test_a9_wavelengths(sheet: bpy.types.Scene, tmp_path: Path) -> None:
    """From 360 to 820 nm, beyond what is visible."""

    def spectrum(graph: Graph) -> bpy.types.NodeSocket:
        nanometres = graph("Math", "Value", {"Value": dot(graph, pixel(graph), (0.31, 13.0, 0.0))}, operation="ADD")
        nanometres.node.inputs[1].default_value = 590.0
        return graph("Wavelength", "Color", {"Wavelength": nanometres})

    # Blender 5 has other digits of the matrix from XYZ to Rec. 709.
    compare(sheet, tmp_path, [spectrum], tolerance=5e-4)


@pytest.mark.skipif(not hasattr(bpy.types, "ShaderNodeRadialTiling"), reason="came with Blender 5.0")
@pytest.mark.parametrize("is_normalized", [False, True])
@pytest.mark.parametrize("roundness", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("sides", [1.0, 2.0, 3.7, 5.0, 6.2])
def test_a9_radial_tiling(
    sides: float, roundness: float, is_normalized: bool, sheet: bpy.types.Scene, tmp_path: Path
) -> None:
    if sides <= 2.0 and 0.0 < roundness < 1.0:
        pytest.skip("Cycles has no value there")

    def of(output: str) -> Callable[[Graph], bpy.types.NodeSocket]:
        def make(graph: Graph) -> bpy.types.NodeSocket:
            column = graph("VectorMath", "Vector", {"Vector": pixel(graph)}, operation="WRAP")
            column.node.inputs[1].default_value, column.node.inputs[2].default_value = (8.0,) * 3, (-8.0,) * 3
            scaled = graph("VectorMath", "Vector", {"Vector": column}, operation="MULTIPLY_ADD")
            scaled.node.inputs[1].default_value, scaled.node.inputs[2].default_value = (0.171,) * 3, (0.057, 0.031, 0.0)
            inputs = {"Vector": scaled, "Sides": sides, "Roundness": roundness}
            return graph("RadialTiling", output, inputs, normalize=is_normalized)

        return make

    names = ("Segment Coordinates", "Segment ID", "Segment Width", "Segment Rotation")
    compare(sheet, tmp_path, [of(output) for output in names], spread=0.0, tolerance=1e-4)


@pytest.mark.parametrize("kind", ["TexVoronoi", *["TexMusgrave"] * HAS_MUSGRAVE, *["TexGabor"] * HAS_GABOR])
def test_a9_new_nodes(kind: str, sheet: bpy.types.Scene, tmp_path: Path) -> None:
    """Nodes with the values that Blender gives to new ones."""

    def of(output: str) -> Callable[[Graph], bpy.types.NodeSocket]:
        return lambda graph: graph(kind, output, {"Vector": place(graph)["Vector"]})

    names = {"TexVoronoi": ("Distance", "Color", "Position"), "TexMusgrave": ("Fac",), "TexGabor": ("Value", "Phase")}
    compare(sheet, tmp_path, [of(output) for output in names[kind]])
