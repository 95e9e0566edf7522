"""`make render` reports mistakes in its variables before it sets up or builds anything."""

from __future__ import annotations

import os
import runpy
import subprocess

import pytest
from support.application import ROOT

MISTAKES = {
    "SCENE": ("/nope.blend", "no such file"),
    "FRAMES": ("3-1", "ends before it starts"),
    "OUT": ("/proc/nope", "OUT=/proc/nope"),
    "ARGS": ("--gradus-samples '4", "No closing quotation"),
    "COMPONENTS": ("A=E(", "COMPONENTS: component A: a ')' is missing at the end of 'E('"),
}


@pytest.mark.parametrize("name", list(MISTAKES))
def test_a_mistake_is_reported_before_anything_is_built(name: str) -> None:
    value, message = MISTAKES[name]
    refused(name, value, message)
    refused(name, value, message, "--animation")


def test_negative_frames_are_refused() -> None:
    """Regression: Blender counts negative frames from the ends of the range: -3 to -1 were rendered as -2 to 23."""
    refused("FRAMES", "-3--1", "numbers from 0 on")
    refused("FRAMES", "-3--1", "numbers from 0 on", "--animation")


def test_an_animation_is_one_range() -> None:
    refused("FRAMES", "1-3,7", "expected one range", "--animation")


def test_unknown_options_are_refused_before_the_build() -> None:
    refused("ARGS", "--gradus-sampels 4", "unknown option --gradus-sampels")


def test_components_that_overlap_are_refused_before_a_further_build() -> None:
    """The library that the tests use finds the overlap. Without one, the render itself refuses it after the build."""
    refused("COMPONENTS", "A=EL;B=EL", "COMPONENTS: components A and B overlap: both match EL")


def test_a_folder_is_no_scene() -> None:
    refused("SCENE", str(ROOT / "docs"), "this is a folder")


def test_a_blender_that_is_no_program_is_refused() -> None:
    refused("BLENDER", "/nope", "BLENDER=/nope: no such program")
    refused("BLENDER", str(ROOT / "docs"), "no such program", "--animation")


def test_make_passes_quotes_of_names_on() -> None:
    """Regression: an apostrophe in the name of a scene ended a quotation in the shell of make."""
    command = ["make", "--no-print-directory", "-C", str(ROOT), "render", "SCENE=/nope/it's \"new\".blend"]
    result = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert result.returncode != 0
    assert "SCENE=/nope/it's \"new\".blend: no such file" in result.stderr


def refused(name: str, value: str, message: str, *options: str) -> None:
    environment = {k: v for k, v in os.environ.items() if k not in MISTAKES} | {"BLENDER": "/nope"} | {name: value}
    command = ["bash", str(ROOT / "tools" / "render.sh"), *options]
    result = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=False)
    assert result.returncode == 1
    assert message in result.stderr
    assert result.stdout == ""


@pytest.mark.parametrize(
    ("text", "options"),
    [
        ("", []),
        ("Default", ["--gradus-use-decomposition", "1", "--gradus-components=", "--gradus-passes", "components"]),
        (
            "A=ED(T|R)*L;B=EL",
            [
                "--gradus-use-decomposition",
                "1",
                "--gradus-components=A=ED(T|R)*L;B=EL",
                "--gradus-passes",
                "components",
            ],
        ),
    ],
)
def test_components_are_requested_with_all_of_their_passes(
    monkeypatch: pytest.MonkeyPatch, text: str, options: list[str]
) -> None:
    monkeypatch.setenv("COMPONENTS", text)
    monkeypatch.setenv("ARGS", "--gradus-samples 4")
    monkeypatch.setenv("OUT", "/tmp")
    monkeypatch.chdir(ROOT)
    wanted = runpy.run_path(str(ROOT / "tools" / "render.py"))["request"]()
    assert wanted.arguments == [*options, "--gradus-samples", "4"]
