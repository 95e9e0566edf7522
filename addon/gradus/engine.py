"""The RenderEngine.

Each method makes one call into renderer.py or viewport.py, inside one try/except that reports errors.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable
from typing import Any

import bpy

from . import renderer, viewport
from .failure import is_expected, user_text


def free(state: dict[str, Any]) -> None:
    """Releases what an engine object holds. Accepts half-built objects: Blender deletes many that never rendered."""
    for owned in (state.pop("job", None), state.pop("view", None)):
        if owned is not None:
            owned.free()


# Looked up now: when Blender exits, its types may be freed before the last engine, and then a look-up crashes.
_parent_del: Callable[[Any], None] | None = getattr(bpy.types.RenderEngine, "__del__", None)


class GradusRenderEngine(bpy.types.RenderEngine):
    """The engine.

    It has no __init__, which Blender 4.5 and 5.0 would call twice: class-level defaults hold the initial state.
    """

    bl_idname = "GRADUS"
    bl_label = "Gradus"
    bl_use_preview = True
    bl_use_postprocess = True
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False  # True would hide the shader nodes of Cycles from the Add menu
    bl_use_gpu_context = False
    bl_use_custom_freestyle = False
    bl_use_spherical_stereo = True

    job: renderer.Job | None = None
    view: viewport.View | None = None
    failed = False

    def __del__(self) -> None:
        # When Blender exits, it frees its side of the object first, and then every look-up on self raises.
        free(object.__getattribute__(self, "__dict__"))
        if _parent_del is not None:
            _parent_del(self)

    def update_render_passes(
        self, scene: bpy.types.Scene | None = None, renderlayer: bpy.types.ViewLayer | None = None
    ) -> None:
        self._guard(lambda: renderer.register_passes(self, scene, renderlayer))

    def update(self, data: bpy.types.BlendData, depsgraph: bpy.types.Depsgraph) -> None:
        self.failed = False
        self._guard(lambda: renderer.update(self, data, depsgraph))

    def render(self, depsgraph: bpy.types.Depsgraph) -> None:
        if not self.failed:
            self._guard(lambda: renderer.render(self, depsgraph))

    def render_frame_finish(self) -> None:
        self._guard(lambda: renderer.frame_finished(self))

    def view_update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        self._guard(lambda: viewport.update(self, context, depsgraph))

    def view_draw(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        self._guard(lambda: viewport.draw(self, context, depsgraph))

    def _guard(self, action: Callable[[], Any]) -> None:
        """Runs an action and reports its exceptions.

        Only report({'ERROR'}) makes a render fail: otherwise Blender writes a blank frame and exits with code 0.
        """
        try:
            action()
        except Exception as error:
            self.failed = True
            if self.job is not None:
                self.job.free()
                self.job = None
            text = f"Gradus: {user_text(error)}"
            if not is_expected(error):
                traceback.print_exc()
            self.report({"ERROR"}, text)
            if not bpy.app.background:
                self.error_set(text)
