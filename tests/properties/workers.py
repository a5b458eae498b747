"""Processes that examine scenarios, each with a time limit for a pair."""

from __future__ import annotations

import multiprocessing
import signal
import time
from multiprocessing.connection import Connection

from .compare import Difference
from .known import known
from .pairs import Verdict, kind_of, scenario_of, verdicts

LIMIT, PATIENCE = 120.0, 1200.0
"""Seconds of CPU for a pair, at whose end SIGPROF kills the worker, and of waiting; compiling counts."""


def _work(connection: Connection) -> None:
    """Answer scenarios, (seed, number), by the verdicts on their pairs, and at last by None."""
    while (task := connection.recv()) is not None:
        for pair, verdict in verdicts(*task):
            signal.setitimer(signal.ITIMER_PROF, LIMIT)
            connection.send((pair, verdict, time.process_time()))
        connection.send(None)


class Worker:
    """A process that examines one scenario after the other, started again where a pair takes too long or kills it."""

    def __init__(self) -> None:
        self.cpu = self._before = 0.0
        self._begin()

    def _begin(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, there = context.Pipe()
        self._process = context.Process(target=_work, args=(there,), daemon=True)
        self._process.start()
        there.close()
        self.pair, self.since = "", time.monotonic()

    @property
    def is_late(self) -> bool:
        """Whether it takes too long over a pair."""
        return time.monotonic() - self.since > PATIENCE

    def give(self, task: tuple[int, int] | None) -> None:
        """Give it a scenario, or let it end."""
        self.connection.send(task)
        self.pair, self.since = f"{task[0]}-{task[1]} drawing" if task else "", time.monotonic()

    def take(self) -> tuple[bool, Verdict | None]:
        """Return whether it is free again, and a verdict if there is one."""
        try:
            message = self.connection.recv()
        except (EOFError, ConnectionError):
            self._process.join()
            late = self._process.exitcode == -signal.SIGPROF
            return True, self._failed(f"no answer within {LIMIT:g} s of CPU" if late else "the process died")
        if message is None:
            return True, None
        self.pair, verdict, cpu = message
        self.since, self.cpu = time.monotonic(), self._before + cpu
        return False, verdict

    def give_up(self) -> Verdict:
        """End a pair that takes too long."""
        return self._failed(f"no answer within {PATIENCE:g} s")

    def _failed(self, why: str) -> Verdict:
        self._process.kill()
        self._process.join()
        pair, self._before = self.pair, self.cpu
        self._begin()
        tree, relation, found = scenario_of(pair), pair.partition(" ")[2], Difference(float("inf"), why)
        return Verdict(pair, relation, kind_of(tree), found.size, why, known(tree, relation, found), LIMIT)
