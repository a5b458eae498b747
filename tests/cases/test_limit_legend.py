"""The legend of the contact force shows the verdict on the largest force, and names other limits that fail."""

from __future__ import annotations

import pytest

import ropewalk
from ropewalk.results import figure, summary, text
from ropewalk.scenario import loads

LINE = """
overhead_lines:
  line: {spans: {count: 3, length: 40}, element: 2, analysed_spans: [2, 2], limits: {system: ac, maximum_force: LIMIT}}
loads: {p: {kind: pantograph, on: line, model: en50318-2002, travel: {speed: 50, from: 10}}}
run: {kind: dynamic, geometry: linearised, until: 1.6, every: 0.02}
"""


@pytest.mark.parametrize(("limit", "verdict"), [(5000, "pass"), (20, "FAIL")])
def test_the_legend_and_the_table_show_each_verdict_with_its_own_limit(limit, verdict):
    found = ropewalk.simulate(loads(LINE.replace("LIMIT", str(limit))))
    judged = summary(found)["pantographs"]["p"]["limits"]
    checks = {check["what"]: check["verdict"] for check in judged["checks"]}
    failed = [what for what, own in checks.items() if own == "FAIL"]
    assert checks["largest force"] == verdict
    assert [what for what in failed if what != "largest force"]  # so the verdict on all limits is FAIL in both cases
    labels = [line.get_label() for line in figure(found, panels=["pantograph_force"]).axes[0].lines]
    assert f"largest allowed: {limit} N; {verdict}" in labels
    assert f"FAIL: {', '.join(what for what in failed if what != 'largest force')}" in labels
    row = next(row for row in text(summary(found)).splitlines() if row.startswith("verdict "))
    assert row.split(None, 2)[2].startswith("; ".join(failed))
