"""The spectrum of scenarios, and how it is printed and drawn."""

from __future__ import annotations

import json

import numpy as np
import pytest

from ropewalk.errors import EquilibriumError, RopewalkError, ScenarioError
from ropewalk.model import Dynamic, Equilibrium, Line, MovingForce, MovingMass, Scenario, Start, Travel
from ropewalk.results.spectrum_figure import spectrum_figure
from ropewalk.simulate import spectrum_of
from ropewalk.solve.spectrum import in_space, spectrum
from spectrum_cases import hanging, straight, strand


def slack_rope(**changes):
    run = changes.pop("run", Dynamic(until=0.5, every=0.1))
    rope = Line(start=(0.0, 0.0), end=(19.5, 0.0), length=20.0, mass=1.0, axial_stiffness=1e5, elements=30)
    travel = Travel.model_validate({"speed": 10.0, "from": 9.2})
    walker = MovingForce(on="rope", force=(0.0, -800.0), travel=travel)
    return Scenario(lines={"rope": rope, **changes}, loads={"walker": walker}, run=run)


def test_a_scenario_is_linearised_at_rest_without_loads_or_at_an_instant():
    bare, at = hanging(30, 20.0, 19.5, 1.0, 1e5)
    rest = spectrum_of(slack_rope())
    assert rest.name == "rope"
    r, X = at
    assert rest.eigenvalues == pytest.approx(spectrum(bare, (in_space(r), X)).eigenvalues, rel=1e-9)
    # Sideways it swings like a pendulum about its supports, slower than in its plane: 2.45 instead of 4.68 rad/s.
    assert rest.lowest_frequency < 0.6 * spectrum(bare, at).lowest_frequency
    assert rest.modes is not None
    assert np.abs(rest.modes.shape[0, :, [0, 2]]).max() < 1e-9
    later = spectrum_of(slack_rope(), at=0.4)
    assert later.lowest_frequency > 1.1 * rest.lowest_frequency  # the force pulls the rope taut
    loaded = spectrum_of(slack_rope(run=Equilibrium()))
    assert loaded.lowest_frequency > 1.1 * rest.lowest_frequency
    # the links beside the riding node are shorter than the others
    assert 1.0 < loaded.highest_frequency / rest.highest_frequency < 1.13


@pytest.mark.parametrize(("run", "at"), [(Dynamic(until=0.5), 0.6), (Dynamic(until=0.5), -0.1), (Equilibrium(), 0.0)])
def test_an_instant_outside_the_run_is_refused(run, at):
    with pytest.raises(ScenarioError, match=f"given {at:g} s"):
        spectrum_of(slack_rope(run=run), at=at)


@pytest.mark.parametrize("at", [0.0, None])
def test_masses_are_not_passed_over(at):
    whole = slack_rope(run=Dynamic(until=0.5, start=Start(with_loads=True)))
    travel = whole.loads["walker"].travel
    heavy = whole.model_copy(update={"loads": {"trolley": MovingMass(on="rope", mass=800.0 / 9.81, travel=travel)}})
    # Where the same weight is a force it pulls as much, and swings faster.
    assert spectrum_of(heavy, at=at).lowest_frequency < 0.5 * spectrum_of(whole, at=at).lowest_frequency


def test_a_line_without_a_rest_shape_of_its_own_is_refused_until_its_load_is_on_it():
    weightless = slack_rope(run=Dynamic(until=0.5, start={"with_loads": True})).model_copy(update={"gravity": 0.0})
    assert spectrum_of(weightless).lowest_frequency > 0.0
    with pytest.raises(EquilibriumError, match="line rope: without loads"):
        spectrum_of(weightless.model_copy(update={"run": Dynamic(until=0.5)}))


def test_several_lines_are_taken_each_and_together():
    wire = Line(start=(0.0, 5.0), end=(30.0, 5.0), tension=500.0, mass=0.5, axial_stiffness=1e6, drag=0.1, elements=9)
    both = spectrum_of(slack_rope(wire=wire))
    rope, other = both.lines
    assert (both.name, rope.name, other.name) == ("all lines", "rope", "wire")
    assert both.unknowns == both.eigenvalues.size == rope.unknowns + other.unknowns
    assert both.lowest_frequency == min(rope.lowest_frequency, other.lowest_frequency)
    assert both.highest_frequency == max(rope.highest_frequency, other.highest_frequency)
    assert both.stable_step == min(rope.stable_step, other.stable_step)
    assert (rope.imaginary, other.imaginary, both.imaginary) == (True, False, False)


def test_numbers_go_to_json_and_into_a_table():
    found = spectrum(strand(1), straight(1))  # no node is free
    assert (found.unknowns, found.character) == (0, "empty")
    for case in (found, spectrum_of(slack_rope(short=slack_rope().lines["rope"]))):
        json.dumps(case.as_dict(), allow_nan=False)
        assert all(isinstance(name, str) and isinstance(value, str) for name, value in case.table())
    table = dict(spectrum(strand(50), straight(50)).table())
    assert table["lowest frequency"] == "6.95446 rad/s = 1.10684 Hz"
    assert table["stable Verlet step"] == "0.0012655 s"


def test_states_without_a_spectrum_are_refused():
    r, X = straight(5)
    r[:, 2] = r[:, 1]
    with pytest.raises(RopewalkError, match="no length"):
        spectrum(strand(5), (r, X))
    r[:, 2] = np.nan
    with pytest.raises(RopewalkError, match="not finite"):
        spectrum(strand(5), (r, X))
    with pytest.raises(ValueError, match="how_many"):
        spectrum(strand(5), straight(5), how_many=0)


@pytest.mark.parametrize(
    ("case", "stretch"), [({}, 1.02), ({"c": 5.0}, 1.02), ({"c": 50.0, "drag": 1.0}, 0.999), ({}, 1.0)], ids=str
)
def test_the_figure_shows_every_eigenvalue_and_has_units(case, stretch, tmp_path):
    found = spectrum(strand(20, **case), straight(20, stretch=stretch))
    fig = spectrum_figure(found)
    fig.savefig(tmp_path / "spectrum.png")
    for ax in fig.axes:
        assert ax.get_xlabel().endswith(")")
        assert ax.get_ylabel().endswith(")")
    drawn = fig.axes[0].get_lines()[0]
    assert np.array_equal(drawn.get_xdata() + 1j * drawn.get_ydata(), found.eigenvalues)
    low, high = fig.axes[0].get_ylim()
    assert low < found.eigenvalues.imag.min() <= found.eigenvalues.imag.max() < high
