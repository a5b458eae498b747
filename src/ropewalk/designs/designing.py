"""The design: values of a scenario with which a quantity is as small or as large as limits of others allow."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ropewalk.designs.certificate import BETTER, Neighbour, left_over
from ropewalk.designs.evaluation import Evaluation
from ropewalk.designs.limits import limits_of
from ropewalk.designs.result import Design
from ropewalk.designs.search import FEW, by_models, by_optuna, sobol
from ropewalk.designs.task import Task
from ropewalk.designs.variables import Space, variables_of
from ropewalk.errors import did_you_mean
from ropewalk.model import Scenario
from ropewalk.sweeps.parameters import refuse
from ropewalk.sweeps.store import Store

METHODS = ("models", "optuna")
REACHED = 1e-3  # of a limit, within which it counts as reached, or the tolerance if that is more


def design(
    scenario: Scenario,
    vary: Mapping[str, Any],
    *,
    minimise: str | None = None,
    maximise: str | None = None,
    subject_to: str | Sequence[str] = (),
    derived: Mapping[str, str] | None = None,
    method: str | None = None,
    tolerance: float = 1e-3,
    first: int | None = None,
    most: int | None = None,
    seed: int = 0,
    store: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    cluster: Any = None,
    progress: Callable[[int], None] | None = None,
) -> Design:
    """Find the values of some keys with which a quantity is as small or as large as may be.

    Some points all over the space are computed side by side, the best of them is where the search begins, and around
    what it finds a look is taken whether that is an optimum. Every run is a case of the store, which sweeps share: a
    design that was stopped continues where it was. Under `if __name__ == "__main__":`, as `sweep`.

    Args:
        scenario: what the designs are changes of.
        vary: what varies, bounds by key: {"lines.rope.tension": "5 kN:40 kN"}.
        minimise: the quantity, as `record` of a sweep has it, or one of the keys that vary.
        maximise: the same.
        subject_to: limits, "max strain < 2 %".
        derived: values that follow from others, by key, as in a sweep.
        method: "models" (COBYQA; default up to 8 variables) or "optuna".
        tolerance: to which the variables are found, as a part of the ways between their bounds.
        first: points all over the space that are looked at first (default: four, and four for each variable).
        most: runs (default: 50 for each variable).
        seed: of the first points and of Optuna.
        store: file of JSON lines for the finished cases.
        workers: processes for points that go together (default: one for each core).
        cluster: address of a Dask scheduler, or a client of one, for the same.
        progress: called with the number of runs so far.

    Raises:
        ScenarioError: bounds, limits, a key, an expression or a quantity cannot be.
        ResultError: the store is something else.
        RopewalkError: processes cannot begin, the cluster cannot be reached, or Optuna is missing.
    """
    if (minimise is None) == (maximise is None):
        refuse("minimise", "exactly one quantity must be minimised or maximised", "", "write minimise or maximise")
    variables_of(vary)
    limits = limits_of([subject_to] if isinstance(subject_to, str) else subject_to)
    method = method or ("models" if len(vary) <= FEW else "optuna")
    if method not in METHODS:
        refuse("method", "there is no such method", repr(method), did_you_mean(method, METHODS))
    if not 0.0 < tolerance < 0.5:
        refuse(
            "tolerance", "must be a fraction of the range of each variable", f"{tolerance:g}", "write for example 0.001"
        )
    objective = minimise if minimise is not None else maximise
    assert objective is not None
    record = list(dict.fromkeys([*([] if objective in vary else [objective]), *(limit.name for limit in limits)]))
    if not record:
        refuse("subject_to", "nothing is computed", objective, "give a limit, or another quantity")
    space = Space.of(scenario, vary, ("outcome", "doubts", "reason", "seconds", "case", *record))
    with Store(None if store is None else Path(store)) as kept:
        runs = Evaluation(scenario, space, derived or {}, record, kept, workers, cluster, progress)
        task = Task(runs, objective, -1.0 if maximise is not None else 1.0, limits)
        ended, neighbours = "completed", list[Neighbour]()
        count = 4 * (1 + len(vary)) if first is None else first
        try:
            points = [space.own, *sobol(count, len(vary), seed)]
            task.all(points)
            most = 50 * len(vary) if most is None else most
            if method == "optuna":
                best = task.best()
                by_optuna(task.all, space.own if best is None else best.point, len(limits), most, seed)
            elif (best := task.best() or task.nearest()) is not None:
                scale = abs(task.judge(best.point)[0]) or 1.0
                by_models(task.judge, best.point, scale, len(limits), tolerance, most)
            task.to_the_limit(0.1 * tolerance)
            neighbours = task.neighbours(2.0 * tolerance, 10.0 * tolerance)
        except KeyboardInterrupt:
            ended = "interrupted"
        return _result(task, ended, neighbours, max(REACHED, tolerance))


def _result(task: Task, ended: str, neighbours: list[Neighbour], reached: float) -> Design:
    """What is known at the end."""
    best = task.best()
    active = list[int]()
    rest = None
    if best is not None:
        value, excess = task.of(best)
        active = [k for k in range(len(task.limits)) if excess[k] > -reached]
        rest = left_over(best.point, value, excess, neighbours, active)
    elif ended == "completed":
        ended = "no design keeps the limits" if task.nearest() is not None else "no design has a value"
    if ended == "completed" and best is not None:
        if best.outcome.outcome != "completed":
            ended = "doubtful"
        elif any(n.verdict == BETTER for n in neighbours):
            ended = "not at an optimum"
    return Design(task, ended, best, tuple(neighbours), tuple(active), rest)
