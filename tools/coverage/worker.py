"""Renders rows inside a Blender: `blender -b --python worker.py -- …`, or a Python that has bpy.

    worker.py -- PATTERN DONE

PATTERN chooses rows by name, as in a shell; DONE is a file with the names of rows that are left out, one in a line. The
answers are lines of JSON on standard output, each prefixed by RESULT: {"begin": name} before a row, its outcome after
it, and {"end": true} after the last one, so that the process that started this one knows which row ended it.
"""

from __future__ import annotations

import os
import sys
import tempfile
from fnmatch import fnmatch
from pathlib import Path

import bpy  # noqa: F401  (before anything that could load other libraries of the same names)

ROOT = Path(__file__).resolve().parents[2]
ARGUMENTS = sys.argv[sys.argv.index("--") + 1 :]
sys.argv = sys.argv[:1]  # the add-on reads options after "--", and these are not its own
sys.path[:0] = [str(ROOT / name) for name in ("tools", "tools/bench", "tests", "addon")]


def main() -> None:
    import gradus
    from worker_process import Answers

    from coverage.families import all_rows
    from coverage.trial import Judge

    answers = Answers()
    gradus.register()
    pattern, done = ARGUMENTS[0], set(Path(ARGUMENTS[1]).read_text().splitlines())
    rows = [row for row in all_rows() if fnmatch(row.name, pattern) and row.name not in done]
    answers.send({"rows": len(rows)})
    with tempfile.TemporaryDirectory() as folder:
        judge = Judge(Path(folder))
        for row in rows:
            answers.send({"begin": row.name, "family": row.family})
            answers.send(judge.run(row).as_dict())
    answers.send({"end": True})


try:
    main()
finally:
    sys.stderr.flush()
    os._exit(0)  # the module can hang at exit
