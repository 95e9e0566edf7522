"""Export of Blender's depsgraph to the C API, with one module for each kind of data."""

from __future__ import annotations

from .camera import ViewOverride
from .exporter import Exporter
from .report import Cancelled, ExportError, ExportReport

__all__ = ["Cancelled", "ExportError", "ExportReport", "Exporter", "ViewOverride"]
