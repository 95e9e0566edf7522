"""The region of a viewport that is rendered: all of it, or the render border."""

from __future__ import annotations

from typing import Any

Rectangle = tuple[int, int, int, int]


def region(context: Any, scene: Any) -> Rectangle:
    """Returns x0, y0, x1, y1 in pixels, with exclusive upper bounds.

    The rectangle is empty if the border lies outside.
    """
    width, height = context.region.width, context.region.height
    full = (0.0, 0.0, float(width), float(height))
    if context.region_data.view_perspective == "CAMERA":
        border = _border(scene.render) if scene.render.use_border else None
        frame = camera_frame(context, scene) if border else None
        return clip(border, frame or full, width, height)
    space = context.space_data
    return clip(_border(space) if space.use_render_border else None, full, width, height)


def _border(owner: Any) -> tuple[float, float, float, float]:
    """Returns the border of the scene's render settings or of a 3D viewport, which use different property names."""
    prefix = "render_border" if hasattr(owner, "render_border_min_x") else "border"
    return tuple(getattr(owner, f"{prefix}_{side}") for side in ("min_x", "min_y", "max_x", "max_y"))


def clip(
    border: tuple[float, float, float, float] | None, frame: tuple[float, float, float, float], width: int, height: int
) -> Rectangle:
    """Returns a border in whole pixels. `border` is relative to `frame`, which is in pixels."""
    if border is None:
        return 0, 0, width, height
    left, bottom, right, top = frame
    x0, x1 = (int(left + value * (right - left)) for value in (border[0], border[2]))
    y0, y1 = (int(bottom + value * (top - bottom)) for value in (border[1], border[3]))
    x0, y0 = min(max(x0, 0), width), min(max(y0, 0), height)
    return x0, y0, max(min(x1, width), x0), max(min(y1, height), y0)


def camera_frame(context: Any, scene: Any) -> tuple[float, float, float, float] | None:
    """Returns left, bottom, right, top of the camera's frame in pixels of the region, or None without a camera."""
    space = context.space_data
    camera = space.camera if space.use_local_camera else scene.camera
    if camera is None or camera.type != "CAMERA":
        return None
    matrix = context.region_data.perspective_matrix @ camera.matrix_world.normalized()
    corners = [matrix @ corner.to_4d() for corner in camera.data.view_frame(scene=scene)]
    if any(corner.w <= 0.0 for corner in corners):
        return None
    xs = [(0.5 + 0.5 * corner.x / corner.w) * context.region.width for corner in corners]
    ys = [(0.5 + 0.5 * corner.y / corner.w) * context.region.height for corner in corners]
    return min(xs), min(ys), max(xs), max(ys)
