"""What reading a spoilt file may do: give a scenario, or an error that says file, key and remedy, within seconds."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from ropewalk.errors import Problem, ScenarioError
from ropewalk.scenario import loads

PATIENCE = 10  # s of the processor's time
READ, REFUSED = "read", "refused"


class Hung(BaseException):
    """Reading took too long."""


@contextmanager
def within(seconds: int) -> Iterator[None]:
    """End what takes more of the processor's time; nothing is ended where the system has no such clock."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def end(_number: int, _frame: FrameType | None) -> None:
        raise Hung

    before = signal.signal(signal.SIGVTALRM, end)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def outcome(text: str, file: str = "mutant.yaml") -> str:
    """READ, REFUSED, or a sentence that says what is wrong with how it was read."""
    try:
        with within(PATIENCE):
            loads(text, file)
    except ScenarioError as error:
        poor = [lack for problem in error.problems if (lack := lacks(problem, file))]
        return poor[0] if poor else REFUSED
    except Hung:
        return f"not read within {PATIENCE} s"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return READ


def lacks(problem: Problem, file: str) -> str:
    """What a message does not say that it should; empty if nothing."""
    message = str(problem)
    if problem.file != file:
        return f"no file: {message}"
    if problem.line is None and not problem.key:
        return f"neither line nor key: {message}"
    if not problem.remedy and problem.key:
        return f"no remedy: {message}"
    return "" if message.isprintable() or message.replace("\n", "").isprintable() else f"not printable: {message!r}"
