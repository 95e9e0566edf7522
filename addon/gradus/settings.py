"""The settings of a scene: Blender properties, command-line options and native settings are made from them. The rows are
generated: setting_table.py. This module does not use Blender."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

from . import setting_table
from .failure import Failure

BOOL, INT, FLOAT, ENUM, TEXT, FOLDER = "BOOL", "INT", "FLOAT", "ENUM", "TEXT", "FOLDER"


@dataclass(frozen=True)
class Setting:
    """One setting of a scene. `native`: the field of GradusSettings with the same name takes it."""

    name: str
    kind: str
    default: Any
    label: str
    doc: str
    minimum: float = 0
    maximum: float = 1
    soft_maximum: float | None = None
    precision: int = 3
    choices: tuple[tuple[str, str, str, int], ...] = ()  # identifier, label, meaning, native value
    native: bool = True
    unit: str = "NONE"  # of Blender

    def value_of(self, identifier: str) -> int:
        """Native value of an enum identifier. Blender reads a stored number that it does not know as ""."""
        known = {choice[0]: choice[3] for choice in self.choices}
        if identifier not in known:
            raise Failure(f"{self.label} ({self.name}) has a value that this version does not know: choose one of {', '.join(known)}")
        return known[identifier]


DENOISER_PAYS = 8
"""Samples from which denoiser AUTO runs; the library decides, and a test compares."""

SETTINGS = tuple(Setting(**row) for row in setting_table.ROWS)
BY_NAME = {setting.name: setting for setting in SETTINGS}
TEST_SWITCHES = setting_table.TEST_SWITCHES
FROM_BLENDER = setting_table.FROM_BLENDER

OF_COMPONENTS = frozenset(("use_decomposition", "components", "component_replays"))
"""Of final renders alone: previews and the viewport show the picture as one."""


def fill(settings: Any, properties: Any, left_out: Collection[str] = ()) -> None:
    """Copies the scene's values (attributes of `properties`) into a native.Settings; those left out are not even looked at."""
    for setting in native_settings():
        if setting.name not in left_out:
            setattr(settings, setting.name, native_value(setting, getattr(properties, setting.name)))


def native_value(setting: Setting, value: Any) -> Any:
    if setting.kind == ENUM:
        return setting.value_of(value)
    if setting.kind != TEXT:
        return value
    encoded = value.encode()
    if len(encoded) > setting.maximum:
        raise Failure(f"{setting.label} ({setting.name}) is longer than {setting.maximum:.0f} bytes")
    return encoded


def native_settings() -> Iterator[Setting]:
    return (setting for setting in SETTINGS if setting.native)
