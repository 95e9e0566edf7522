"""What the parts of the benchmark share: the loop over scenes, and the checks of their arguments."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Collection
from typing import Any

from renderers import RefusedError
from version import version_of_build

BenchOne = Callable[[Any, argparse.Namespace, str, float], None]


def bench_each(scenes: list[Any], bench_one: BenchOne, arguments: argparse.Namespace) -> None:
    """Calls bench_one(scene, arguments, version, deadline) for each scene until the time is up.

    One that fails does not end the others.
    """
    version, deadline = version_of_build(), time.monotonic() + 60.0 * arguments.minutes
    for scene in scenes:
        try:
            bench_one(scene, arguments, version, deadline)
        except (RuntimeError, RefusedError) as error:
            print(f"FAILED {scene.name}: {error}", flush=True)
        if time.monotonic() > deadline:
            print("time is up; run again to go on")
            break


def works(renderer: Any, mode: str, scene: str) -> bool:
    """Returns whether a mode works in a scene, and prints why if not. The renderer tells it by refusal(mode)."""
    if why := renderer.refusal(mode):
        print(f"SKIP {mode} in {scene}: {why}", flush=True)
    return not why


def names_of(known: Collection[str]) -> Callable[[str], list[str]]:
    """Returns a converter of the argument 'a,b' that refuses names that are not known."""

    def convert(text: str) -> list[str]:
        if unknown := set(text.split(",")) - set(known):
            raise argparse.ArgumentTypeError(f"unknown: {', '.join(sorted(unknown))}; there are {', '.join(known)}")
        return text.split(",")

    return convert


def powers_of_two(text: str) -> list[int]:
    """Converts sample counts ('4,16'). The sample sequences are stratified for powers of two."""
    counts = [int(part) for part in text.split(",")]
    if any(count < 1 or count & (count - 1) for count in counts):
        raise argparse.ArgumentTypeError("sample counts must be powers of two")
    return counts


def parser_of(description: str | None) -> argparse.ArgumentParser:
    """Returns a parser with the arguments that limit every part."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default="", help="names, 'a,b'; all by default")
    parser.add_argument("--minutes", type=float, default=600.0, help="time limit")
    return parser
