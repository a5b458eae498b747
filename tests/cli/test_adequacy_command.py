"""The command `adequacy`: axes as text, a store beside the work, a figure, and how to go on."""

from __future__ import annotations

import json

import pytest

import adequacy_cases as cases
from ropewalk import compare
from ropewalk.scenario import save

AXES = ("--x", "lines.string.tension=1 kN:3 kN:3", "--y", "lines.string.drag=0.1:0.2:2")
PLAIN = ("adequacy", "string.yaml", *AXES, "--workers", "1", "--tolerance", "0.25")


@pytest.fixture
def string(folder):
    save(cases.scenario(), folder / "string.yaml")
    return folder


def kilo(point):
    """Distances by kN: 0.1 to 0.6."""
    tension, drag = cases.parameters(point)
    return {"linear": {"deflection": drag * tension / 1e3}, "full": {"deflection": 0.0}}


def test_it_prints_the_verdict_and_writes_store_and_figure(call, string, monkeypatch):
    monkeypatch.setattr(compare, "distances", kilo)
    out = call(*PLAIN, "-o", "map.png", "--model", "linear", "--model", "full")
    assert out.exit_code == 0, out.output
    first, second = out.stdout.splitlines()
    assert "the linear theory is within 25 % of the full answer on 50 % of the plane (3 of 6 points)" in first
    assert "tension of string up to 2 kN" in first
    assert "everywhere" in second
    assert (string / "map.png").stat().st_size > 10_000
    assert len((string / "string.adequacy.jsonl").read_text("utf-8").splitlines()) == 7
    monkeypatch.setattr(compare, "distances", None)  # all is there: nothing is computed
    message = json.loads(call(*PLAIN, "--json").stdout)
    assert message["distances"]["linear"]["deflection"][0] == pytest.approx([0.1, 0.2, 0.3])
    assert call(*PLAIN, "--quiet").stdout == ""


def test_interrupted_it_says_how_to_go_on(call, string, monkeypatch):
    def stopped(point):
        if cases.parameters(point) == (3000.0, 0.1):
            raise KeyboardInterrupt
        return kilo(point)

    monkeypatch.setattr(compare, "distances", stopped)
    out = call(*PLAIN, "--store", "mine.jsonl")
    assert out.exit_code == 130
    assert "2 of 6 points are done and kept in mine.jsonl: the same call continues it" in out.stderr


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (("--x", "tension"), "--x: this is no axis, given 'tension'; write KEY=FROM:TO:COUNT"),
        (("--y", "lod ratio=1:2:3"), "--y: lod ratio: neither a key of a scenario nor a ratio"),
        (("--tolerance", "few"), "--tolerance: cannot be read as a plain number, given 'few'; write for example 0.05"),
        (("--model", "lineer"), "no such model, given 'lineer'; did you mean linear?"),
        (("--quantity", "weight"), "no such quantity, given 'weight'"),
        (("--workers", "0"), "workers: must be at least 1"),
        (("-o", "map.doc"), "the name must end in .png, .svg, .pdf"),
        (("--store", "string.yaml"), "string.yaml: exists and is no store of points; it is left alone"),
    ],
)
def test_bad_input_is_told_and_computes_nothing(call, string, monkeypatch, changes, message):
    monkeypatch.setattr(compare, "distances", None)
    out = call(*PLAIN, *changes)
    assert out.exit_code == 2, out.output
    assert message in out.stderr
    assert not (string / "string.adequacy.jsonl").exists()
