"""Attributes of meshes: UV maps, colours and generic ones, as floats on points, faces or corners."""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from typing import Any

from .. import compat, native
from .arrays import Reader, Values, read
from .edges import on_vertices

_DOMAINS = {"POINT": 0, "FACE": 1, "CORNER": 2}
# data type: property, type code in which Blender stores it, channels
_TYPES = {
    "FLOAT": ("value", "f", 1),
    "INT": ("value", "i", 1),
    "INT8": ("value", "b", 1),
    "BOOLEAN": ("value", "b", 1),
    "FLOAT2": ("vector", "f", 2),
    "FLOAT_VECTOR": ("vector", "f", 3),
    "FLOAT_COLOR": ("color", "f", 4),
    "BYTE_COLOR": ("color", "f", 4),  # read as scene-linear
    "FLOAT4": ("vector", "f", 4),
    "QUATERNION": ("value", "f", 4),
}


@dataclass
class AttributeArrays:
    name: str
    domain: int
    channels: int
    data: Values
    is_uv: bool = False


def default_uv(mesh: Any) -> str:
    """Returns the name of the UV map that is active for renders.

    Geometry nodes output UV maps as plain attributes: if there are no UV maps, the first such attribute is used.
    """
    for layer in mesh.uv_layers:
        if layer.active_render:
            return layer.name
    if len(mesh.uv_layers):
        return mesh.uv_layers[0].name
    for attribute in mesh.attributes:
        is_uv = attribute.domain == "CORNER" and attribute.data_type == "FLOAT2"
        if is_uv and not attribute.name.startswith("."):
            return attribute.name
    return ""


def default_color(mesh: Any) -> str:
    """Returns the name of the colour attribute that is active for renders."""
    layers = mesh.color_attributes
    index = layers.render_color_index
    return layers[index].name if 0 <= index < len(layers) else ""


def _read_uv(layer: Any, get: Reader) -> Values:
    if hasattr(layer, "uv"):
        return get(layer.uv, "vector", "f", 2)
    return read(layer.data, "uv", "f", 2)


def read_values(attribute: Any, get: Reader = read) -> tuple[int, Values] | None:
    """Returns the number of channels and the values of an attribute as floats, or None if it holds no numbers."""
    if attribute.data_type not in _TYPES:
        return None
    prop, typecode, channels = _TYPES[attribute.data_type]
    if typecode == "f":
        return channels, get(attribute.data, prop, typecode, channels)
    return channels, array("f", read(attribute.data, prop, typecode, channels))


def _decoded_bytes(attribute: Any) -> array:
    """Returns colours of bytes in linear Rec. 709. Cycles shows them as if they were of the working space."""
    import numpy as np  # imported late, because few files have another working space

    data = read(attribute.data, "color_srgb", "f", 4)
    colors = np.frombuffer(data, np.float32).reshape(-1, 4)[:, :3]  # a view of `data`
    colors[:] = np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
    return data


def _read_generic(mesh: Any, attribute: Any, name: str, get: Reader) -> AttributeArrays | None:
    """Returns an attribute of any domain. Values of edges become values of vertices, as in Cycles."""
    values = read_values(attribute, get)
    if values is None:
        return None
    channels, data = values
    domain = attribute.domain
    if attribute.data_type == "BYTE_COLOR" and domain != "CORNER" and compat.has_other_working_space():
        data = _decoded_bytes(attribute)
    if domain == "EDGE":
        domain, data = "POINT", on_vertices(mesh, data, channels, attribute.data_type)
    is_uv = attribute.data_type == "FLOAT2" and domain == "CORNER"
    return AttributeArrays(name, _DOMAINS[domain], channels, data, is_uv)


def read_attributes(
    mesh: Any, wanted: frozenset[str] | None, uv_name: str, get: Reader = read
) -> list[AttributeArrays]:
    """Returns the attributes of a mesh whose names are in `wanted` (None for all), and the UV map `uv_name`.

    The name "" stands for the colour attribute that is active for renders. get: reads collections, copying or not.
    """
    found = []
    uv_layers = {layer.name: layer for layer in mesh.uv_layers}
    for name, layer in uv_layers.items():
        if name == uv_name or wanted is None or name in wanted:
            data = _read_uv(layer, get)
            if len(data):
                found.append(AttributeArrays(name, _DOMAINS["CORNER"], 2, data, is_uv=True))
    for attribute in mesh.attributes:
        name = attribute.name
        if name in uv_layers or (name.startswith(".") and (wanted is None or name not in wanted)):
            continue
        if name == uv_name or wanted is None or name in wanted:
            arrays = _read_generic(mesh, attribute, name, get)
            if arrays is not None and len(arrays.data):
                found.append(arrays)
    if wanted is not None and "" in wanted:
        color = mesh.color_attributes.get(default_color(mesh))
        arrays = _read_generic(mesh, color, "", get) if color is not None else None
        if arrays is not None:
            found.append(arrays)
    return found


def fill_attributes(arrays: list[AttributeArrays]) -> Any:
    """Returns a ctypes array of native Attributes, or None."""
    return native.struct_array(
        native.Attribute,
        (
            native.Attribute(
                domain=values.domain,
                channels=values.channels,
                is_uv=values.is_uv,
                name=native.name(values.name),
                data=native.pointer(values.data),
            )
            for values in arrays
        ),
    )
