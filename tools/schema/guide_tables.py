"""The tables and lists of the user guide, which stand between `<!-- generated: NAME -->` and `<!-- end -->`."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable

from c_header import WIDTH
from model import MAX_FLOAT, Option, Pass, Schema
from python_tables import KINDS


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _default(option: Option) -> str:
    if option.type == "bool":
        return "on" if option.default else "off"
    if option.type in ("text", "folder"):
        return "empty"
    return f"{option.default:g}" if isinstance(option.default, float) else f"{option.default}"


def _range(option: Option) -> str:
    if option.type not in ("int", "float"):
        return "on, off" if option.type == "bool" else ""
    maximum = option.maximum
    is_bounded = maximum is not None and maximum < MAX_FLOAT
    text = f"{option.minimum:g} to {maximum:.10g}" if is_bounded else f"from {option.minimum:g}"
    return f"{text} {option.unit}".strip()


def _meaning(schema: Schema, option: Option) -> str:
    if option.type in KINDS:
        return option.doc
    values = [f"`{value.name}`: {value.doc}" for value in schema.enum(option.type).values]
    return "<br>".join([option.doc, *values])


def options(schema: Schema) -> str:
    """Returns a table with a row for each option of a scene, of the command line or of the panels."""
    lines = ["| option | default | range | what it does |", "|---|---|---|---|"]
    for option in schema.options:
        if option.source in ("scene", "command", "panel"):
            name = f"`{option.name}`" + (" (panel only)" if option.source == "panel" else "")
            cells = [name, _default(option), _range(option), _cell(_meaning(schema, option))]
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _where(item: Pass) -> str:
    if item.switch == "option":
        return "command line only"
    return {"always": "always", "reconstructed": "with a reconstruction"}.get(item.switch, "view layer")


def passes(schema: Schema) -> str:
    """Returns a table with a row for each pass."""
    lines = ["| pass | on the command line | there | content |", "|---|---|---|---|"]
    for item in schema.passes:
        name = f"`{item.label}`" + (f", before Blender 5.0 `{item.old_label}`" if item.old_label else "")
        lines.append(f"| {name} | `{item.name.lower()}` | {_where(item)} | {_cell(item.doc)} |")
    return "\n".join(lines)


def component_passes(schema: Schema) -> str:
    """Returns a table with a row for each pass of a component."""
    lines = ["| pass | on the command line | content |", "|---|---|---|"]
    for item in schema.component_passes:
        suffix = f" {item.label}" if item.suffix is None else item.suffix
        lines.append(f"| `Path NAME{suffix}` | `component_{item.name.lower()}` | {_cell(item.doc)} |")
    return "\n".join(lines)


def nodes(schema: Schema) -> str:
    """Returns a list of Blender's nodes by family."""
    lines: list[str] = []
    for family in schema.families:
        text = f"- {family.title}: {', '.join(name for name, _ in family.nodes)}."
        lines += textwrap.wrap(text, WIDTH, subsequent_indent="  ", break_on_hyphens=False)
    return "\n".join(lines)


TABLES: dict[str, Callable[[Schema], str]] = {
    "options": options,
    "passes": passes,
    "component passes": component_passes,
    "nodes": nodes,
}


def fill(schema: Schema, text: str) -> str:
    """Returns the guide with new tables. Text outside their markers is unchanged."""

    def table(match: re.Match[str]) -> str:
        make = TABLES.get(match[1])
        return f"<!-- generated: {match[1]} -->\n{make(schema)}\n<!-- end -->" if make else match[0]

    return re.sub(r"<!-- generated: ([\w ]+) -->\n.*?<!-- end -->", table, text, flags=re.S)
