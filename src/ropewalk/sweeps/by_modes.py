"""Quantities of linear problems straight from their modes, where no other part of the result is asked for."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ropewalk.capabilities import LINEAR, engine_of
from ropewalk.model import Linear, Scenario
from ropewalk.results.line_response import UNITS
from ropewalk.sweeps.quantities import Measured

_ASKED = re.compile(r"\s*(max|largest|min|smallest) (deflection|acceleration) of (\S+)\s*")


def by_modes(scenario: Scenario, record: Sequence[str]) -> Measured | None:
    """Quantities of a run, the same as its result has.

    Args:
        scenario: whose run is done.
        record: names, see `quantities.py`.

    Returns:
        None where the run itself has to be done.

    Raises:
        RopewalkError: the run cannot be done.
    """
    asked = [_ASKED.fullmatch(name) for name in record]
    if not isinstance(scenario.run, Linear) or None in asked or engine_of(scenario) is not LINEAR:
        return None
    from ropewalk.linear.train_peaks import peaks  # lazy: most sweeps do not need it
    from ropewalk.simulate import output_times

    wanted = {name: (one[3], one[2]) for name, one in zip(record, asked, strict=True) if one is not None}
    found = peaks(scenario, output_times(scenario.run), list(wanted.values()))
    if found is None:
        return None
    most = {name: re.match(r"\s*(max|largest)", name) is not None for name in record}
    return {name: (found[of][0 if most[name] else 1], UNITS[of[1]]) for name, of in wanted.items()}
