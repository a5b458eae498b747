"""Constant force on a simply supported beam: Fryba, Vibration of Solids and Structures under Moving Loads."""

import math
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ropewalk.theory import beam

UNIT = {"length": 1.0, "bending_stiffness": 1.0, "mass": 1.0}
BEAM = {"length": 2.0, "bending_stiffness": 3.0, "mass": 1.5}
STATIC = 1.0 / 48.0  # midspan, F = L = EI = 1

fractions = st.floats(0.0, 1.0)
speed_ratios = st.floats(0.02, 4.0)
ends = st.sampled_from(["simply_supported", "clamped"])


@pytest.mark.parametrize(
    ("alpha", "factor"),
    [(0.25, 1.2576097899), (0.5, 1.7054451486), (0.617, 1.7316740422), (1.0, 1.5480736528)],
)
def test_impact_factor_at_midspan(alpha: float, factor: float) -> None:
    # the given digits end in a truncated series, 1e-9 from the limit
    assert beam.impact_factor(alpha * np.pi, x=0.5, **UNIT) == pytest.approx(factor, abs=2e-9)


def test_impact_factor_while_the_force_is_on_the_beam_and_after_it() -> None:
    on = beam.impact_factor(1.5 * np.pi, x=0.5, free_vibration=False, **UNIT)
    assert on == pytest.approx(1.0238311681, abs=4e-8)  # at the exit; given to 3e-8 of the limit
    # one mode: 2 alpha/(alpha^2 - 1) cos(pi/(2 alpha)) of 2 F L^3/(pi^4 EI) after the exit
    after = beam.impact_factor(1.5 * np.pi, x=0.5, modes=1, **UNIT)
    assert after == pytest.approx(2 * 1.5 / 1.25 * math.cos(math.pi / 3), rel=1e-12)


def test_largest_impact_factor_is_that_of_olsson_1991() -> None:
    near = np.array([0.616, 0.617032, 0.618]) * np.pi
    low, top, high = beam.impact_factor(near, x=0.5, **UNIT)
    assert top == pytest.approx(1.7316740401, abs=6e-9)  # given below the value at 0.617, so to 6e-9
    assert low < top > high
    # a single mode: 1.768457654 in its own static deflection, "1.743 at 0.617" in F L^3/(48 EI)
    one = beam.moving_force_peak(force=1.0, speed=0.617332 * np.pi, x=0.5, modes=1, **UNIT).deflection
    assert one / STATIC == pytest.approx(1.742875670, abs=1e-9)
    assert one / (2.0 / np.pi**4) == pytest.approx(1.768457654, abs=1e-9)


def test_peak_at_half_the_critical_speed_comes_at_two_thirds_of_the_beam() -> None:
    peak = beam.moving_force_peak(force=1.0, speed=0.5 * np.pi, x=0.5, modes=1, **UNIT)
    assert peak.t * 0.5 * np.pi == pytest.approx(2 / 3, abs=1e-7)  # flat top: root of the rounding


def test_upward_force_has_the_same_peak_with_the_other_sign() -> None:
    down = beam.moving_force_peak(force=2.0, speed=1.1, modes=20, **BEAM)
    up = beam.moving_force_peak(force=-2.0, speed=1.1, modes=20, **BEAM)
    assert (up.deflection, up.x, up.t) == (-down.deflection, down.x, down.t)


def test_yang_and_yau_1997_force() -> None:
    data = {"length": 25.0, "bending_stiffness": 2.87e9 * 2.90, "mass": 2303.0}
    weight = 5750 * 9.81
    assert beam.natural_frequencies(1, **data) == pytest.approx(30.0201395243, abs=5e-11)  # digits given
    static = beam.standing_force(12.5, 12.5, force=weight, tolerance=1e-12, **data)
    assert static == pytest.approx(0.00220615359921, abs=5e-15)  # digits given
    peak = beam.moving_force_peak(force=weight, speed=100 / 3.6, x=12.5, **data)
    assert peak.deflection == pytest.approx(0.00239682641469, abs=5e-12)  # given to 9 digits of the limit
    assert peak.t == pytest.approx(0.376390909, abs=5e-9)


def test_modal_coordinates_are_frybas() -> None:
    n, alpha, t, x = np.arange(1, 6), 0.6, 0.21, 0.37
    w, drive = (n * np.pi) ** 2, n * np.pi * alpha * np.pi
    q = 2.0 * (np.sin(drive * t) - drive / w * np.sin(w * t)) / (w**2 - drive**2)
    expected = np.sum(q * np.sin(n * np.pi * x))
    computed = beam.moving_force(x, t, force=1.0, speed=alpha * np.pi, modes=5, **UNIT)
    assert computed == pytest.approx(expected, rel=1e-12)  # rounding; nothing cancels much here


@pytest.mark.parametrize("mode", [1, 2, 5])
def test_at_resonance_the_limit_is_taken(mode: int) -> None:
    speed = beam.resonance_speeds(5, **BEAM)[mode - 1]
    assert speed == pytest.approx(mode * np.pi / 2.0 * math.sqrt(3.0 / 1.5), rel=1e-14)
    x, t = np.linspace(0.0, 2.0, 9), np.linspace(0.0, 2.0 / speed, 7)[:, np.newaxis]
    at, below, above = (
        beam.moving_force(x, t, force=1.0, speed=v, modes=8, **BEAM)
        for v in (speed, speed * (1 - 1e-7), speed * (1 + 1e-7))
    )
    assert at == pytest.approx(0.5 * (below + above), abs=1e-11)
    w, share = beam.natural_frequencies(mode, **BEAM)[-1], np.sin(mode * np.pi * x / 2.0)
    resonant = 1.0 / (1.5 * 2.0 * w**2) * (np.sin(w * t) - w * t * np.cos(w * t)) * share
    t_end = np.array([2.0 / speed])
    alone = beam.moving_force(x, t, force=1.0, speed=speed, modes=mode, **BEAM)
    others = beam.moving_force(x, t, force=1.0, speed=speed, modes=mode - 1, **BEAM) if mode > 1 else 0.0
    assert alone - others == pytest.approx(resonant, abs=1e-14)
    assert np.all(np.isfinite(beam.moving_force(x, 2 * t_end, force=1.0, speed=speed, **BEAM)))


@settings(deadline=None, max_examples=25)
@given(speed_ratios, fractions, st.floats(-0.9, 20.0), st.floats(0.0, 500.0), st.floats(0.0, 60.0))
def test_energy_is_work_less_dissipation(
    alpha: float, progress: float, pull: float, foundation: float, damping: float
) -> None:
    """E = F integral of w_t under the load less c integral of w_t^2; modes by discrete sine transform."""
    modes, speed = 4, alpha * np.pi
    line = UNIT | {"tension": pull * np.pi**2, "foundation": foundation, "damping": damping}
    end = progress / speed
    n = np.arange(1, modes + 1)
    grid = np.arange(1, 16) / 16
    project = 2.0 / 16 * np.sin(np.pi * np.outer(n, grid))
    nodes, weights = np.polynomial.legendre.leggauss(60)
    segments = max(1, int(end * 400 / 30))  # the highest frequency is below 400
    edges = np.linspace(0.0, end, segments + 1)
    t = (edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * 0.5 * (1 + nodes)).ravel()
    weights = (np.diff(edges)[:, np.newaxis] * 0.5 * weights).ravel()

    def velocity(x: np.ndarray, at: np.ndarray) -> np.ndarray:
        return beam.moving_force_velocity(x, at, force=1.0, speed=speed, modes=modes, **line)

    q = project @ beam.moving_force(grid, end, force=1.0, speed=speed, modes=modes, **line)
    rate = project @ velocity(grid, np.asarray(end))
    stored = 0.25 * np.sum(rate**2 + beam.natural_frequencies(modes, **line) ** 2 * q**2)
    work = np.sum(weights * velocity(np.clip(speed * t, 0.0, 1.0), t))
    lost = damping * np.sum(weights * 0.5 * np.sum((velocity(grid, t[:, np.newaxis]) @ project.T) ** 2, axis=1))
    assert stored == pytest.approx(work - lost, abs=1e-11 * (1.0 + end))  # rounding, quadrature


@settings(deadline=None, max_examples=40)
@given(ends, fractions, fractions, st.floats(-0.9, 30.0), st.floats(0.0, 1e4))
def test_static_deflection_is_reciprocal(kind: str, a: float, b: float, pull: float, bed: float) -> None:
    line = UNIT | {"tension": pull * np.pi**2, "foundation": bed, "ends": kind, "force": 2.0, "modes": 40}
    there, back = beam.standing_force(a, b, **line), beam.standing_force(b, a, **line)
    assert there == pytest.approx(back, abs=1e-15)


@settings(deadline=None, max_examples=20)
@given(ends, fractions, fractions)
def test_slow_travel_is_rest_under_the_standing_force(kind: str, x: float, place: float) -> None:
    for speed in (1e-7, 1e-12):
        slow = beam.moving_force(x, place / speed, force=1.0, speed=speed, modes=60, ends=kind, **UNIT)
        rest = beam.standing_force(x, place, force=1.0, modes=60, ends=kind, **UNIT)
        assert slow == pytest.approx(rest, abs=1e-8)  # of the order of speed over critical speed times 1/48


def test_static_deflections_of_the_tables() -> None:
    middle = {"x": 0.5, "place": 0.5, "force": 1.0, "tolerance": 1e-10}
    assert beam.standing_force(**middle, **UNIT) == pytest.approx(1 / 48, rel=1e-10)  # the tolerance
    assert beam.standing_force(**middle, ends="clamped", **UNIT) == pytest.approx(1 / 192, rel=1e-9)
    # tie bar: F L/(4 T) (1 - tanh(u)/u), u = L/2 sqrt(T/EI)
    u = 0.5 * math.sqrt(50.0)
    tied = 1 / 200 * (1 - math.tanh(u) / u)
    assert beam.standing_force(**middle, tension=50.0, **UNIT) == pytest.approx(tied, rel=1e-9)


def test_the_number_of_modes_keeps_the_tolerance() -> None:
    x, t = np.linspace(0.0, 1.0, 21), np.linspace(0.0, 0.8, 15)[:, np.newaxis]
    for kind in ("simply_supported", "clamped"):
        fine = beam.moving_force(x, t, force=1.0, speed=2.0, modes=1500, ends=kind, **UNIT)
        for tolerance in (1e-3, 1e-6):
            coarse = beam.moving_force(x, t, force=1.0, speed=2.0, tolerance=tolerance, ends=kind, **UNIT)
            assert np.max(np.abs(coarse - fine)) < tolerance * STATIC


@pytest.mark.parametrize("kind", ["simply_supported", "clamped"])
def test_velocity_is_the_rate_of_the_deflection_before_and_after_the_exit(kind: str) -> None:
    line = UNIT | {"force": 1.0, "speed": 2.0, "damping": 3.0, "modes": 2, "ends": kind}
    for low, high in ((0.02, 0.48), (0.52, 0.9)):
        w = np.polynomial.Chebyshev.interpolate(lambda t: beam.moving_force(0.4, t, **line), 60, domain=[low, high])
        t = np.linspace(low + 0.01, high - 0.01, 9)
        assert beam.moving_force_velocity(0.4, t, **line) == pytest.approx(w.deriv()(t), abs=1e-10)


def test_all_poles_may_meet() -> None:
    """Critical damping and a decaying part of the clamped shape that decays as fast, in time."""
    mode = beam.natural_frequencies(1, ends="clamped", **UNIT)[0]
    line = UNIT | {"damping": 2.0 * mode, "force": 1.0, "modes": 1, "ends": "clamped"}
    t = np.array([1e-9, 1e-4, 0.02, 0.1, 0.2])
    meeting = math.sqrt(mode)  # speed; the wavenumber of decay is sqrt(omega) for a unit beam
    near = [beam.moving_force(0.4, t, speed=meeting * (1.0 + e), **line) for e in (-1e-2, 0.0, 1e-13, 1e-2)]
    assert near[1] == pytest.approx(near[2], rel=1e-9)
    assert near[1] == pytest.approx(0.5 * (near[0] + near[3]), rel=1e-3)


def test_a_fast_force_has_its_resonant_modes_counted() -> None:
    """At alpha = 30 or 60 that mode is at resonance, and all about it count."""
    line = beam.Beam(length=1.0, bending_stiffness=1.0, mass=1.0)
    assert line.enough(1e-5, 60.0 * np.pi) > 60 > 40 > line.enough(1e-5, 0.1)
    x, t = np.linspace(0.0, 1.0, 21), np.linspace(0.0, 1.0 / (30.0 * np.pi), 21)[:, np.newaxis]
    fine, coarse = (
        beam.moving_force(x, t, force=1.0, speed=30.0 * np.pi, **UNIT, **how)
        for how in ({"modes": 500}, {"tolerance": 1e-5})
    )
    assert np.max(np.abs(coarse - fine)) < 1e-5 * STATIC


def test_free_vibration_decays_at_the_rate_of_the_damping() -> None:
    line = UNIT | {"damping": 0.8, "force": 1.0, "speed": 3.0, "modes": 1}
    period = 2 * np.pi / math.sqrt(np.pi**4 - 0.4**2)
    early, late = beam.moving_force(0.5, [0.5, 0.5 + period], **line)
    assert late / early == pytest.approx(math.exp(-0.4 * period), rel=1e-12)


@pytest.mark.parametrize("ratio", [0.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 3.0, 1e6])
@pytest.mark.parametrize("kind", ["simply_supported", "clamped"])
def test_damping_of_any_size_agrees_with_the_differential_equation(kind: str, ratio: float) -> None:
    """q'' + 2 d q' + w^2 q = p at Chebyshev points, by the residual of the interpolated solution."""
    w = beam.natural_frequencies(1, ends=kind, **UNIT)[0]
    line = UNIT | {"damping": 2.0 * ratio * w, "force": 1.0, "speed": 1.3, "modes": 1, "ends": kind}
    series = np.polynomial.Chebyshev.interpolate(
        lambda t: beam.moving_force_velocity(0.4, t, **line), 60, domain=[0.05, 0.7]
    )
    t = np.linspace(0.1, 0.6, 11)
    rate, acceleration = series(t), series.deriv()(t)
    q = beam.moving_force(0.4, t, **line)
    static = np.array([beam.standing_force(0.4, 1.3 * s, force=1.0, modes=1, ends=kind, **UNIT) for s in t])
    residual = acceleration + 2.0 * ratio * w * rate + w**2 * (q - static)
    assert np.max(np.abs(residual)) < 1e-9 * w**2 * np.max(static)  # derivative of an interpolant of degree 60


@pytest.mark.parametrize("kind", ["simply_supported", "clamped"])
@pytest.mark.parametrize("speed", [0.0, 1e-300, 1e-9, 1.0, 1e6, 1e12])
@pytest.mark.parametrize("damping", [0.0, 10.0, 1e9])
def test_extremes_stay_finite(kind: str, speed: float, damping: float) -> None:
    x, t = np.array([0.0, 0.3, 1.0]), np.array([-1.0, 0.0, 1e-9, 0.3, 5.0, 1e4])[:, np.newaxis]
    for function in (beam.moving_force, beam.moving_force_velocity):
        w = function(x, t, force=1.0, speed=speed, damping=damping, modes=7, ends=kind, **UNIT)
        assert np.all(np.isfinite(w))
        assert np.max(np.abs(w[:, [0, 2]])) < 1e-12  # supports do not move
        assert np.all(w[:2] == 0.0)
    if speed == 0.0:
        assert np.all(w == 0.0)


def test_shapes_broadcast() -> None:
    x, t = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 5)
    line = UNIT | {"force": 1.0, "speed": 1.0, "modes": 9}
    table = beam.moving_force(x, t[:, np.newaxis], **line)
    assert table.shape == (5, 5)
    assert beam.moving_force(x, t, **line) == pytest.approx(np.diag(table), abs=1e-16)
    assert beam.moving_force(x[:, np.newaxis], t, **line) == pytest.approx(table.T, abs=1e-16)
    assert beam.moving_force(x[2], t[3], **line) == pytest.approx(table[3, 2], abs=1e-16)
    assert beam.moving_force(x[:, np.newaxis, np.newaxis], t[:, np.newaxis], **line).shape == (5, 5, 1)
    assert beam.impact_factor([[0.0, 1.0]], modes=3, **UNIT).shape == (1, 2)


def test_field_of_a_million_points_with_fifty_modes_takes_around_a_tenth_of_a_second() -> None:
    x, t = np.linspace(0.0, 1.0, 1000), np.linspace(0.0, 1.5, 1000)[:, np.newaxis]
    spent = []
    for _ in range(3):
        start = time.process_time()
        beam.moving_force(x, t, force=1.0, speed=1.0, modes=50, **UNIT)
        spent.append(time.process_time() - start)
    assert min(spent) < 1.0  # 0.1 s when written


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"length": 0.0}, "^length must"),
        ({"bending_stiffness": 0.0}, "^bending_stiffness must"),
        ({"mass": -1.0}, "^mass must"),
        ({"foundation": -1.0}, "^foundation must"),
        ({"damping": math.nan}, "^damping must"),
        ({"tension": math.inf}, "^tension must"),
        ({"tension": -(np.pi**2)}, "buckles: tension must be above -9.8696 N"),
        ({"tension": -4 * np.pi**2, "ends": "clamped"}, "buckles: tension must be above -39.478"),
        ({"ends": "free"}, "^ends must"),
        ({"speed": -1.0}, "^speed must"),
        ({"force": math.inf}, "^force must"),
        ({"modes": 0}, "^modes must"),
        ({"tolerance": 0.0}, "^tolerance must"),
        ({"tolerance": 1e-20}, "give modes"),
        ({"x": 1.1}, "^x must lie"),
        ({"t": math.nan}, "^t must"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, object], said: str) -> None:
    arguments = {"x": 0.5, "t": 0.5, "speed": 1.0, "force": 1.0} | UNIT | changed
    with pytest.raises(ValueError, match=said):
        beam.moving_force(**arguments)


def test_impact_at_a_support_and_of_negative_speed_are_refused() -> None:
    with pytest.raises(ValueError, match=r"^x must lie between the supports"):
        beam.impact_factor(1.0, x=0.0, **UNIT)
    with pytest.raises(ValueError, match=r"^speed must"):
        beam.impact_factor(-1.0, **UNIT)
    with pytest.raises(ValueError, match=r"^speed must"):
        beam.moving_force_peak(force=1.0, speed=0.0, **UNIT)
