"""What reading and checking a spoilt file may do: give a scenario, or an error with key and remedy, within seconds."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from ropewalk.cli import console
from ropewalk.cli.deadline import Overdue, deadline
from ropewalk.effort import foreseen
from ropewalk.errors import Problem, RopewalkError, ScenarioError
from ropewalk.external.models import check_external
from ropewalk.model import Scenario
from ropewalk.scenario import loads
from ropewalk.sweeps.plan import Plan

PATIENCE, MEMORY = 10, 2 << 30  # s of the processor's time, and bytes
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


def checked(text: str) -> Scenario:
    """Do what the command `check` does: read a scenario, look at its files, its sweep and how its run would begin."""
    scenario = loads(text, "mutant.yaml")
    check_external(scenario.loads)
    if scenario.sweep is not None:
        Plan.of(scenario, scenario.sweep, console.CHECKED)
    with suppress(Overdue), deadline(console.PATIENCE):
        foreseen(scenario)
    return scenario


def outcome(text: str, file: str = "mutant.yaml", read: Callable[[str], object] | None = None) -> str:
    """READ, REFUSED, or a sentence that says what is wrong with how it was read.

    Args:
        text: of a scenario.
        file: its name, which errors must give.
        read: what is done with the text, as `checked`, whose errors may come without file and key.
    """
    try:
        with within(PATIENCE):
            read(text) if read else loads(text, file)
    except RopewalkError as error:
        if read is not None:
            return REFUSED if str(error).strip() else f"an error without words: {error!r}"
        if not isinstance(error, ScenarioError):
            return f"{type(error).__name__}: {error}"
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
