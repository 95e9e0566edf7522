"""The edges of meshes, and values of edges on their vertices."""

from __future__ import annotations

from array import array
from typing import Any

from .. import compat
from .arrays import read


def edge_vertices(mesh: Any) -> array:
    """Returns the 2 vertices of each edge."""
    return array("i", read(mesh.edges, "vertices", "I", 2).tobytes())


def on_vertices(mesh: Any, values: array, channels: int, data_type: str) -> array:
    """Returns the mean of the values of the edges at each vertex, as Cycles reads them.

    From 4.1 on Blender interpolates them: truth values are true where one of the edges is, and integers are rounded.
    """
    import numpy as np  # imported late, because few meshes have attributes of edges

    vertices = np.frombuffer(edge_vertices(mesh), dtype=np.int32)
    count = len(mesh.vertices)
    columns = np.repeat(np.frombuffer(values, dtype=np.float32).reshape(-1, channels), 2, axis=0).T
    sums = np.stack([np.bincount(vertices, weights=column, minlength=count) for column in columns], axis=1)
    means = sums / np.maximum(np.bincount(vertices, minlength=count), 1)[:, None]
    keeps_type = compat.VERSION >= (4, 1, 0)
    if keeps_type and data_type == "BOOLEAN":
        means = sums > 0.0
    elif keeps_type and data_type.startswith("INT"):
        means = np.copysign(np.floor(np.abs(means) + 0.5), means)
    return array("f", means.astype(np.float32).tobytes())
