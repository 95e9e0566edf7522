"""Runs pytest inside a host: `blender -b --python run_in_host.py -- ARGS`, or the Python of an environment that has bpy.

Ends the process itself and at once: the 4.5 module can hang at exit, and Blender's own exit code says nothing of tests. The marker line
shows that the end was reached.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy  # noqa: F401  (before anything that could load another TBB or Imath)
import pytest

TESTS = Path(__file__).resolve().parent


def main() -> None:
    arguments = sys.argv[sys.argv.index("--") + 1 :]
    sys.argv = [sys.argv[0]]  # the add-on reads options after "--", and these are not its own
    sys.path[:0] = [str(TESTS), str(TESTS.parent / "addon")]
    code = 2
    try:
        code = int(pytest.main([f"--rootdir={TESTS.parent}", "-c", str(TESTS / "pytest.ini"), *arguments]))
    finally:
        print(f"\nGRADUS-TESTS-FINISHED {code}", flush=True)
        sys.stderr.flush()
        os._exit(code)


main()
