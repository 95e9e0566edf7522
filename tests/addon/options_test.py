"""Options after `--` on the command line."""

from __future__ import annotations

import sys

import pytest
from gradus import options
from gradus.abi import ComponentPass, Pass
from gradus.options import OptionError, parse


def test_both_spellings() -> None:
    assert parse(["--gradus-samples", "16"]).native == (("samples", "16"),)
    assert parse(["--gradus-noise-threshold=0.5"]).native == (("noise_threshold", "0.5"),)


def test_host_options() -> None:
    parsed = parse(
        [
            "--gradus-stats",
            "a.jsonl",
            "--gradus-save-scene=x.gradus",
            "--gradus-threads",
            "2",
            "--gradus-window-size",
            "7",
        ]
    )
    assert (parsed.stats, parsed.save_scene, parsed.threads) == ("a.jsonl", "x.gradus", 2)
    assert parsed.host == {"window_size": 7}
    assert parsed.native == ()


def test_values_with_an_equals_sign() -> None:
    assert parse(["--gradus-stats=a=b"]).stats == "a=b"


def test_a_negative_value_is_a_value() -> None:
    assert parse(["--gradus-seed", "-1"]).native == (("seed", "-1"),)


def test_options_of_others_are_ignored() -> None:
    assert parse(["--cycles-device", "CPU", "samples", "-x"]) == options.Overrides()


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["--gradus-sampels", "1"], "--gradus-sampels"),
        (["--gradus-samples"], "needs a value"),
        (["--gradus-samples", "--gradus-seed", "1"], "needs a value"),
        (["--gradus-threads", "many"], "many"),
        (["--gradus-threads", "-1"], "outside"),
        (["--gradus-passes", "depth,deph"], "deph"),
        (["--gradus-passes", "count"], "count"),
        (["--gradus-width", "5"], "--gradus-width"),
        (["--gradus-preview-samples", "5"], "unknown option --gradus-preview-samples"),
    ],
)
def test_unknown_ones_are_named(arguments: list[str], part: str) -> None:
    with pytest.raises(OptionError, match=part):
        parse(arguments)


def test_passes() -> None:
    assert parse(["--gradus-passes", "depth, noisy-image,GRADIENTS"]).passes.planes == {
        Pass.DEPTH,
        Pass.NOISY_IMAGE,
        Pass.GRADIENT_X,
        Pass.GRADIENT_Y,
        Pass.GRADIENT_T,
        Pass.GRADIENT_T_CORRESPONDENCE,
    }


def test_passes_of_components() -> None:
    """Planes of the image and of components are both numbered from 0: Combined and Color must not be confused."""
    wanted = parse(["--gradus-passes", "component-color,combined,component_motion"]).passes
    assert wanted.planes == {Pass.COMBINED}
    assert sorted(plane.name for plane in wanted.component_planes) == ["COLOR", "MOTION"]
    assert len(parse(["--gradus-passes", "components"]).passes.component_planes) == ComponentPass.PASS_COUNT
    assert parse(["--gradus-passes", "all"]).passes.component_planes == frozenset()


def test_text_keeps_its_case_and_switches_take_what_the_library_takes() -> None:
    parsed = parse(["--gradus-components", "A=ED-L", "--gradus-use-decomposition", "On", "--gradus-strict", "maybe"])
    assert parsed.text("components") == "A=ED-L"
    assert (parsed.switch("use_decomposition"), parsed.switch("strict"), parsed.switch("use_temporal")) == (
        True,
        None,
        None,
    )


def test_the_last_value_counts() -> None:
    parsed = parse(["--gradus-integrator", "path", "--gradus-integrator", "GRADIENT"])
    assert parsed.value("integrator") == "gradient"
    assert parsed.value("reconstruction") is None


def test_current_reads_after_the_dashes_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["blender", "--gradus-nonsense", "1", "--", "--gradus-samples", "3"])
    assert options.current().native == (("samples", "3"),)
    monkeypatch.setattr(sys, "argv", ["blender", "--gradus-nonsense", "1"])
    assert options.current() == options.Overrides()
