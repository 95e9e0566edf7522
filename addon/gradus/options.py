"""Options after `--` on the command line: `--gradus-name VALUE` or `--gradus-name=VALUE`. No Blender here.

Options replace the scene's settings during a render and never change the scene. An unknown option that starts with
`--gradus-` is an error, and all other arguments are ignored.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from . import passes, settings
from .abi import ComponentPass, Pass
from .failure import Failure

PREFIX = "--gradus-"

_BOOL = {"1": True, "true": True, "on": True, "0": False, "false": False, "off": False}


class OptionError(Failure):
    """An unknown option or value; the text is for the user."""


@dataclass(frozen=True)
class Overrides:
    """The options of a command line.

    `native` holds texts for gradus_settings_parse, in order; `host` holds parsed values.
    """

    native: tuple[tuple[str, str], ...] = ()
    host: dict[str, object] = field(default_factory=dict)
    stats: str = ""
    save_scene: str = ""
    threads: int = 0
    passes: passes.ExtraPasses = passes.NO_EXTRA

    def text(self, name: str) -> str | None:
        """Returns the text of the last native option `name`, or None."""
        return next((text for option, text in reversed(self.native) if option == name), None)

    def value(self, name: str) -> str | None:
        """Returns the last value of an enum option in lower case and with underscores, or None."""
        text = self.text(name)
        return None if text is None else text.lower().replace("-", "_")

    def switch(self, name: str) -> bool | None:
        """Returns the last value of a Boolean option, or None. The library reports values that are not Boolean."""
        return _BOOL.get((self.text(name) or "").lower())

    def refuse_components(self) -> None:
        """Raises OptionError if options concern components while the image is not decomposed."""
        name = "components" if self.text("components") is not None else "passes" if self.passes.component_planes else ""
        if name:
            problem = f"the image is not decomposed into components; add {PREFIX}use-decomposition 1"
            raise OptionError(f"option {PREFIX}{name}: {problem}")


def parse(arguments: Sequence[str]) -> Overrides:
    """Parses the arguments after `--`. Raises OptionError. The values of native settings are left to the library."""
    native: list[tuple[str, str]] = []
    host: dict[str, object] = {}
    special = {"stats": "", "save_scene": "", "threads": 0, "passes": passes.NO_EXTRA}
    for name, text in _pairs(arguments):
        if name in ("stats", "save_scene"):
            special[name] = text
        elif name == "threads":
            special["threads"] = _integer(name, text, 0, 1024)
        elif name == "passes":
            special["passes"] = _passes(text)
        elif name in settings.TEST_SWITCHES or (name in settings.BY_NAME and settings.BY_NAME[name].native):
            native.append((name, text))
        elif name in settings.BY_NAME and settings.BY_NAME[name].command_line:
            host[name] = _host_value(settings.BY_NAME[name], text)
        else:
            raise OptionError(f"unknown option {PREFIX}{name.replace('_', '-')}")
    return Overrides(tuple(native), host, **special)


def _pairs(arguments: Sequence[str]) -> list[tuple[str, str]]:
    """Returns (name with underscores, value) of every Gradus option."""
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
        raise OptionError(f"option {PREFIX}{name.replace('_', '-')}: '{text}' is not an integer") from None
    if not minimum <= value <= maximum:
        raise OptionError(f"option {PREFIX}{name.replace('_', '-')}: {value} is outside {minimum:g} to {maximum:g}")
    return value


def _host_value(setting: settings.Setting, text: str) -> object:
    if setting.kind == settings.INT:
        return _integer(setting.name, text, setting.minimum, setting.maximum)
    if setting.kind == settings.BOOL:
        if text.lower() not in _BOOL:
            option = f"{PREFIX}{setting.name.replace('_', '-')}"
            raise OptionError(f"option {option}: '{text}' is not one of 0 1 true false on off")
        return _BOOL[text.lower()]
    return text


_PLANES = passes.GROUPS | {plane.name: (plane,) for plane in Pass if plane != Pass.COUNT}
_COMPONENT_PLANES = {"COMPONENTS": tuple(info.plane for info in passes.COMPONENT_TABLE)} | {
    f"COMPONENT_{info.plane.name}": (info.plane,) for info in passes.COMPONENT_TABLE
}


def _passes(text: str) -> passes.ExtraPasses:
    """Parses names of native passes and of groups of them, separated by commas."""
    planes: set[Pass] = set()
    component_planes: set[ComponentPass] = set()
    for item in filter(None, (item.strip() for item in text.split(","))):
        name = item.upper().replace("-", "_")
        if name not in _PLANES and name not in _COMPONENT_PLANES:
            known = sorted(n.lower() for n in {*_PLANES, *_COMPONENT_PLANES})
            raise OptionError(f"option {PREFIX}passes: unknown pass '{item}'; there are {', '.join(known)}")
        planes.update(_PLANES.get(name, ()))
        component_planes.update(_COMPONENT_PLANES.get(name, ()))
    return passes.ExtraPasses(frozenset(planes), frozenset(component_planes))


@lru_cache(maxsize=8)
def _parse_cached(arguments: tuple[str, ...]) -> Overrides:
    return parse(arguments)


def current() -> Overrides:
    """Returns the options of this process. Raises OptionError."""
    arguments = sys.argv
    return _parse_cached(tuple(arguments[arguments.index("--") + 1 :]) if "--" in arguments else ())
