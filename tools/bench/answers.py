"""Answers of a worker to the process that started it: lines of JSON on standard output, where nothing else is written."""

from __future__ import annotations

import json
import os


class Answers:
    """Takes standard output for itself. What libraries print (progress bars without line ends, too) goes to standard error."""

    def __init__(self) -> None:
        self._file = os.fdopen(os.dup(1), "w")
        os.dup2(2, 1)

    def send(self, answer: dict) -> None:
        print("RESULT " + json.dumps(answer), file=self._file, flush=True)
