"""Flame graphs of the benchmark, and the shares of a profile."""

from __future__ import annotations

import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools" / "bench"))
import flame_graph  # noqa: E402

# Two stacks inside a tile, one of them in Embree, and one of the start of the program.
LISTING = """
    4a10 embree::avx2::BVHNIntersector1<8, 1>::intersect(embree::Intersectors const*, RTCRayHit&)
    4a20 gradus::path::(anonymous namespace)::trace(std::vector<int> const&) [clone .isra.0]
    4a30 gradus::render::TileSampler::sample_tile(unsigned long)
    4a40 main

    4a50 gradus::path::shade<float>(int)
    4a30 gradus::render::TileSampler::sample_tile(unsigned long)
    4a40 main

    4a60 main
"""
TILE = "render::TileSampler::sample_tile"
STACKS = {
    (TILE, "path::trace", "embree::avx2::BVHNIntersector1<8, 1>::intersect"): 1,
    (TILE, "path::shade<float>"): 1,
}


def test_stacks_begin_at_the_root() -> None:
    assert flame_graph.parse(LISTING.splitlines(), "TileSampler::sample_tile") == STACKS


def test_shares_count_callees_of_a_library() -> None:
    stacks = flame_graph.parse(LISTING.splitlines(), "TileSampler::sample_tile")
    assert flame_graph.share_of_library(stacks, ("embree::",)) == pytest.approx(0.5)
    assert flame_graph.share_of_library(flame_graph.Stacks(), ("embree::",)) == 0.0


def test_widths_are_shares() -> None:
    picture = ElementTree.fromstring(flame_graph.svg(flame_graph.Stacks(STACKS), "a < b"))
    space = "{http://www.w3.org/2000/svg}"
    widths = {
        group.find(f"{space}title").text: float(group.find(f"{space}rect").get("width"))
        for group in picture.iter(f"{space}g")
    }
    assert widths[f"{TILE}: 100.0 %"] == flame_graph.WIDTH
    assert widths["path::shade<float>: 50.0 %"] == flame_graph.WIDTH / 2
    assert len(widths) == 4


def test_stacks_that_were_cut_off_are_counted() -> None:
    whole = ["1 embree::avx2::BVHNIntersector1::intersect", "2 TileSampler::sample_tile", "3 main", ""]
    cut = ["1 embree::avx2::BVHNIntersector1::intersect", "2 embree::AccelN::intersect", ""]
    other = ["1 malloc", "2 main", ""]
    assert flame_graph.cut_share(whole * 3 + cut + other, "sample_tile", "Intersector") == 0.25
    assert flame_graph.cut_share(other, "sample_tile", "Intersector") == 0.0
