"""The command `feedback` prints a table with a verdict, or JSON."""

from __future__ import annotations

import json
from types import ModuleType, SimpleNamespace

import pytest


@pytest.fixture
def compared(monkeypatch):
    """A stand-in for the comparison."""
    module = ModuleType("ropewalk.coupling")
    rows = [("", "with feedback", "without", ""), ("largest tension of rope", "12.00 N", "15.00 N", "+25 %")]
    module.feedback = lambda scenario: SimpleNamespace(
        table=lambda: rows, as_dict=lambda: {"title": scenario.title}, verdict="it matters"
    )
    monkeypatch.setitem(__import__("sys").modules, "ropewalk.coupling", module)


@pytest.mark.usefixtures("compared")
def test_feedback_prints_columns_and_a_verdict_or_json(call, scenario):
    name = scenario()
    out = call("feedback", name)
    assert out.exit_code == 0
    assert out.stdout == (
        "                         with feedback  without\n"
        "largest tension of rope        12.00 N  15.00 N  +25 %\n\nit matters\n"
    )
    assert json.loads(call("feedback", name, "--json", "--set", "title=Other").stdout) == {"title": "Other"}
