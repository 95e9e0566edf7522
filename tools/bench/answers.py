"""Answers of a worker to the process that started it: lines of JSON on standard output."""

from __future__ import annotations

import json
import os
from typing import Any


class Answers:
    """Owns standard output. What libraries print, such as progress bars, goes to standard error instead."""

    def __init__(self) -> None:
        self._file = os.fdopen(os.dup(1), "w")
        os.dup2(2, 1)

    def send(self, answer: dict[str, Any]) -> None:
        print("RESULT " + json.dumps(answer), file=self._file, flush=True)
