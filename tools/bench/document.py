"""A report as a list of blocks that can be written as Markdown and as one HTML page."""

from __future__ import annotations

import html
import re
from dataclasses import dataclass, field

LONG = 32  # characters from which a cell is text that may wrap


def number(value: float | None, form: str = ".2f") -> str:
    """Formats a number; a missing one is a dash."""
    return "–" if value is None else format(value, form)


def spread(values: tuple[float, float, float] | None, form: str = ".2f") -> str:
    """Formats a median with its range."""
    return "–" if values is None else f"{values[0]:{form}} ({values[1]:{form}}–{values[2]:{form}})"


@dataclass
class Text:
    """Paragraphs, lists, tables and headings in Markdown."""

    markdown: str

    def as_markdown(self) -> str:
        return self.markdown.strip()

    def as_html(self) -> str:
        return "\n".join(_block(block) for block in re.split(r"\n\s*\n", self.markdown.strip()))


@dataclass
class Table:
    columns: list[str]
    rows: list[list[str]] = field(default_factory=list)

    def as_markdown(self) -> str:
        lines = [self.columns, ["---"] * len(self.columns), *self.rows]
        return "\n".join("| " + " | ".join(line) + " |" for line in lines)

    def as_html(self) -> str:
        head = "".join(f"<th>{inline(c)}</th>" for c in self.columns)
        body = "\n".join("<tr>" + "".join(map(_cell, row)) + "</tr>" for row in self.rows)
        return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>\n{body}\n</tbody></table></div>'


@dataclass
class Figure:
    file: str
    caption: str

    def as_markdown(self) -> str:
        return f"![{self.caption}]({self.file})"

    def as_html(self) -> str:
        caption = f"<figcaption>{inline(self.caption)}</figcaption>"
        return f'<figure><img src="{self.file}" alt="{html.escape(self.caption)}">{caption}</figure>'


@dataclass
class Crop:
    """A crop: its upper left corner in shares of the picture's width and height, and its magnification."""

    x: float
    y: float
    zoom: float


@dataclass
class Slider:
    """Compares two of several pictures, whole or cropped, by a border that can be moved.

    Markdown shows all pictures in rows.
    """

    groups: dict[str, dict[str, str]]  # heading -> label -> file
    caption: str
    shown: tuple[str, str]
    crops: list[Crop] = field(default_factory=list)
    legend: str = ""  # file of the color scale

    def as_markdown(self) -> str:
        rows = [
            Table(list(files), [[f"![{label}]({file})" for label, file in files.items()]])
            for files in self.groups.values()
        ]
        legend = [f"![color scale]({self.legend})"] if self.legend else []
        return "\n\n".join([self.caption, *(row.as_markdown() for row in rows), *legend])

    def as_html(self) -> str:
        left, right = (next(files[label] for files in self.groups.values() if label in files) for label in self.shown)
        legend = f'<img class="legend" src="{self.legend}" alt="color scale">' if self.legend else ""
        return (
            f'<figure class="slider"><div class="choices">'
            f"{self._choice(self.shown[0])}{self._crops()}{self._choice(self.shown[1])}</div>"
            f'<div class="pair"><span><img src="{right}" alt="right"></span>'
            f'<span class="over"><img src="{left}" alt="left"></span>'
            f'<span class="border"></span>'
            f'<input type="range" min="0" max="1000" value="500" aria-label="border between the pictures"></div>'
            f"{legend}<figcaption>{inline(self.caption)}</figcaption></figure>"
        )

    def _choice(self, chosen: str) -> str:
        def option(label: str, file: str) -> str:
            return f'<option value="{file}"{" selected" if label == chosen else ""}>{html.escape(label)}</option>'

        groups = (
            f'<optgroup label="{html.escape(heading)}">{"".join(option(*item) for item in files.items())}</optgroup>'
            for heading, files in self.groups.items()
        )
        return f'<select class="picture">{"".join(groups)}</select>'

    def _crops(self) -> str:
        views = {"whole": Crop(0.0, 0.0, 1.0)} | {f"crop {i}": crop for i, crop in enumerate(self.crops, 1)}
        options = (
            f'<option value="scale({crop.zoom:g}) translate({-100 * crop.x:g}%, {-100 * crop.y:g}%)">{name}</option>'
            for name, crop in views.items()
        )
        return f'<select class="view">{"".join(options)}</select>'


@dataclass
class HtmlOnly:
    """A block that is left out of the Markdown form because it is long."""

    block: Text | Table | Figure | Slider

    def as_markdown(self) -> str:
        return ""

    def as_html(self) -> str:
        return self.block.as_html()


Block = Text | Table | Figure | Slider | HtmlOnly


def to_markdown(blocks: list[Block]) -> str:
    return "\n\n".join(text for block in blocks if (text := block.as_markdown())) + "\n"


def to_html(title: str, blocks: list[Block], style: str, script: str) -> str:
    body = "\n".join(block.as_html() for block in blocks)
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta name="viewport" content="width=device-width">'
        f"<title>{html.escape(title)}</title>\n<style>\n{style}</style></head>\n"
        f"<body>\n{body}\n<script>\n{script}</script>\n</body></html>\n"
    )


def inline(text: str) -> str:
    """Converts code, bold and italic text, pictures and links from Markdown to HTML."""
    text = html.escape(text, quote=False)
    text = re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
    text = re.sub(r"\*\*([^*]+)\*\*", r"<b>\1</b>", text)
    text = re.sub(r"(?<!\w)\*([^*]+)\*", r"<i>\1</i>", text)
    text = re.sub(r"!\[([^\]]+)\]\(([^)]+)\)", r'<img src="\2" alt="\1">', text)
    return re.sub(r"\[([^\]]+)\]\(([^)]+)\)", r'<a href="\2">\1</a>', text)


def _cell(text: str) -> str:
    """Returns a table cell. Numbers stay on one line, sentences wrap."""
    opening = '<td class="long">' if len(text) > LONG else "<td>"
    return f"{opening}{inline(text)}</td>"


def _block(text: str) -> str:
    lines = text.splitlines()
    if heading := re.match(r"(#+) (.*)", text):
        level = len(heading[1])
        name = re.sub(r"\W+", "-", heading[2].lower())
        rest = "\n".join(lines[1:])
        return f'<h{level} id="{name}">{inline(heading[2])}</h{level}>' + (_block(rest) if rest else "")
    if text.startswith("|"):
        cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
        return Table(cells[0], cells[2:]).as_html()
    if text.startswith("- "):
        items = re.split(r"\n- ", text[2:])
        return "<ul>" + "".join(f"<li>{inline(item)}</li>" for item in items) + "</ul>"
    return f"<p>{inline(text)}</p>"
