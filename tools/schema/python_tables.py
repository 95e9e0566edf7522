"""setting_table.py and pass_table.py: the settings and passes of the add-on."""

from __future__ import annotations

import json
import textwrap
from typing import Any

from model import MAX_FLOAT, MAX_INT, Enum, Option, Pass, Schema

INDENT = " " * 8
KINDS = {"int": "INT", "float": "FLOAT", "bool": "BOOL", "text": "TEXT", "folder": "FOLDER"}
BLENDER_UNITS = {"s": "TIME_ABSOLUTE"}
"""Units that Blender shows; others are in the texts."""


def literal(value: Any) -> str:
    """Returns a value as ruff format writes it."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return f"{value:.1f}"
    return repr(value).replace("e+", "e")


def tooltip(text: str) -> str:
    """Returns a sentence without its period, which Blender adds."""
    return text.removesuffix(".")


def text_lines(text: str, indent: str, start: str, end: str) -> list[str]:
    """Returns the lines of `start`, `text` and `end`, with a long text in several literals."""
    one = f"{indent}{start}{literal(text)}{end}"
    if len(one) <= 120:
        return [one]
    width = 110 - len(indent)
    parts = textwrap.wrap(text, width, drop_whitespace=False, break_long_words=False, break_on_hyphens=False)
    return [f"{indent}{start}(", *(f"{indent}    {literal(part)}" for part in parts), f"{indent}){end}"]


def _choices(item: Enum) -> list[str]:
    lines = [f"{INDENT}choices=("]
    for value in item.values:
        lines += [f"{INDENT}    (", f"{INDENT}        {literal(value.name)},"]
        lines.append(f"{INDENT}        {literal(value.label)},")
        lines += text_lines(tooltip(value.doc), INDENT + "        ", "", ",")
        lines += [f"{INDENT}        {value.number},", f"{INDENT}    ),"]
    return [*lines, f"{INDENT}),"]


def _limits(option: Option) -> list[str]:
    if option.type in ("int", "float"):
        most = option.maximum if option.maximum is not None else {"int": MAX_INT, "float": MAX_FLOAT}[option.type]
        lines = [f"{INDENT}minimum={literal(option.minimum)},", f"{INDENT}maximum={literal(most)},"]
        lines += [f"{INDENT}soft_maximum={literal(option.soft_maximum)},"] if option.soft_maximum is not None else []
        return lines + ([f"{INDENT}precision={option.precision},"] if option.precision != 3 else [])
    return [f"{INDENT}maximum={option.maximum},"] if option.type == "text" else []


def _setting(schema: Schema, option: Option) -> list[str]:
    lines = ["    dict(", f"{INDENT}name={literal(option.name)},", f'{INDENT}kind="{KINDS.get(option.type, "ENUM")}",']
    lines += [f"{INDENT}default={literal(option.default)},", f"{INDENT}label={literal(option.label)},"]
    lines += text_lines(tooltip(option.doc), INDENT, "doc=", ",") + _limits(option)
    if option.type not in KINDS:
        lines += _choices(schema.enum(option.type))
    if option.host:
        lines.append(f"{INDENT}native=False,")
    if option.source == "panel":
        lines.append(f"{INDENT}command_line=False,")
    if option.unit in BLENDER_UNITS:
        lines.append(f'{INDENT}unit="{BLENDER_UNITS[option.unit]}",')
    return [*lines, "    ),"]


def _names(name: str, options: list[Option], doc: str) -> list[str]:
    return ["", f"{name} = (", *(f'    "{option.name}",' for option in options), ")", f'"""{doc}"""']


def _minimum_samples(options: list[Option]) -> list[str]:
    lines = []
    for option in options:
        if option.minimum_samples:
            lines += ["", f"{option.name.upper()}_MINIMUM_SAMPLES = {option.minimum_samples}"]
            lines.append(f'"""Samples per pixel from which AUTO of the setting {option.name} does something."""')
    return lines


def settings(schema: Schema, note: str) -> str:
    """Returns the text of setting_table.py."""
    lines = ['"""The settings of the engine as rows of settings.Setting.', "", note, '"""', ""]
    lines += ["from __future__ import annotations", "", "from typing import Any", ""]
    lines.append("ROWS: tuple[dict[str, Any], ...] = (")
    options = [option for option in schema.options if not option.is_plain]
    for option in options:
        if option.source in ("scene", "panel"):
            lines += _setting(schema, option)
    lines += [")"]
    command = [option for option in options if option.source == "command"]
    lines += _names("TEST_SWITCHES", command, "Native settings that exist on the command line only.")
    blender = [option for option in options if option.source == "blender"]
    lines += _names("FROM_BLENDER", blender, "Native settings that Blender's own properties give.")
    lines += _minimum_samples(options)
    return "\n".join([*lines, ""])


def kind_of(channels: str) -> str:
    """Returns Blender's kind of a pass."""
    if channels in ("RGB", "RGBA"):
        return "COLOR"
    return "VALUE" if len(channels) == 1 else "VECTOR"


def _row(values: list[str]) -> list[str]:
    one = f"    ({', '.join(values)}),"
    return [one] if len(one) <= 120 else ["    (", *(f"        {value}," for value in values), "    ),"]


def _pass(item: Pass) -> list[str]:
    names = [literal(item.old_label or item.label), literal(item.label)]
    switch = "" if item.switch == "always" else item.switch
    kind = [literal(item.channels), literal(kind_of(item.channels)), literal(switch)]
    return _row([f"Pass.{item.name}", *names, *kind])


def _component_pass(item: Pass) -> list[str]:
    suffix = f" {item.label}" if item.suffix is None else item.suffix
    kind = [literal(item.channels), literal(kind_of(item.channels)), literal(item.switch)]
    return _row([f"ComponentPass.{item.name}", literal(suffix), *kind])


def _groups(schema: Schema) -> list[str]:
    groups: dict[str, list[str]] = {}
    for item in schema.passes:
        if item.group:
            groups.setdefault(item.group, []).append(f"Pass.{item.name}")
    lines = ["", "GROUPS: dict[str, tuple[Pass, ...]] = {"]
    for name, passes in groups.items():
        lines.append(f"    {literal(name)}: ({', '.join(passes)}),")
    return [*lines, "}", '"""Names that --gradus-passes takes for several passes."""']


def passes(schema: Schema, note: str) -> str:
    """Returns the text of pass_table.py."""
    lines = [
        '"""The passes of the engine as rows of passes.PassInfo and passes.ComponentPassInfo.',
        "",
        note,
        '"""',
        "",
    ]
    lines += ["from __future__ import annotations", "", "from typing import Any", ""]
    lines += ["from .abi import ComponentPass, Pass", "", "PASSES: tuple[tuple[Any, ...], ...] = ("]
    for item in schema.passes:
        lines += _pass(item)
    lines += [")", '"""Plane, name before and since Blender 5.0, channels, kind, switch."""', ""]
    lines.append("COMPONENT_PASSES: tuple[tuple[Any, ...], ...] = (")
    for item in schema.component_passes:
        lines += _component_pass(item)
    lines += [")", '"""Plane, end of the name, channels, kind, switch."""', *_groups(schema), ""]
    lines.append("SWITCHES: tuple[tuple[str, str, str, bool], ...] = (")
    for switch in schema.switches:
        lines += ["    (", f"        {literal(switch.name)},", f"        {literal(switch.label)},"]
        lines += [*text_lines(tooltip(switch.doc), INDENT, "", ","), f"        {switch.default},", "    ),"]
    lines += [")", '"""Properties of view_layer.gradus: name, label, tooltip, default."""', ""]
    return "\n".join(lines)
