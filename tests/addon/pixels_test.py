"""The upload buffer: layout, order, reuse and sizes."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from gradus import passes, pixels
from gradus.abi import Pass


class Collection(list):
    """Stands in for Blender's collection of passes."""

    received: object = None

    def foreach_set(self, name: str, values: object) -> None:
        assert name == "rect"
        self.received = values


def layer(*names_and_channels: tuple[str, int]) -> SimpleNamespace:
    return SimpleNamespace(
        passes=Collection(SimpleNamespace(name=name, channels=channels) for name, channels in names_and_channels)
    )


INFOS = passes.by_name(passes.TABLE, (4, 5, 0))


def read(plane: int, target: object, count: int) -> None:
    for index in range(count):
        target[index] = plane + index / 1000.0


def test_passes_lie_in_blender_s_order() -> None:
    found = layer(("Depth", 1), ("Combined", 4), ("Foreign", 3), ("Normal", 3))
    buffer = pixels.PassBuffer()
    buffer.prepare(found.passes, INFOS, 2, 1)
    buffer.fill(read)
    buffer.upload(found)
    values = list(found.passes.received)
    assert len(values) == 2 * (1 + 4 + 3 + 3)
    assert values[0:2] == pytest.approx([Pass.DEPTH, Pass.DEPTH + 0.001])
    assert values[2] == Pass.COMBINED
    assert values[10:16] == [0.0] * 6
    assert values[16] == Pass.NORMAL


def test_refresh_writes_only_what_is_asked() -> None:
    found = layer(("Combined", 4), ("Depth", 1))
    buffer = pixels.PassBuffer()
    buffer.prepare(found.passes, INFOS, 1, 1)
    buffer.fill(read, frozenset((Pass.DEPTH,)))
    buffer.upload(found)
    assert list(found.passes.received) == [0.0, 0.0, 0.0, 0.0, Pass.DEPTH]


def test_memory_is_reused() -> None:
    found = layer(("Combined", 4))
    buffer = pixels.PassBuffer()
    buffer.prepare(found.passes, INFOS, 8, 8)
    first = buffer._values
    buffer.prepare(found.passes, INFOS, 8, 8)
    assert buffer._values is first
    assert len(buffer) == 256


def test_another_layer_is_refused() -> None:
    buffer = pixels.PassBuffer()
    buffer.prepare(layer(("Combined", 4)).passes, INFOS, 1, 1)
    with pytest.raises(ValueError, match="2 passes"):
        buffer.upload(layer(("Combined", 4), ("Depth", 1)))


def test_a_pass_of_other_channels_stays_empty() -> None:
    found = layer(("Depth", 3))
    buffer = pixels.PassBuffer()
    buffer.prepare(found.passes, INFOS, 1, 1)
    buffer.fill(read)
    buffer.upload(found)
    assert list(found.passes.received) == [0.0, 0.0, 0.0]


def test_a_buffer_fits_results_of_its_size_and_passes_alone() -> None:
    """Regression: after Escape, a frame with other passes than the one before raised, and its result stayed open."""

    def result(width: int, height: int, *names_and_channels: tuple[str, int]) -> SimpleNamespace:
        layers = [layer(*names_and_channels)]
        return SimpleNamespace(resolution_x=width, resolution_y=height, layers=layers)

    buffer = pixels.PassBuffer()
    same = result(2, 1, ("Combined", 4), ("Depth", 1))
    assert not buffer.fits(same)
    buffer.prepare(same.layers[0].passes, INFOS, 2, 1)
    assert buffer.fits(same)
    assert not buffer.fits(result(1, 2, ("Combined", 4), ("Depth", 1)))
    assert not buffer.fits(result(2, 1, ("Combined", 4)))
    assert not buffer.fits(result(2, 1, ("Combined", 4), ("Mist", 1)))
