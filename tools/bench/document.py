"""A report as a list of blocks, written as Markdown and as one HTML page."""

from __future__ import annotations

import html
import re
from dataclasses import dataclass, field


def number(value: float | None, form: str = ".2f") -> str:
    return "–" if value is None else format(value, form)


def spread(values: tuple[float, float, float] | None, form: str = ".2f") -> str:
    """A median with its range."""
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
        body = "\n".join("<tr>" + "".join(f"<td>{inline(c)}</td>" for c in row) + "</tr>" for row in self.rows)
        return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>\n{body}\n</tbody></table></div>'


@dataclass
class Figure:
    file: str
    caption: str

    def as_markdown(self) -> str:
        return f"![{self.caption}]({self.file})"

    def as_html(self) -> str:
        return f'<figure><img src="{self.file}" alt="{html.escape(self.caption)}"><figcaption>{inline(self.caption)}</figcaption></figure>'


@dataclass
class Slider:
    """Two of several pictures, one over the other, with a border that can be moved. In Markdown: all of them in a row."""

    pictures: dict[str, str]  # label -> file
    caption: str
    shown: tuple[str, str]

    def as_markdown(self) -> str:
        row = [f"![{label}]({file})" for label, file in self.pictures.items()]
        return f"{self.caption}\n\n{Table(list(self.pictures), [row]).as_markdown()}"

    def as_html(self) -> str:
        def choice(chosen: str) -> str:
            options = "".join(
                f'<option value="{file}"{" selected" if label == chosen else ""}>{html.escape(label)}</option>'
                for label, file in self.pictures.items()
            )
            return f"<select>{options}</select>"

        left, right = (self.pictures[label] for label in self.shown)
        return (
            f'<figure class="slider"><div class="choices">{choice(self.shown[0])}{choice(self.shown[1])}</div>'
            f'<div class="pair"><img src="{right}" alt="right"><img class="over" src="{left}" alt="left"><span class="border"></span>'
            f'<input type="range" min="0" max="1000" value="500" aria-label="border between the pictures"></div>'
            f"<figcaption>{inline(self.caption)}</figcaption></figure>"
        )


@dataclass
class HtmlOnly:
    """What is too long for the text form."""

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
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
        f"<title>{html.escape(title)}</title>\n<style>\n{style}</style></head>\n<body>\n{body}\n<script>\n{script}</script>\n</body></html>\n"
    )


def inline(text: str) -> str:
    """Bold, code, links and emphasis of Markdown."""
    text = html.escape(text, quote=False)
    text = re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
    text = re.sub(r"\*\*([^*]+)\*\*", r"<b>\1</b>", text)
    text = re.sub(r"(?<!\w)\*([^*]+)\*", r"<i>\1</i>", text)
    return re.sub(r"\[([^\]]+)\]\(([^)]+)\)", r'<a href="\2">\1</a>', text)


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
