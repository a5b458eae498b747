"""Curves: where the contact wire runs across the head, what arms bear, and what a wind does to it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from typer.testing import CliRunner

from overhead_cases import EN_2002, formed, rested
from ropewalk.cli.app import app
from ropewalk.model import Scenario
from ropewalk.model.overhead import OverheadLine
from ropewalk.overhead.lateral import aside_of, blown_off, on_the_strip, radial_forces
from ropewalk.results.contact_statistics import contact_statistics
from ropewalk.simulate import simulate

LINE = EN_2002 | {
    "spans": {"count": 4, "length": "50 m"}, "droppers": {"per_span": 5, "stiffness": "100 kN/m"}, "element": "1 m",
    "analysed_spans": [2, 3],
}  # fmt: skip
SAME = {"stagger": ["-200 mm"] * 5}


def line(**keys: Any) -> OverheadLine:
    return OverheadLine.model_validate(LINE | keys)


def test_between_supports_the_wire_is_the_chord_of_the_arc() -> None:
    R, L = 600.0, 50.0
    found = aside_of(line(radius=f"{R} m", steady_arms=SAME), 1, np.linspace(0.0, L, 11))
    # A track on a circle about the origin; the wire is straight between points that are 200 mm outside of it.
    half = 0.5 * L / R
    ends = (R + 0.2) * np.array([[np.cos(half), -np.sin(half)], [np.cos(half), np.sin(half)]])
    chord = ends[0] + np.linspace(0.0, 1.0, 11)[:, None] * (ends[1] - ends[0])
    np.testing.assert_allclose(found, R - np.hypot(*chord.T), atol=5e-4)  # of 520 mm; angles are small


def test_arms_on_a_curve_bear_t_l_over_r() -> None:
    for radius in (600.0, -600.0):
        section = formed(LINE | {"radius": radius, "steady_arms": SAME})
        rest, _ = rested(section)
        for i in (1, 2, 3):
            arm = section.arms[f"section.arm.{i}"]
            sideways = float(rest.tie_force[arm] * rest.tie_way[arm, 1])
            assert sideways == pytest.approx(-20e3 * 50.0 / radius, rel=1e-6)  # to the outside
    # Staggers and curves of single spans add up.
    bent = line(radius=[0, 0, 800, 800], steady_arms={"stagger": [0.2, -0.2, 0.2, -0.2, -0.2]})
    expected = [
        -20e3 * 2 * 0.4 / 50.0,
        20e3 * (2 * 0.4 / 50.0 - 0.5 * 50.0 / 800.0),
        -20e3 * (0.4 / 50.0 + 50.0 / 800.0),
    ]
    np.testing.assert_allclose(radial_forces(bent), expected)


def test_the_head_wears_where_the_wire_runs() -> None:
    # Straight from -200 to 200 mm and back: every strip of 50 mm as long as the next one.
    edges, share = on_the_strip(line(steady_arms={"stagger": "200 mm"}))
    np.testing.assert_allclose(edges, np.linspace(-0.2, 0.2, 9), atol=1e-12)
    np.testing.assert_allclose(share, 1.0 / 8.0, rtol=1e-9)
    # A parabola from -200 mm, k x (L - x) / 2: within 50 mm of its top, f, is sqrt(0.05 / f) of the span.
    edges, share = on_the_strip(line(radius="1250 m", steady_arms=SAME))
    assert (edges[0], edges[-1]) == (pytest.approx(-0.2), pytest.approx(0.05))
    assert share[-1] == pytest.approx(np.sqrt(0.05 / 0.25), abs=0.003)
    assert share.sum() == pytest.approx(1.0)


def test_a_wind_blows_it_on_from_where_the_curve_has_it() -> None:
    # -200 mm + (1 / R + q / T) L^2 / 8 from the outside; from the inside it only comes back.
    found = blown_off(line(radius="1000 m", steady_arms=SAME), 8.0)
    assert found == pytest.approx(-0.2 + (1e-3 + 8.0 / 20e3) * 50.0**2 / 8.0)
    assert blown_off(line(radius="1000 m", steady_arms=SAME), 0.0) == pytest.approx(0.2)


def test_a_curve_is_a_change_of_the_arms_alone_in_linearised_motion() -> None:
    run = {"kind": "dynamic", "geometry": "linearised", "until": 1.0, "every": 0.1}
    load = {"kind": "pantograph", "on": "line", "model": "en50318-2002", "travel": {"speed": 50.0, "from": 30.0}}

    def ran(**keys: Any) -> Any:
        tree = {"overhead_lines": {"line": LINE | keys}, "loads": {"head": load}, "run": run}
        return contact_statistics(simulate(Scenario.model_validate(tree)))["head"]

    # Kinks of 8 mm/m either way, of staggers or of a radius: arms that pull as hard stiffen the wire alike.
    curve = ran(radius="3125 m", steady_arms=SAME)
    zigzag = ran(steady_arms={"stagger": "200 mm"})
    level = ran()
    assert curve.deviation == pytest.approx(zigzag.deviation, rel=1e-9)
    assert abs(curve.uplift - level.uplift) > 1e-4


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"radius": "80 m", "steady_arms": SAME}, "too tight for its spans; write 100 m or more"),
        ({"radius": [800, 800], "steady_arms": SAME}, "does not go with the spans; give 4 values, or one"),
        ({"radius": "800 m"}, "steady arms bear the wire on a curve; give steady_arms a stagger"),
        (
            {"radius": "800 m", "steady_arms": SAME, "messenger_supports": {"stagger": "straight"}},
            "a straight messenger does not follow a curve",
        ),
    ],
)
def test_what_is_no_curve_of_an_overhead_line_is_refused(keys: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        line(**keys)


def test_the_command_tells_of_arms_and_strip(tmp_path: Any) -> None:
    file = tmp_path / "curve.yaml"
    file.write_text(
        "overhead_lines: {line: {spans: {count: 4, length: 50 m}, element: 1 m, radius: 1250 m,\n"
        "  steady_arms: {stagger: [-0.2 m, -0.2 m, -0.2 m, -0.2 m, -0.2 m]}}}\nrun: {kind: equilibrium}\n"
    )
    said = CliRunner().invoke(app, ["elasticity", str(file)]).output
    assert "lateral force of the steady arms" in said
    assert "800 to 800 N" in said
    assert "contact on the head, 0 to 50 mm" in said
