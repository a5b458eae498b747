"""Every calculator beside a closed form that it does not use, and beside a run of the engine."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from ropewalk import calc
from ropewalk.model import Scenario
from ropewalk.simulate import simulate
from ropewalk.theory import beam as beams
from ropewalk.theory import highline, locus, rope

G = 9.81


@pytest.mark.parametrize("length", [60.0, 50.01, 49.9])
def test_span_is_the_elastic_catenary_found_by_its_complementary_energy(length: float) -> None:
    found = calc.span(span=49.0, height=10.0, length=length, mass=2.0, axial_stiffness=2e6, load=120.0, place=0.3)
    exact = rope.elastic_catenary(
        span=49.0, height=10.0, length=length, weight=2.0 * G, axial_stiffness=2e6,
        loads=[(0.3 * length, (0.0, -120.0 * G))],
    )  # fmt: skip
    assert found.sag == pytest.approx(exact.sag, rel=1e-9)
    assert found.load_x == pytest.approx(exact.load_positions[0, 0], rel=1e-9)
    assert -found.load_depth == pytest.approx(exact.load_positions[0, 1], rel=1e-9)
    assert found.start_tension == pytest.approx(math.hypot(*exact.start_reaction), rel=1e-9)
    assert found.end_tension == pytest.approx(math.hypot(*exact.end_reaction), rel=1e-9)
    assert found.end_angle == pytest.approx(math.atan2(*exact.end_reaction[::-1]), rel=1e-9)


def test_a_catenary_by_its_parameter() -> None:
    """y = a cosh(x/a): sag, length and tension follow from a; given any two of span, a and one more, the rest."""
    a, half, mass = 80.0, 50.0, 1.5
    sag, length = a * (math.cosh(half / a) - 1.0), 2.0 * a * math.sinh(half / a)
    found = calc.catenary(span=2.0 * half, sag=sag, mass=mass)
    assert found.length == pytest.approx(length, rel=1e-10)
    assert found.horizontal_tension == pytest.approx(mass * G * a, rel=1e-9)
    assert found.largest_tension == pytest.approx(mass * G * (a + sag), rel=1e-9)
    assert math.tan(found.start_angle) == pytest.approx(math.sinh(half / a), rel=1e-9)
    assert calc.catenary(length=length, sag=sag, mass=mass).span == pytest.approx(2.0 * half, rel=1e-9)
    assert calc.catenary(span=2.0 * half, sag=sag, weight=mass * G * length).mass == pytest.approx(mass, rel=1e-9)


def test_a_span_is_where_the_engine_rests() -> None:
    """Of the second order in 60 links: 3e-4."""
    found = calc.span(span=40.0, height=5.0, length=40.6, mass=1.0, axial_stiffness="1 MN", load=100.0)
    line = {"start": [0, 0], "end": [40, 5], "length": 40.6, "mass": 1.0, "axial_stiffness": 1e6, "elements": 60}
    load = {"kind": "force", "on": "rope", "force": [0, -100.0 * G], "travel": {"speed": 0, "from": 20.3}}
    run = simulate(Scenario.model_validate({"lines": {"rope": line}, "loads": {"load": load},
                                            "run": {"kind": "equilibrium"}}))  # fmt: skip
    where = run.contact_position.to_numpy().reshape(-1, 2)[-1]
    assert where == pytest.approx([found.load_x, -found.load_depth], abs=3e-4 * 40.0)
    assert float(run.tension.max()) == pytest.approx(found.largest_tension, rel=2e-3)


@pytest.mark.parametrize("place", [0.5, 0.2])
def test_a_person_on_a_highline_by_the_complementary_energy(place: float) -> None:
    found = calc.highline(span=63.0, stretch="18 %", standing_tension=1500.0, mass=57.0, place=place)
    stance = highline.stand(span=63.0, standing_tension=1500.0, stiffness=1e4 / 0.18, mass=57.0, place=place)
    frequencies = [stance.bounce_frequency, stance.surge_frequency, stance.sway_frequency]
    assert [found.sag, found.tension] == pytest.approx([stance.sag, stance.tensions.max()], rel=1e-9)
    assert [found.bounce_frequency, found.surge_frequency, found.sway_frequency] == pytest.approx(frequencies, rel=1e-9)


def test_a_fall_by_its_motion() -> None:
    """The lowest place of a mass that falls freely and then hangs in the middle of two springs, integrated."""
    found = calc.highline(span=63.0, stretch="18 %", standing_tension=1500.0, mass=57.0, fall=1.5)
    stiffness, length = 1e4 / 0.18, 63.0 / (1.0 + 1500.0 * 0.18 / 1e4)

    def pull(y: float) -> float:
        return stiffness * (math.hypot(63.0, 2.0 * y) / length - 1.0) * 4.0 * y / math.hypot(63.0, 2.0 * y)

    stops = lambda _, s: s[1]  # noqa: E731
    stops.terminal, stops.direction = True, -1.0
    motion = solve_ivp(
        lambda _, s: [s[1], G - pull(s[0]) / 57.0], (0.0, 9.0), [0.0, math.sqrt(2.0 * G * 1.5)], events=stops,
        rtol=1e-10, atol=1e-12,
    )  # fmt: skip
    assert found.fall_sag == pytest.approx(motion.y[0, -1], rel=1e-8)
    assert found.fall_force == pytest.approx(pull(motion.y[0, -1]), rel=1e-7)
    assert found.fall_tension > found.tension > found.standing_tension


def test_the_strings_of_a_guitar() -> None:
    """E2 and E4 of a scale of 648 mm: tension by m (2 L f)^2."""
    for frequency, mass in ((82.41, 6.79e-3), (329.63, 0.401e-3)):
        found = calc.string(length="648 mm", frequency_1=frequency, mass=mass, force=1.0, place="25 %")
        assert found.tension == pytest.approx(mass * (2.0 * 0.648 * frequency) ** 2, rel=1e-10)
        assert found.deflection == pytest.approx(0.25 * 0.75 * 0.648 / found.tension, rel=1e-10)


# Of handbooks: deflection under a force in the middle (or at the free end) over F L^3/EI, largest moment over F L,
# deflection under a line load over q L^4/EI, its moment over q L^2, the first beta L, buckling over EI/L^2.
U = (15.0 - math.sqrt(33.0)) / 16.0  # where a propped beam sags most
HANDBOOK = {
    "simply_supported": (0.5, 1 / 48, 1 / 4, 5 / 384, 1 / 8, math.pi, math.pi**2),
    "clamped": (0.5, 1 / 192, 1 / 8, 1 / 384, 1 / 12, 4.730041, 4.0 * math.pi**2),
    "propped": (0.5, 7 / 768, 3 / 16, U**2 * (3.0 - 5.0 * U + 2.0 * U**2) / 48.0, 1 / 8, 3.926602, 20.190729),
    "cantilever": (1.0, 1 / 3, 1.0, 1 / 8, 1 / 2, 1.875104, math.pi**2 / 4.0),
}


@pytest.mark.parametrize("ends", HANDBOOK)
def test_beams_of_handbooks(ends: str) -> None:
    place, deflection, moment, line, line_moment, beta, buckling = HANDBOOK[ends]
    found = calc.beam(
        ends=ends, length=8.0, bending_stiffness=5e6, mass=200.0, force=3e3, place=place, line_load=400.0, speed=20.0
    )
    assert found.deflection == pytest.approx(deflection * 3e3 * 8.0**3 / 5e6, rel=1e-6)
    assert found.moment == pytest.approx(moment * 3e3 * 8.0, rel=1e-6)
    assert found.line_deflection == pytest.approx(line * 400.0 * 8.0**4 / 5e6, rel=1e-5)
    assert found.sag == pytest.approx(found.line_deflection * 200.0 * G / 400.0, rel=1e-9)
    assert found.line_moment == pytest.approx(line_moment * 400.0 * 64.0, rel=1e-6)
    assert found.frequency_1 == pytest.approx(beta**2 * math.sqrt(5e6 / 200.0) / 64.0 / (2.0 * math.pi), rel=1e-5)
    assert found.buckling_force == pytest.approx(buckling * 5e6 / 64.0, rel=1e-6)


@pytest.mark.parametrize("ends", ["simply_supported", "clamped"])
def test_a_beam_by_its_modes(ends: str) -> None:
    given_beam = {"length": 8.0, "bending_stiffness": 5e6, "mass": 200.0}
    found = calc.beam(ends=ends, force=3e3, place=0.3, speed=20.0, **given_beam)
    assert found.deflection == pytest.approx(
        float(beams.standing_force(2.4, 2.4, force=3e3, ends=ends, tolerance=1e-7, **given_beam)), rel=1e-5
    )
    circular = beams.natural_frequencies(3, ends=ends, **given_beam)
    frequencies = [found.frequency_1, found.frequency_2, found.frequency_3]
    assert frequencies == pytest.approx(circular / (2.0 * np.pi), rel=1e-10)


def test_down_a_light_stiff_rope_by_energy() -> None:
    """On an ellipse, without losses: v^2 = 2 g (fall)."""
    down = {"span": 100.0, "height": -8.0, "length": 101.0, "mass": 1e-4, "load": 90.0, "margin": 2.0}
    found = calc.zipline(**down, brake_distance=15.0)
    ellipse = locus.ellipse(span=100.0, height=-8.0, length=101.0, load=1.0, x=np.linspace(0.5, 99.5, 20_001))
    first, last, end = (np.interp(s, ellipse.xi, ellipse.z) for s in (2.0, 86.0, 99.0))
    assert found.arrival_speed == pytest.approx(math.sqrt(2.0 * G * (first - last)), rel=2e-3)
    assert found.energy == pytest.approx(90.0 * G * (first - end), rel=5e-3)
    assert found.brake_spring_force == pytest.approx(2.0 * found.brake_force, rel=1e-12)
    assert found.largest_depth == pytest.approx(np.max(-0.08 * ellipse.x - ellipse.z), rel=1e-3)
    way = found.energy / found.brake_force
    assert 0.5 * found.brake_spring * way**2 == pytest.approx(found.energy, rel=1e-12)
    # m dv/ds = -c along the level: the speed falls evenly with the way.
    assert found.arrival_speed - found.brake_damping / 90.0 * way == pytest.approx(0.0, abs=1e-9)
    assert found.top_speed == pytest.approx(math.sqrt(2.0 * G * (first - ellipse.z.min())), rel=2e-3)
    slower = calc.zipline(**down, brake_distance=15.0, headwind=5.0, air_drag=0.4, rolling=0.01)
    assert slower.arrival_speed < found.arrival_speed


span_given = st.fixed_dictionaries(
    {
        "span": st.floats(5.0, 500.0), "height": st.floats(-3.0, 3.0), "mass": st.floats(0.05, 5.0),
        "axial_stiffness": st.floats(3e5, 3e7), "load": st.floats(1.0, 300.0), "slack": st.floats(1.002, 1.1),
        "by": st.sampled_from(["sag", "horizontal_tension", "bare_sag", "bare_tension", "load_depth"]),
    }
)  # fmt: skip


@given(known=span_given)
@settings(max_examples=15, deadline=None)
def test_a_result_of_a_span_gives_its_length_back(known: dict[str, float]) -> None:
    slack, by = known.pop("slack"), str(known.pop("by"))
    length = slack * math.hypot(known["span"], known["height"])
    there = calc.span(**known, length=length)
    back = calc.span(**known, **{by: there[by]})
    assert back[by] == pytest.approx(there[by], rel=1e-6)
    others = [float(message.split()[2]) for message in back.messages]
    assert any(found == pytest.approx(length, rel=2e-4) for found in (back.length, *others))


@given(
    span=st.floats(10.0, 300.0), stretch=st.floats(0.02, 0.3), standing=st.floats(300.0, 8e3),
    mass=st.floats(30.0, 150.0), by=st.sampled_from(["tension", "sag", "sway_frequency"]),
)  # fmt: skip
@settings(max_examples=15, deadline=None)
def test_a_result_of_a_highline_gives_the_first_back(
    span: float, stretch: float, standing: float, mass: float, by: str
) -> None:
    there = calc.highline(span=span, stretch=stretch, standing_tension=standing, mass=mass)
    back = calc.highline(span=span, stretch=stretch, mass=mass, **{by: there[by]})
    assert back.standing_tension == pytest.approx(standing, rel=1e-5)
    both = calc.highline(span=span, mass=mass, tension=there.tension, bounce_frequency=there.bounce_frequency)
    assert both.stretch == pytest.approx(stretch, rel=1e-4)


@given(
    length=st.floats(0.5, 80.0), stiffness=st.floats(1e3, 1e11), mass=st.floats(0.1, 1e4),
    ends=st.sampled_from([*HANDBOOK]), force=st.floats(1.0, 1e6),
)  # fmt: skip
@settings(max_examples=15, deadline=None)
def test_results_of_a_beam_give_it_back(length: float, stiffness: float, mass: float, ends: str, force: float) -> None:
    there = calc.beam(ends=ends, length=length, bending_stiffness=stiffness, mass=mass, force=force, place=0.4)
    back = calc.beam(
        ends=ends, length=length, frequency_2=there.frequency_2, deflection=there.deflection, force=force, place=0.4
    )
    assert [back.bending_stiffness, back.mass] == pytest.approx([stiffness, mass], rel=1e-8)
    asked = calc.beam(ends=ends, length=None, bending_stiffness=stiffness, mass=mass, frequency_1=there.frequency_1)
    assert asked.length == pytest.approx(length, rel=1e-8)


def test_an_arrival_gives_the_rope_and_the_resistance() -> None:
    down = {"span": 150.0, "height": -14.0, "mass": 0.55, "axial_stiffness": 6e6, "load": 79.0, "air_drag": 0.35}
    there = calc.zipline(**down, length=151.1, rolling=0.015)
    back = calc.zipline(**down, bare_tension=there.bare_tension, rolling=None, arrival_speed=there.arrival_speed)
    assert [back.length, back.rolling] == pytest.approx([151.1, 0.015], rel=1e-5)
