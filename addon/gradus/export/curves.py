"""Curves, text, surfaces and metaballs: Blender makes a mesh of them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

CONVERTIBLE = frozenset({"CURVE", "SURFACE", "FONT", "META"})
GEOMETRY = CONVERTIBLE | {"MESH"}


@contextmanager
def evaluated_mesh(obj: Any, data: Any) -> Iterator[Any]:
    """The mesh of an evaluated object, or None where it has none. `data`: what the instance shows; already a mesh for most."""
    if data is not None and data.bl_rna.identifier == "Mesh":
        yield data
        return
    try:
        mesh = obj.to_mesh()
    except RuntimeError:  # an object that cannot become a mesh: an empty curve, a metaball outside its family
        yield None
        return
    try:
        yield mesh
    finally:
        obj.to_mesh_clear()
