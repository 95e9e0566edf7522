"""Runs queues of jobs (lanes), two jobs at a time by default.

A worker keeps the process of a host while it runs the jobs of the host's lane.
"""

from __future__ import annotations

import threading
import time
from collections import deque

from .checks import Check
from .hosts import HOSTS, HostProcess, TestFile
from .programs import Program
from .results import Report, Result

Job = TestFile | Program | Check


class Pool:
    """Workers that each stay with a lane until it is empty, and then take the longest one that is left."""

    def __init__(self, lanes: dict[str, list[Job]], report: Report, environment: dict[str, str]) -> None:
        self._lanes = {name: deque(jobs) for name, jobs in lanes.items() if jobs}
        self._taken: dict[str, int] = dict.fromkeys(self._lanes, 0)
        self._report, self._environment = report, environment
        self._lock = threading.Lock()

    def run(self, workers: int) -> None:
        threads = [threading.Thread(target=self._work) for _ in range(workers)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    def _work(self) -> None:
        while (lane := self._choose()) is not None:
            process = HostProcess(lane, self._environment) if lane in HOSTS else None
            while (job := self._next(lane)) is not None:
                self._report.add(self._timed(job, process))
            if process:
                process.close()
            with self._lock:
                self._taken[lane] -= 1

    def _choose(self) -> str | None:
        """Returns the first lane without a worker, else the lane with most jobs, or None if no jobs are left."""
        with self._lock:
            left = [name for name, jobs in self._lanes.items() if jobs]
            if not left:
                return None
            free = [name for name in left if not self._taken[name]]
            lane = free[0] if free else max(left, key=lambda name: len(self._lanes[name]))
            self._taken[lane] += 1
            return lane

    def _next(self, lane: str) -> Job | None:
        with self._lock:
            return self._lanes[lane].popleft() if self._lanes[lane] else None

    def _timed(self, job: Job, process: HostProcess | None) -> Result:
        start = time.monotonic()
        try:
            result = process.run(job) if process else job.run(self._environment)
        except Exception as error:  # an error of the runner itself counts as a failure
            result = Result(job.name, failed=1, notes=[f"{job.name}: {error!r}"])
        result.seconds = time.monotonic() - start
        return result
