"""Runs at points of a space of variables: each a case of the store that sweeps use, computed at most once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ropewalk.designs.variables import Space
from ropewalk.errors import Refused, RopewalkError
from ropewalk.mechanics.chain import Array
from ropewalk.model import Scenario
from ropewalk.scenario import dump, tree_of, varying
from ropewalk.sweeps.case import FAILED, Case, Outcome, check_record
from ropewalk.sweeps.expressions import resolved
from ropewalk.sweeps.keys import leaves
from ropewalk.sweeps.parameters import refuse, setting
from ropewalk.sweeps.store import Store
from ropewalk.sweeps.sweeping import finishing


@dataclass(frozen=True)
class Evaluated:
    """A point, what sets its values, and what became of its run."""

    point: Array
    settings: tuple[str, ...]
    outcome: Outcome


class Evaluation:
    """Computes points, and remembers them in the order in which they were asked for.

    Args:
        scenario: what the cases are changes of.
        space: of the points.
        derived: values that follow from others, by key.
        record: quantities that are kept.
        store: of finished cases.
        workers: processes for points that are asked for together; 0: none but this one.
        cluster: address of a Dask scheduler, or a client of one, for the same.
        progress: called with the number of points so far.
    """

    def __init__(
        self, scenario: Scenario, space: Space, derived: Mapping[str, str], record: Sequence[str], store: Store,
        workers: int | None = None, cluster: Any = None, progress: Callable[[int], None] | None = None,
    ) -> None:  # fmt: skip
        scenario = scenario.model_copy(update={"sweep": None})
        self.scenario, self.space, self.record, self.store = scenario, space, tuple(record), store
        self.course = list[Evaluated]()
        self._derived, self._workers, self._cluster = dict(derived), workers, cluster
        self._progress = progress
        self._make = varying(dump(scenario), "the design")
        self._written = dict(leaves(tree_of(scenario)))
        self._lost = dict[str, Outcome]()
        self._known = dict[bytes, Evaluated]()
        self._checked = False

    def settings(self, point: Array) -> tuple[str, ...]:
        """What sets the values at a point, and those that follow, as `--set` has them.

        Raises:
            Refused: a value does not follow.
        """
        given = self.space.settings(point)
        follow = resolved(self._derived, given, self._written)
        return (*(setting(key, value) for key, value in given.items()), *(f"{k}={v}" for k, v in follow.items()))

    def scenario_at(self, settings: Sequence[str]) -> Scenario:
        """The scenario with these values.

        Raises:
            ScenarioError: it cannot be.
        """
        return self._make(settings)

    def one(self, point: Array) -> Evaluated:
        """Compute a point in this process.

        Raises:
            ScenarioError: a quantity is unknown.
        """
        return self._all([point], 0, None)[0]

    def together(self, points: Sequence[Array]) -> list[Evaluated]:
        """Compute points side by side.

        Raises:
            ScenarioError: a quantity is unknown.
            RopewalkError: processes cannot begin, or the cluster cannot be reached.
        """
        return self._all(points, self._workers, self._cluster)

    def _all(self, points: Sequence[Array], workers: int | None, cluster: Any) -> list[Evaluated]:
        found, cases = dict[int, Evaluated](), dict[int, tuple[tuple[str, ...], Case]]()
        first: RopewalkError | Refused | None = None
        for k, point in enumerate(points):
            settings: tuple[str, ...] = ()
            if (same := self._known.get(point.tobytes())) is not None:
                found[k] = same
                continue
            try:
                settings = self.settings(point)
                cases[k] = settings, Case.of(self._make(settings), self.record)
            except (RopewalkError, Refused) as error:
                first = first or error
                found[k] = Evaluated(point, settings, Outcome(FAILED, {}, reason="; ".join(str(error).splitlines())))
        if first is not None and len(found) == len(points) and not self.course:  # nothing at all can be
            if isinstance(first, Refused):
                refuse("derived", first.wrong, first.given or "", first.remedy)
            raise first
        self._compute({case.key: (case, list(settings)) for settings, case in cases.values()}, workers, cluster)
        for k, (settings, case) in cases.items():
            found[k] = Evaluated(points[k], settings, self.store.done.get(case.key) or self._lost[case.key])
        for k in range(len(points)):
            if points[k].tobytes() not in self._known:
                self._known[points[k].tobytes()] = found[k]
                self.course.append(found[k])
        if self._progress is not None:
            self._progress(len(self.course))
        return [found[k] for k in range(len(points))]

    def _compute(self, cases: dict[str, tuple[Case, list[str]]], workers: int | None, cluster: Any) -> None:
        self.store.look()
        missing = [case for key, (case, _) in cases.items() if key not in self.store.done]
        if not missing:
            return
        if not self._checked:
            check_record(missing[0])
            self._checked = True
        for _ in finishing(cases, missing, self.store, self._lost, 0 if len(missing) == 1 else workers, cluster):
            pass
