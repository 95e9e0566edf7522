"""Folders of the benchmark.

Everything that it writes lies in `out/bench`, which git ignores, or in the user's cache folder.
"""

from __future__ import annotations

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
OUT = ROOT / "out" / "bench"  # the report and its figures
RESULTS = OUT / "results"  # raw results, one file for each part of the benchmark
PICTURES = "pictures"  # folder of pictures, relative to OUT
CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "gradus"
TOOL = ROOT / "build" / "native" / "gradus"
