"""A bead on a weightless inextensible rope: energy integral, and motion with friction until it rests."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp

from closed_forms import beads
from ropewalk.theory import bead, friction, locus

ROPE = {"span": 20.0, "length": 22.0}
G = 9.81


@pytest.mark.parametrize(("start", "expected"), [(5.0, 9.98182885647823957), (2.0, 9.36644513206429725)])
def test_periods_are_those_of_the_catalogue(start: float, expected: float) -> None:
    assert bead.period(start, **ROPE) == pytest.approx(expected, rel=2e-15)  # all digits that a number has


def test_small_period_is_the_limit() -> None:
    small = bead.small_period(**ROPE)
    assert small == pytest.approx(10.308209256566, abs=5e-13)  # 14 digits are given
    assert small == pytest.approx(2 * math.pi * 11 / math.sqrt(G * 0.5 * math.sqrt(84)), rel=1e-15)
    assert bead.period([10.0, 10.0 + 1e-6], **ROPE) == pytest.approx([small, small], rel=1e-12)  # (swing/span)^2
    steep = {"span": 12.0, "height": 9.0, "length": 18.0}
    lowest = bead.slide(0.0, start=1.0, mass=1.0, friction="block", coefficient=0.0, **steep)
    assert not lowest.rests
    still = beads.swing(np.arange(3.0), start=_lowest_x(steep), mass=1.0, **steep)
    assert np.ptp(still.x) < 1e-9
    assert bead.period(_lowest_x(steep) + 1e-4, **steep) == pytest.approx(bead.small_period(**steep), rel=1e-7)


def _lowest_x(rope: dict[str, float]) -> float:
    """Where a pulley hangs: the slopes of the pieces are opposite, ``sqrt(length^2 - span^2)/span``."""
    slope = math.sqrt(rope["length"] ** 2 - rope["span"] ** 2) / rope["span"]
    return 0.5 * (rope["span"] - rope.get("height", 0.0) / slope)


@settings(deadline=None, max_examples=15)
@given(st.floats(1.02, 2.0), st.floats(0.05, 0.95), st.floats(1.0, 30.0))
def test_period_is_the_energy_integral_over_x(ratio: float, share: float, gravity: float) -> None:
    """Between level supports, over the path of a pulley by `locus`, whose only common part is nothing."""
    span, length = 3.0, 3.0 * ratio
    start = 0.5 * span - 0.5 * length * share * 0.95
    far = span - start

    def path(x: float) -> tuple[float, float]:
        at = locus.ellipse(span=span, length=length, load=1.0, x=x)
        return float(at.z), float(at.slope)

    top, _ = path(start)

    def rate(s: float) -> float:  # x = middle + half sin s keeps the integrand finite
        x = 0.5 * span + (far - 0.5 * span) * math.sin(s)
        z, slope = path(x)
        fall = max(top - z, 1e-300)
        return math.hypot(1.0, slope) * (far - 0.5 * span) * math.cos(s) / math.sqrt(2 * gravity * fall)

    half, _ = quad(rate, -math.pi / 2 + 1e-6, math.pi / 2 - 1e-6, epsabs=0, epsrel=1e-9)
    # 2e-6 of the range is left out, and its fall of 1e-12 is a difference
    assert bead.period(start, span=span, length=length, gravity=gravity) == pytest.approx(2 * half, rel=1e-5)


STOPS = [
    ("capstan", 0.02, 5.0134817998, 14.0828472153),
    ("capstan", 0.1, 4.9308609539, 10.3054976904),
    ("block", 0.1, 4.9280945989, 9.9719272654),
]


@pytest.mark.parametrize(("law", "coefficient", "time", "place"), STOPS)
def test_first_stops_are_those_of_the_catalogue(law, coefficient: float, time: float, place: float) -> None:
    slide = bead.slide(40.0, start=5.0, mass=3.0, friction=law, coefficient=coefficient, **ROPE)
    # ten decimals are given, and the integration's 1e-12 grows to 1e-11 of the distance
    assert slide.stop_times[0] == pytest.approx(time, abs=1.1e-10)
    assert slide.stop_places[0] == pytest.approx(place, abs=1.1e-10)


def _segments(slide: bead.Slide, rope: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Forces of the rope behind and ahead on the bead, from its place and tensions alone."""
    place = np.stack([slide.x, slide.z])
    behind, ahead = -place, np.array([[rope["span"]], [rope.get("height", 0.0)]]) - place
    sides = ((slide.tension_behind, behind), (slide.tension_ahead, ahead))
    return tuple(tension * way / np.hypot(*way) for tension, way in sides)


@pytest.mark.parametrize(
    ("rope", "start"), [(ROPE, 5.0), (ROPE, 20.4), ({"span": 12.0, "height": 5.0, "length": 18.0}, 9.0)]
)
def test_a_swing_is_that_of_the_integrated_forces(rope: dict[str, float], start: float) -> None:
    """Newton's law in x and z with the thread's tension as a multiplier, and the energy."""
    ends = np.array([[0.0, 0.0], [rope["span"], rope.get("height", 0.0)]])

    def rates(_: float, state: np.ndarray) -> np.ndarray:
        ways = ends - state[:2]
        distances = np.linalg.norm(ways, axis=1)
        tangents = ways / distances[:, np.newaxis]
        pull = tangents.sum(axis=0)  # minus the gradient of the length
        across = state[2:] @ state[2:] - (tangents @ state[2:]) ** 2
        # (length)'' = 0: pull.acceleration = sum of the across/distance
        tension = (np.sum(across / distances) + pull[1] * G) / (pull @ pull)
        return np.array([*state[2:], *(tension * pull - [0.0, G])])

    t = np.linspace(0.0, 12.0, 25)
    swing = beads.swing(t, start=start, mass=2.0, **rope)
    ode = solve_ivp(rates, (0, 12), [start, swing.z[0], 0, 0], t_eval=t, method="DOP853", rtol=1e-11, atol=1e-11)
    # the tolerance of the integration, of 20 m over 12 s
    assert swing.x == pytest.approx(ode.y[0], abs=2e-8)
    assert swing.z == pytest.approx(ode.y[1], abs=2e-8)
    assert swing.z_velocity == pytest.approx(ode.y[3], abs=2e-8)
    energy = 0.5 * (swing.x_velocity**2 + swing.z_velocity**2) + G * (swing.z - swing.z[0])
    assert np.max(np.abs(energy)) < 1e-11  # rounding of 100 J/kg
    assert np.all(swing.tension_behind == swing.tension_ahead)
    force = sum(_segments(swing, rope))
    there = np.array([rates(0, state)[2:] for state in ode.y.T]).T
    assert (force / 2.0 - [[0.0], [G]]) == pytest.approx(there, abs=1e-6)


def test_slide_without_friction_is_a_swing() -> None:
    t = np.linspace(0.0, 25.0, 40).reshape(8, 5)
    for rope, start in ((ROPE, 3.0), ({"span": 12.0, "height": 5.0, "length": 18.0}, 9.0)):
        swing = beads.swing(t, start=start, mass=2.0, **rope)
        for law in ("capstan", "block"):
            slide = bead.slide(t, start=start, mass=2.0, friction=law, coefficient=0.0, **rope)
            for name in ("x", "z", "x_velocity", "z_velocity", "tension_behind", "stop_times", "stop_places"):
                # five swings of an integration to 1e-12
                assert getattr(slide, name) == pytest.approx(getattr(swing, name), abs=1e-9), name
            assert not slide.rests
    assert swing.stop_times[1] == pytest.approx(bead.period(9.0, **rope), rel=1e-14)
    assert swing.stop_places[1] == pytest.approx(9.0, rel=1e-14)


@settings(deadline=None, max_examples=12)
@given(
    law=st.sampled_from(["capstan", "block"]),
    coefficient=st.floats(0.02, 0.3),
    height=st.floats(-5.0, 5.0),
    share=st.floats(-0.7, 0.7),
)
def test_a_bead_slides_by_newtons_law_and_coulombs_and_rests(law, coefficient, height, share) -> None:
    rope = {"span": 10.0, "height": height, "length": 14.0}
    start, mass, end = 5.0 + 5.0 * share, 2.0, 40.0
    give = {"start": start, "mass": mass, "friction": law, "coefficient": coefficient, **rope}
    slide = bead.slide(np.linspace(0.0, end, 101), **give)
    behind, ahead = slide.tension_behind, slide.tension_ahead
    place = np.stack([slide.x, slide.z])
    ways = -place, np.array([[10.0], [height]]) - place
    assert np.hypot(*ways[0]) + np.hypot(*ways[1]) == pytest.approx(14.0, rel=1e-13)
    assert np.all(np.minimum(behind, ahead) > 0.0)
    angle = friction.turning_angle(-ways[0].T, ways[1].T)
    needed = {"capstan": friction.capstan_coefficient, "block": friction.point_block_coefficient}[law](
        tension_behind=behind, tension_ahead=ahead, angle=angle
    )
    last = slide.stop_times[-1] if slide.stop_times.size else 0.0
    t = np.linspace(0.0, end, 101)
    moving = t < last
    assert needed[moving] == pytest.approx(coefficient, rel=1e-9)  # 1e-13 by the small difference of the tensions
    along = np.sum(np.stack([slide.x_velocity, slide.z_velocity]) * (ways[1] - ways[0]), axis=0)
    assert np.all((np.sign(behind - ahead) == np.sign(along))[moving & (np.abs(along) > 1e-9)])
    assert np.all(needed[t > last] <= coefficient * (1 + 1e-12))
    assert slide.rests == (slide.x[-1] == slide.x[-2])
    assert slide.rests  # 40 s are enough for these coefficients
    # Newton's law at an instant in motion, by differences of the velocity over 2e-4 s
    for now in t[moving][1:4]:
        if np.min(np.abs(slide.stop_times - now)) > 1e-3:
            near = bead.slide([now - 1e-4, now, now + 1e-4], **give)
            pull = sum(_segments(near, rope))[:, 1] / mass - [0.0, G]
            assert np.diff(near.x_velocity[::2])[0] / 2e-4 == pytest.approx(pull[0], abs=1e-4)
            assert np.diff(near.z_velocity[::2])[0] / 2e-4 == pytest.approx(pull[1], abs=1e-4)


def test_block_stops_where_the_closed_integral_says() -> None:
    """With a constant coefficient ``d(v^2)/d(psi)`` is linear in v^2, psi the direction of the path."""
    a, b, mu = 11.0, 0.5 * math.sqrt(84.0), 0.1

    def height(psi: float) -> tuple[float, float]:  # gravity's work per psi, and the friction under the weight alone
        sliding_speed = (
            a * b / (a**2 * math.sin(psi) ** 2 + b**2 * math.cos(psi) ** 2) ** 1.5 * a * b
        )  # radius of curvature
        return math.sin(psi) * sliding_speed, math.cos(psi) * sliding_speed

    def direction(x: float) -> float:
        phi = math.asin((x - 10.0) / a)
        return math.atan2(b * math.sin(phi), a * math.cos(phi))

    slide = bead.slide(40.0, start=5.0, mass=1.0, friction="block", coefficient=mu, **ROPE)
    work, _ = quad(
        lambda psi: -sum(f * g for f, g in zip(height(psi), (1.0, mu), strict=True)) * math.exp(2 * mu * psi),
        direction(5.0),
        direction(float(slide.stop_places[0])),
        epsabs=1e-13,
    )
    assert abs(work) < 1e-10  # m, the energy left where it stops


def test_friction_holds_a_bead_from_the_start_or_lets_it_go() -> None:
    at = locus.ellipse(span=20.0, length=22.0, load=1.0, x=7.0)
    needed = abs(float(at.slope))  # theory of the block: the hold force by the weight
    give = {"start": 7.0, "mass": 1.0, "friction": "block", **ROPE}
    restrained = bead.slide([0.0, 5.0], coefficient=needed * (1 + 1e-9), **give)
    loose = bead.slide([0.0, 5.0], coefficient=needed * (1 - 1e-9), **give)
    assert restrained.rests
    assert np.all(restrained.x == 7.0)
    assert restrained.stop_times.size == 0
    assert loose.x_velocity[1] != 0.0 or loose.stop_times.size > 0
    assert sum(_segments(restrained, ROPE))[:, 0] == pytest.approx([0.0, G], abs=1e-12)
    pushed = bead.slide([0.0, 5.0], coefficient=needed * (1 + 1e-9), speed=1.0, **give)
    assert pushed.x[1] > 7.0


def test_a_fast_bead_slackens_the_rope() -> None:
    """Thrown upwards over the widest point, it leaves the ellipse where the press N vanishes."""
    give = {"start": 20.0, "mass": 1.0, "friction": "capstan", "coefficient": 0.0, **ROPE}
    slide = bead.slide([0.0, 0.3, 5.0], speed=8.0, **give)
    assert slide.slack_at is not None
    assert 0.3 < slide.slack_at < 5.0
    assert np.isnan(slide.x).tolist() == [False, False, True]
    there = bead.slide(slide.slack_at * (1 - 1e-9), speed=8.0, **give)
    assert there.tension_ahead == pytest.approx(0.0, abs=1e-6)
    assert there.z > 0.0
    block = bead.slide(5.0, speed=8.0, **(give | {"friction": "block", "coefficient": 0.2}))
    assert block.slack_at is not None
    assert block.slack_at < slide.slack_at


def test_nonsense_is_refused() -> None:
    for name, value in (("span", 0.0), ("length", 20.0), ("height", math.nan), ("gravity", -1.0)):
        with pytest.raises(ValueError, match=f"^{name} must"):
            bead.period(5.0, **(ROPE | {name: value}))
        with pytest.raises(ValueError, match=f"^{name} must"):
            bead.small_period(**(ROPE | {name: value}))
    give = {"start": 5.0, "mass": 1.0, "friction": "capstan", "coefficient": 0.1, **ROPE}
    for name, value in (
        ("start", 21.1),
        ("mass", 0.0),
        ("friction", "glue"),
        ("coefficient", -0.1),
        ("speed", math.inf),
    ):
        with pytest.raises(ValueError, match=f"^{name} must"):
            bead.slide(1.0, **(give | {name: value}))
    with pytest.raises(ValueError, match=r"^t must"):
        beads.swing(-1.0, start=5.0, mass=1.0, **ROPE)
    with pytest.raises(ValueError, match="slacken"):
        bead.period(9.7, span=10.0, height=10.0, length=15.0)
    with pytest.raises(ValueError, match="taut where it starts"):
        bead.slide(1.0, **(give | {"start": 20.995, "friction": "block"}))
