"""The sweep: many runs, side by side, kept as they come, and answered as one dataset."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ropewalk.model import Scenario
from ropewalk.sweeps.case import LOST, Case, Outcome, check_record, computed
from ropewalk.sweeps.dataset import dataset_of
from ropewalk.sweeps.parameters import refuse
from ropewalk.sweeps.plan import Plan, asked
from ropewalk.sweeps.pool import DIED, cores, each
from ropewalk.sweeps.store import Store

if TYPE_CHECKING:
    import xarray as xr

Progress = Callable[[int, int], None]


def sweep(
    scenario: Scenario,
    over: Mapping[str, Any] | None = None,
    *,
    record: str | Sequence[str] | None = None,
    derived: Mapping[str, str] | None = None,
    combine: str | None = None,
    count: int | None = None,
    seed: int | None = None,
    store: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    cluster: Any = None,
    retry: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Run a scenario many times with other values, and answer with one dataset over the parameters.

    An omitted value is what the scenario's `sweep` says. A script must call this under `if __name__ == "__main__":`,
    as for all processes in Python. An interrupt (Ctrl-C) ends it with what there is.

    Args:
        scenario: what the cases are changes of.
        over: what varies: by keys such as "loads.train.travel.speed" a list of values or text, "100:350:5 km/h".
        record: quantities that are kept, as a list or with commas: "max tension, sigma pantographs.front".
        derived: values that follow from others, by key: {"run.until": "bridge.length / speed + 2 s"}.
        combine: grid (each value with each), zip, one_at_a_time, or count cases by latin_hypercube, sobol or random.
        count: of cases that are drawn.
        seed: of drawing.
        store: file of JSON lines for the finished cases; what is in it is not computed again.
        workers: processes (default: one for each core; 0: none but this one, whose last bits may be others).
        cluster: address of a Dask scheduler, or a client of one, instead of processes.
        retry: compute cases that have failed once more.
        progress: called with the number of finished cases and that of all.

    Returns:
        The quantities over a dimension for each parameter (of a grid), or over `case`; NaN where there are none. In
        `outcome` stands what became of each run, in `doubts` why it must not be trusted, in `reason` why it has no
        values. The attribute `outcome` is "completed" or "interrupted".

    Raises:
        ScenarioError: the values, a key, an expression or a quantity cannot be, or no case is a scenario.
        ResultError: the store is something else.
        RopewalkError: processes cannot begin, or the cluster cannot be reached.
    """
    if workers is not None and workers < 0:
        refuse("workers", "must not be negative", str(workers), "leave it out to use all cores")
    wish = asked(scenario, over, derived=derived, record=record, combine=combine, count=count, seed=seed)
    plan = Plan.of(scenario, wish)
    cases = {row.case.key: (row.case, row.settings) for row in plan.rows if row.case is not None}
    outcome = "completed"
    with Store(None if store is None else Path(store), retry) as kept:
        lost: dict[str, Outcome] = {}

        rows = Counter(row.case.key for row in plan.rows if row.case is not None)
        missing = [case for key, (case, _) in cases.items() if key not in kept.done]
        done = len(plan.rows) - sum(rows[case.key] for case in missing)

        def report(more: int = 0) -> None:
            nonlocal done
            done += more
            if progress is not None:
                progress(done, len(plan.rows))

        report()
        try:
            if missing:
                check_record(missing[0])
                import_module("xarray").Dataset(coords={"case": [0]})  # imports pint: not after an interrupt
            for case in finishing(cases, missing, kept, lost, workers, cluster):
                report(rows[case.key])
            if done < len(plan.rows):  # others have finished some
                report(len(plan.rows) - done)
        except KeyboardInterrupt:
            outcome = "interrupted"
        return dataset_of(plan, lost | kept.done, outcome)


def finishing(
    cases: Mapping[str, tuple[Case, list[str]]], missing: Sequence[Case], kept: Store, lost: dict[str, Outcome],
    workers: int | None, cluster: Any,
) -> Iterator[Case]:  # fmt: skip
    """Compute cases and put each into a store as it is done.

    Args:
        cases: with what sets their values, by their keys.
        missing: those of them that are to be computed.
        kept: the store.
        lost: gets those whose process dies: not for ever, another time nothing may kill it.
        workers: processes (default: one for each core); 0: this one.
        cluster: address of a Dask scheduler, or a client of one, instead.
    """
    finished = _engine(_still(missing, kept), len(missing), workers, cluster)
    try:
        for case, found in finished:
            if found.outcome == LOST:
                lost[case.key] = found
            else:
                kept.add(case.key, found, cases[case.key][1])
            yield case
    finally:
        finished.close()


def _still(missing: Iterable[Case], kept: Store) -> Iterator[Case]:
    """Cases that nobody else has finished in the meantime."""
    for case in missing:
        kept.look()
        if case.key not in kept.done:
            yield case


def _engine(
    cases: Iterable[Case], count: int, workers: int | None, cluster: Any
) -> Generator[tuple[Case, Outcome], None, None]:
    lost = Outcome(LOST, {}, reason=DIED)
    if cluster is not None:
        from ropewalk.sweeps.cluster import each_on

        return each_on(cluster, cases, count, computed, lost)
    return each(cases, computed, min(cores() if workers is None else workers, count), lost)
