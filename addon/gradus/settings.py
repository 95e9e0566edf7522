"""The settings of a scene, from which Blender properties, command-line options and native settings are made.

The rows are generated in setting_table.py. This module does not use Blender.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from typing import Any

from . import setting_table
from .failure import Failure

BOOL, INT, FLOAT, ENUM, TEXT, FOLDER = "BOOL", "INT", "FLOAT", "ENUM", "TEXT", "FOLDER"


@dataclass(frozen=True)
class Setting:
    """One setting of a scene.

    `native` says whether GradusSettings has a field of the same name, `command_line` whether there is an option.
    """

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
    command_line: bool = True
    unit: str = "NONE"  # of Blender

    def value_of(self, identifier: str) -> int:
        """Returns the native value of an enum identifier.

        Raises Failure for unknown ones, such as "", as which Blender reads unknown stored numbers.
        """
        known = {choice[0]: choice[3] for choice in self.choices}
        if identifier not in known:
            choices = ", ".join(known)
            raise Failure(f"{self.label} ({self.name}) has an unknown value: choose one of {choices}")
        return known[identifier]


SETTINGS = tuple(Setting(**row) for row in setting_table.ROWS)
BY_NAME = {setting.name: setting for setting in SETTINGS}
TEST_SWITCHES = setting_table.TEST_SWITCHES
FROM_BLENDER = setting_table.FROM_BLENDER

COMPONENT_SETTINGS = frozenset(("use_decomposition", "components", "component_replays"))
"""Settings of final renders only. Previews and the viewport do not decompose the image."""


def fill(settings: Any, owner: Callable[[str], tuple[Any, str]], left_out: Collection[str] = ()) -> None:
    """Copies the scene's values into a native.Settings, except those in `left_out`.

    owner(name) returns the properties that have the value of a setting, and its name there.
    """
    for setting in native_settings():
        if setting.name not in left_out:
            setattr(settings, setting.name, native_value(setting, getattr(*owner(setting.name))))


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
