"""Tests whether a job of many steps, in a Blender process of its own, leaks memory.

Blender's allocator (jemalloc) counts the allocated bytes, which are the same within 0.3 MB. Resident memory is less
precise: every render has a thread of its own, the threads use different arenas of jemalloc, and jemalloc keeps pages of
each arena for some seconds. It varies by 5 MB on a quiet machine, by 30 MB on a busy one, and by 0.4 MB with one arena.
It still shows memory that is mapped without the allocator. So its minimum in the last quarter of the steps may exceed
that in the second quarter by this amount only.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from .application import Outcome

# Prints a line after each step: MEMORY step, bytes allocated, bytes resident, threads, descriptors, temporary files.
COUNT = """
import bpy, ctypes, os
from pathlib import Path
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 36, 100
scene.gradus.samples = SAMPLES
page = os.sysconf("SC_PAGESIZE")

jemalloc = ctypes.CDLL(None)

def allocated():
    # By the statistics as of now.
    epoch, value, size = ctypes.c_uint64(1), ctypes.c_size_t(), ctypes.c_size_t(8)
    assert jemalloc.mallctl(b"epoch", None, None, ctypes.byref(epoch), size) == 0
    assert jemalloc.mallctl(b"stats.allocated", ctypes.byref(value), ctypes.byref(size), None, 0) == 0
    return value.value

def count(step):
    resident = int(Path("/proc/self/statm").read_text().split()[1]) * page
    things = [len(os.listdir(folder)) for folder in ("/proc/self/task", "/proc/self/fd", os.environ["TMPDIR"])]
    print("MEMORY", step, allocated(), resident, *things, flush=True)
"""
MEGABYTE = 1 << 20
GROWTH, SWING = 1 * MEGABYTE, 48 * MEGABYTE
SAMPLES = pytest.mark.parametrize("samples", [1, 2], ids=["frame by frame", "over windows"])


def check_memory(
    blender: Callable[..., Outcome], folder: Path, script: str, steps: int, samples: int, *arguments: str
) -> None:
    """Requires that memory does not grow in a job of so many steps, after the first quarter of them."""
    temporary = folder / "temporary"
    temporary.mkdir()
    script = (COUNT + script).replace("SAMPLES", str(samples)).replace("FRAMES", str(steps))
    head = [
        "--addons",
        "gradus",
        "-E",
        "GRADUS",
        "--python-exit-code",
        "3",
        "--python-expr",
        script,
        "-o",
        f"{folder}/f_####",
        "-F",
        "PNG",
    ]
    outcome = blender(*head, *arguments, limit=1800, env={"TMPDIR": str(temporary)})
    assert outcome.code == 0, outcome.output
    lines = [line.split()[1:] for line in outcome.output.splitlines() if line.startswith("MEMORY ")]
    found = {int(step): tuple(map(int, counts)) for step, *counts in lines}
    assert len(found) == steps
    warm_up = steps // 4
    for what, limit in ((0, GROWTH), (1, SWING)):
        before = min(found[step][what] for step in range(warm_up, steps // 2))
        after = min(found[step][what] for step in range(steps - warm_up, steps + 1))
        assert after - before <= limit, f"{(after - before) / MEGABYTE:.1f} MB in {steps // 2} steps"
    for what in (2, 3, 4):  # threads, descriptors, temporary files
        late, early = (
            [found[step][what] for step in range(first, first + warm_up)] for first in (steps - warm_up, warm_up)
        )
        assert max(late) <= max(early)
    assert not list(temporary.glob("gradus*")), "and none of ours in the end"
