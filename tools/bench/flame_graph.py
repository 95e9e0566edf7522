"""Call stacks of a profile, their shares, and a picture of them: a flame graph (Gregg 2016, "The Flame Graph")."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache
from html import escape

Stacks = Counter[tuple[str, ...]]  # number of samples by the functions of a stack, callers first

WIDTH, ROW = 1200.0, 17.0  # of the picture and of a function, in pixels
NARROWEST = 0.5  # functions that are narrower are left out
NOISE = re.compile(r"gradus::|\(anonymous namespace\)::|\[clone [^]]*\]")


def parse(lines: Iterable[str], root: str) -> Stacks:
    """Reads what `perf script -F ip,sym` prints. Returns the stacks that contain a function whose name has `root` in
    it, from that function on.
    """
    stacks: Stacks = Counter()
    for stack in _stacks(lines):
        begin = next((i for i, name in enumerate(stack) if root in name), None)
        if begin is not None:
            stacks[tuple(reversed(stack[: begin + 1]))] += 1
    return stacks


def cut_share(lines: Iterable[str], root: str, inside: str) -> float:
    """Reads the same, and only the stacks whose innermost function has `inside` in its name. Returns the share of them
    that lack `root`, because perf copied too little of the stack or could not unwind it.
    """
    found = [any(root in name for name in stack) for stack in _stacks(lines) if stack and inside in stack[0]]
    return 1.0 - sum(found) / len(found) if found else 0.0


def _stacks(lines: Iterable[str]) -> Iterator[list[str]]:
    """Returns the names of each stack, callees first. A stack is one line for each function, and an empty line."""
    stack: list[str] = []
    for line in (*lines, ""):
        if line.strip():
            _, _, name = line.strip().partition(" ")
            stack.append(short(name or "unknown"))
            continue
        yield stack
        stack = []


@cache  # a profile repeats few names
def short(name: str) -> str:
    """Returns a function's name without its parameters and without what all names have in common."""
    name = NOISE.sub("", name)
    depth, end = 0, len(name)
    for i, letter in enumerate(name):
        depth += (letter == "<") - (letter == ">")
        if letter == "(" and depth == 0 and i > 0:
            end = i
            break
    return name[:end].strip()


def share_of_library(stacks: Stacks, prefixes: tuple[str, ...]) -> float:
    """Returns the share of the samples that were taken inside functions whose names begin with one of `prefixes`."""
    inside = sum(count for stack, count in stacks.items() if any(name.startswith(prefixes) for name in stack))
    return inside / max(stacks.total(), 1)


def svg(stacks: Stacks, title: str) -> str:
    """Draws the stacks: the width of a function is its share of the samples, and its callees lie on top of it."""
    boxes: list[str] = []
    depths = max((len(stack) for stack in stacks), default=0)
    height = (depths + 2) * ROW
    scale = WIDTH / max(stacks.total(), 1)

    def draw(part: Stacks, left: float, depth: int) -> None:
        below: dict[str, Stacks] = {}
        for stack, count in part.items():
            if stack:
                below.setdefault(stack[0], Counter())[stack[1:]] += count
        for name, callees in sorted(below.items()):
            width = callees.total() * scale
            if width >= NARROWEST:
                boxes.append(box(name, left, height - (depth + 1) * ROW, width, callees.total() / stacks.total()))
                draw(callees, left, depth + 1)
            left += width

    draw(stacks, 0.0, 0)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {height:g}" font-family="monospace">'
    label = f'<text x="4" y="{ROW - 4:g}" font-size="12">{escape(title)}</text>'
    return "\n".join((head, label, *boxes, "</svg>", ""))


def box(name: str, x: float, y: float, width: float, share: float) -> str:
    """Draws a function, with its name as far as it fits, and with its share in the tooltip."""
    color = "#e8b878" if name.startswith("embree") else "#d8d8e8"
    text = escape(name[: int(width / 6.2)]) if width > 20 else ""
    return (
        f"<g><title>{escape(name)}: {100 * share:.1f} %</title>"
        f'<rect x="{x:.2f}" y="{y:g}" width="{width:.2f}" height="{ROW - 1:g}" fill="{color}"/>'
        f'<text x="{x + 2:.2f}" y="{y + ROW - 5:g}" font-size="10">{text}</text></g>'
    )
