"""Components: the set, its description by the library, and the component of a path."""

from __future__ import annotations

import textwrap
from typing import Any

import bpy

from .. import components, native, settings
from ..failure import Failure
from .base import RenderPanel
from .render_panels import characters


def described(scene: Any) -> tuple[components.Component, ...]:
    """Returns the components of the scene's set. Raises GradusError or Failure if the set is malformed."""
    return components.describe(native.load(), _text(scene))


def _text(scene: Any) -> bytes:
    return settings.native_value(settings.BY_NAME["components"], scene.gradus.components)


class GRADUS_RENDER_PT_decomposition(RenderPanel, bpy.types.Panel):
    bl_label = "Decomposition"
    bl_options = {"DEFAULT_CLOSED"}  # noqa: RUF012

    def draw_header(self, context: Any) -> None:
        self.layout.prop(context.scene.gradus, "use_decomposition", text="")

    def draw(self, context: Any) -> None:
        layout, scene = self.columns(), context.scene
        layout.active = scene.gradus.use_decomposition
        row = layout.row(align=True)
        row.prop(scene.gradus, "components")
        row.operator("gradus.write_out_components", text="", icon="GREASEPENCIL")
        draw_set(layout, context)
        layout.prop(scene.gradus, "component_replays")


def draw_set(layout: Any, context: Any) -> None:
    """Draws the components of the set, or its error."""
    try:
        found = described(context.scene)
    except Failure as error:
        draw_error(layout, str(error), characters(context))
        return
    draw_components(layout, found)
    layout.prop(context.window_manager.gradus, "path")
    draw_path(layout, context.scene, context.window_manager.gradus.path, characters(context))


def draw_error(layout: Any, text: str, width: int) -> None:
    column = layout.column(align=True)
    for index, line in enumerate(textwrap.wrap(text, width)):
        column.label(text=line, icon="BLANK1" if index else "ERROR")


def draw_components(layout: Any, found: tuple[components.Component, ...]) -> None:
    """Draws a row for each component: its name, its expression and some of its paths."""
    column = layout.column(align=True)
    for component in found:
        name, remainder = _split(column, 0.3)
        expression, examples = _split(remainder, 0.4)
        name.label(text=component.name)
        expression.label(text=component.expression or "all other paths")
        examples.label(text=component.examples or "no paths")


def _split(layout: Any, share: float) -> tuple[Any, Any]:
    split = layout.split(factor=share)
    return split.row(), split.row()


def draw_path(layout: Any, scene: Any, path: str, width: int) -> None:
    try:
        name = components.component_of(native.load(), _text(scene), path).name
    except native.GradusError as error:
        draw_error(layout, error.text, width)
    else:
        layout.label(text=f"{path.strip()} belongs to {name}", icon="CHECKMARK")


class GRADUS_OT_write_out_components(bpy.types.Operator):
    """Write the default set into the field, so that it can be edited"""

    bl_idname = "gradus.write_out_components"
    bl_label = "Insert Default Components"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    @classmethod
    def poll(cls, context: Any) -> bool:
        return not context.scene.gradus.components

    def execute(self, context: Any) -> set[str]:
        try:
            found = described(context.scene)
        except native.GradusError as error:  # the library is missing
            self.report({"ERROR"}, error.text)
            return {"CANCELLED"}
        context.scene.gradus.components = components.to_text(found)
        return {"FINISHED"}


CLASSES = (GRADUS_OT_write_out_components, GRADUS_RENDER_PT_decomposition)
