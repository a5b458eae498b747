"""`ropewalk new`: templates are listed, each loads and runs, and is an example under a name of one's own."""

from __future__ import annotations

import pytest

from ropewalk.scenario import loads
from ropewalk.scenario.examples import examples
from ropewalk.scenario.template import TRADES, template, trades

WANTED = {"ropeway", "highline", "zip-line", "overhead-line", "bridge", "train", "cable-crane", "footbridge", "net",
          "tightrope", "tramway"}  # fmt: skip


def test_without_a_name_it_lists_them_and_writes_nothing(call, folder) -> None:
    before = set(folder.iterdir())
    out = call("new")
    assert out.exit_code == 0
    assert [line.split()[4] for line in out.stdout.splitlines()] == list(trades())
    assert set(trades()) >= WANTED
    assert set(folder.iterdir()) == before


def test_it_writes_the_one_that_is_asked_for_and_refuses_others(call, folder) -> None:
    assert call("new", "mine", "--template", "zip-line").exit_code == 0
    assert (folder / "mine.yaml").read_text(encoding="utf-8") == template("mine", "zip-line")
    out = call("new", "other", "--template", "ziplin")
    assert out.exit_code == 2
    assert "zip-line" in out.stderr
    assert not (folder / "other.yaml").exists()


@pytest.mark.parametrize("trade", TRADES)
def test_each_is_an_example_by_another_title(trade: str) -> None:
    """Line by line, so that tests/test_examples.py, which runs every example and knows its numbers, runs it."""
    text = template('mine: "one"', trade)
    own, known = text.splitlines(), examples()[TRADES[trade]].splitlines()
    assert [a for a, b in zip(own, known, strict=True) if a != b] == ['title: "mine: \\"one\\""']
    assert text.count("#") > 3
    assert loads(text).title == 'mine: "one"'


@pytest.mark.parametrize("trade", ["zip-line", "train", "overhead-line"])
def test_one_that_was_written_runs(trade: str, call, folder) -> None:
    """Its first instants, in which hardly any energy is turned over, so that the audit of some is doubtful."""
    assert call("new", "mine", "-t", trade).exit_code == 0
    out = call("run", "mine.yaml", "-q", "--set", "run.until=2 ms", "--set", "run.every=1 ms")
    assert out.exit_code in (0, 4), out.stderr
