"""Options after `--` on the command line (contract 5.4): `--gradus-name VALUE` or `--gradus-name=VALUE`. No Blender here.

They overlay the scene's settings and never change the scene. Options of others are ignored; an unknown one of ours is an error.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from . import passes, settings
from .abi import ComponentPass, Pass

PREFIX = "--gradus-"

_BOOL = {"1": True, "true": True, "on": True, "0": False, "false": False, "off": False}


class OptionError(ValueError):
    """An option or a value that we do not know; the text is for the user."""


@dataclass(frozen=True)
class Overrides:
    """What the command line asks for. `native` goes through gradus_settings_parse in this order; `host` is parsed already."""

    native: tuple[tuple[str, str], ...] = ()
    host: dict[str, object] = field(default_factory=dict)
    stats: str = ""
    save_scene: str = ""
    threads: int = 0
    passes: passes.Extra = passes.NOTHING

    def text(self, name: str) -> str | None:
        """Text of the last native option `name`; None if it was not given."""
        return next((text for option, text in reversed(self.native) if option == name), None)

    def value(self, name: str) -> str | None:
        """The same of an enum, in lower case and with underscores."""
        text = self.text(name)
        return None if text is None else text.lower().replace("-", "_")

    def switch(self, name: str) -> bool | None:
        """The same of a switch; None, too, where it is none, which the library says."""
        return _BOOL.get((self.text(name) or "").lower())

    def refuse_components(self) -> None:
        """Raises OptionError where something is asked of the components of a picture that is not taken apart (contract 5.1)."""
        name = "components" if self.text("components") is not None else "passes" if self.passes.parts else ""
        if name:
            raise OptionError(f"option {PREFIX}{name}: the picture is not taken apart into components; add {PREFIX}use-decomposition 1")


def parse(arguments: Sequence[str]) -> Overrides:
    """`arguments`: those after `--`. Raises OptionError. The values of native settings are left to the library."""
    native: list[tuple[str, str]] = []
    host: dict[str, object] = {}
    rest = {"stats": "", "save_scene": "", "threads": 0, "passes": passes.NOTHING}
    for name, text in _pairs(arguments):
        if name in ("stats", "save_scene"):
            rest[name] = text
        elif name == "threads":
            rest["threads"] = _integer(name, text, 0, 1024)
        elif name == "passes":
            rest["passes"] = _passes(text)
        elif name in settings.TEST_SWITCHES or (name in settings.BY_NAME and settings.BY_NAME[name].native):
            native.append((name, text))
        elif name in settings.BY_NAME:
            host[name] = _host_value(settings.BY_NAME[name], text)
        else:
            raise OptionError(f"unknown option {PREFIX}{name.replace('_', '-')}")
    return Overrides(tuple(native), host, **rest)


def _pairs(arguments: Sequence[str]) -> list[tuple[str, str]]:
    """(name with underscores, value) of every option of ours."""
    pairs = []
    remaining = iter(arguments)
    for argument in remaining:
        if not argument.startswith(PREFIX):
            continue
        name, equals, text = argument[len(PREFIX) :].partition("=")
        if not equals:
            text = next(remaining, None)
            if text is None or text.startswith(PREFIX):
                raise OptionError(f"option {argument} needs a value")
        pairs.append((name.replace("-", "_"), text))
    return pairs


def _integer(name: str, text: str, minimum: float, maximum: float) -> int:
    try:
        value = int(text)
    except ValueError:
        raise OptionError(f"option {PREFIX}{name.replace('_', '-')}: '{text}' is no integer") from None
    if not minimum <= value <= maximum:
        raise OptionError(f"option {PREFIX}{name.replace('_', '-')}: {value} is outside {minimum:g} to {maximum:g}")
    return value


def _host_value(setting: settings.Setting, text: str) -> object:
    if setting.kind == settings.INT:
        return _integer(setting.name, text, setting.minimum, setting.maximum)
    if setting.kind == settings.BOOL:
        if text.lower() not in _BOOL:
            raise OptionError(f"option {PREFIX}{setting.name.replace('_', '-')}: '{text}' is none of 0 1 true false on off")
        return _BOOL[text.lower()]
    return text


_PLANES = passes.GROUPS | {plane.name: (plane,) for plane in Pass if plane != Pass.COUNT}
_PARTS = {"COMPONENTS": tuple(part.plane for part in passes.PARTS)} | {
    f"COMPONENT_{part.plane.name}": (part.plane,) for part in passes.PARTS
}


def _passes(text: str) -> passes.Extra:
    """Names of native passes, or of groups of them, separated by commas."""
    planes: set[Pass] = set()
    parts: set[ComponentPass] = set()
    for item in filter(None, (item.strip() for item in text.split(","))):
        name = item.upper().replace("-", "_")
        if name not in _PLANES and name not in _PARTS:
            known = sorted(n.lower() for n in {*_PLANES, *_PARTS})
            raise OptionError(f"option {PREFIX}passes: unknown pass '{item}'; there are {', '.join(known)}")
        planes.update(_PLANES.get(name, ()))
        parts.update(_PARTS.get(name, ()))
    return passes.Extra(frozenset(planes), frozenset(parts))


@lru_cache(maxsize=8)
def _parse_cached(arguments: tuple[str, ...]) -> Overrides:
    return parse(arguments)


def current() -> Overrides:
    """The options of this process. Raises OptionError."""
    arguments = sys.argv
    return _parse_cached(tuple(arguments[arguments.index("--") + 1 :]) if "--" in arguments else ())
