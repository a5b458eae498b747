"""Force that starts to move on a nonlinear string without ends, and transverse impact (Rakhmatulin; Cole).

Reference numbers, in units of EA and c_l, are derived in docs/notes.
"""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import fsolve

from ropewalk.theory import selfsimilar

UNIT = {"axial_stiffness": 1.0, "mass": 1.0}
CASE = {"force": 0.01, "speed": 0.1, "prestrain": 0.05, **UNIT}
ALPHAS = (0.23, 0.46, 0.69, 0.85)
KINK_AT_REST = math.sqrt(0.05 / 1.05)
CONTACTS = ("clamped", "frictionless")

contacts = st.sampled_from(CONTACTS)


@pytest.mark.parametrize(
    ("prestrain", "strain", "angle", "force"),
    [
        (0.0, 0.0307428125208801, 0.596515158800264, 0.0345403422400216),
        (0.05, 0.0690693831858001, 0.37686303690509, 0.050835820604255),
    ],
)
def test_transverse_impact(prestrain: float, strain: float, angle: float, force: float) -> None:
    wave = selfsimilar.transverse_impact(velocity=0.1, prestrain=prestrain, **UNIT)
    # 15 digits are given
    assert wave.strain == pytest.approx((strain, strain), abs=1e-16)
    assert wave.angle == pytest.approx((angle, angle), abs=1e-15)
    assert wave.force == pytest.approx((0.0, force), abs=1e-16)
    assert wave.contact_velocity == pytest.approx([0.0, 0.1], abs=1e-16)


def test_vertical_force_that_moves_hides_a_motor() -> None:
    wave = selfsimilar.moving_force(**CASE)
    # half a unit of the last digit given
    assert wave.strain == pytest.approx((0.05113347904644, 0.051695100893973), abs=5e-15)
    assert wave.angle == pytest.approx((0.06715496738748, 0.17758067138272), abs=5e-15)
    assert wave.contact_velocity == pytest.approx([0.10548732622843, 0.022610844688267], abs=5e-15)
    assert wave.dissipation == pytest.approx(-5.8459226e-5, abs=5e-13)
    assert wave.hold_force == 0.0


def test_frictionless_contact_needs_a_hold_force_and_loses_nothing() -> None:
    wave = selfsimilar.moving_force(**CASE, contact="frictionless")
    assert wave.strain == pytest.approx((0.051391597213493,) * 2, abs=5e-16)
    assert wave.angle == pytest.approx((0.067041532983384, 0.17858875111487), abs=5e-15)
    assert wave.hold_force == pytest.approx(0.00055831512686011, abs=5e-18 + 1e-17)  # a rounding of strains
    assert wave.contact_velocity == pytest.approx([0.10577238396614, 0.022615500188314], abs=5e-15)
    assert wave.dissipation == 0.0


def power_balance(wave: selfsimilar.SelfSimilarWave) -> float:
    """Power of the force less the growth of kinetic and elastic energy, piece by piece."""
    ends = [-wave.front_speed, -wave.kink_speed[0], wave.speed, wave.kink_speed[1], wave.front_speed]
    growth = 0.0
    for low, high in pairwise(ends):
        middle = 0.5 * (low + high)
        velocity, gradient = wave.velocity(middle, 1.0), wave.gradient(middle, 1.0)
        strain = float(np.hypot(*gradient)) - 1.0
        stored = 0.5 * wave.axial_stiffness * (strain**2 - wave.prestrain**2)
        growth += (high - low) * (0.5 * wave.mass * float(velocity @ velocity) + stored)
    return float(np.dot(wave.force, wave.contact_velocity)) - growth


def momentum_balance(wave: selfsimilar.SelfSimilarWave) -> np.ndarray:
    """Force less the growth of momentum; the pulls from far away cancel."""
    ends = [-wave.front_speed, -wave.kink_speed[0], wave.speed, wave.kink_speed[1], wave.front_speed]
    growth = sum((high - low) * wave.mass * wave.velocity(0.5 * (low + high), 1.0) for low, high in pairwise(ends))
    return np.array(wave.force) - growth


@settings(deadline=None, max_examples=60)
@given(contacts, st.floats(-6.0, -0.7), st.floats(0.0, 0.9), st.floats(0.002, 0.5), st.sampled_from([-1, 1]))
def test_jumps_momentum_and_energy_balance(
    contact: selfsimilar.Contact, decades: float, alpha: float, prestrain: float, sign: int
) -> None:
    stiffness, mass = 1e5, 0.7
    c_l = math.sqrt(stiffness / mass)
    speed = alpha * c_l * math.sqrt(prestrain / (1.0 + prestrain))
    force = sign * stiffness * prestrain * 10.0**decades
    given_string = {"axial_stiffness": stiffness, "mass": mass, "prestrain": prestrain, "contact": contact}
    wave = selfsimilar.moving_force(force=force, speed=speed, **given_string)
    # Newton's method ends in roundings of quantities below 1
    assert np.max(np.abs(wave.jump_residual())) < 1e-15
    assert momentum_balance(wave) / stiffness == pytest.approx(0.0, abs=1e-14)
    assert power_balance(wave) / (stiffness * c_l) == pytest.approx(wave.dissipation / (stiffness * c_l), abs=1e-14)
    # tolerance: the same roundings; the sign is that of the statement
    assert wave.dissipation <= 1e-16 * stiffness * c_l
    if contact == "frictionless":
        assert wave.strain[0] == wave.strain[1]
    else:
        assert wave.hold_force == 0.0


@pytest.mark.parametrize("contact", CONTACTS)
@pytest.mark.parametrize("alpha", ALPHAS)
@pytest.mark.parametrize("force", [1e-8, 1e-3, 0.01, 0.05, 0.2, 0.5])
def test_solution_is_found_up_to_heavy_forces(contact: selfsimilar.Contact, alpha: float, force: float) -> None:
    wave = selfsimilar.moving_force(force=force, speed=alpha * KINK_AT_REST, prestrain=0.05, contact=contact, **UNIT)
    assert np.max(np.abs(wave.jump_residual())) < 1e-15  # roundings of quantities below 1
    assert wave.speed < wave.kink_speed[1] < wave.front_speed
    assert 0.0 < wave.angle[0] < wave.angle[1] < math.pi


@pytest.mark.parametrize("alpha", ALPHAS)
def test_states_agree_with_an_independent_root_finder(alpha: float) -> None:
    """The equations as printed in docs/notes, solved by MINPACK from a rough start."""
    u, e_0, f = alpha * KINK_AT_REST, 0.05, 0.01

    def equations(state: np.ndarray) -> list[float]:
        e_l, e_r, g_l, g_r = state
        c_l, c_r = math.sqrt(e_l / (1 + e_l)), math.sqrt(e_r / (1 + e_r))
        v_l = (e_l - e_0 - c_l * (1 + e_l) * (1 - math.cos(g_l)), c_l * (1 + e_l) * math.sin(g_l))
        v_r = (-(e_r - e_0) + c_r * (1 + e_r) * (1 - math.cos(g_r)), c_r * (1 + e_r) * math.sin(g_r))
        return [
            v_r[0] - v_l[0] + u * ((1 + e_r) * math.cos(g_r) - (1 + e_l) * math.cos(g_l)),
            v_r[1] - v_l[1] + u * (-(1 + e_r) * math.sin(g_r) - (1 + e_l) * math.sin(g_l)),
            e_r * math.cos(g_r) - e_l * math.cos(g_l) + u * (v_r[0] - v_l[0]),
            -e_r * math.sin(g_r) - e_l * math.sin(g_l) + u * (v_r[1] - v_l[1]) + f,
        ]

    wave = selfsimilar.moving_force(force=f, speed=u, prestrain=e_0, **UNIT)
    found = fsolve(equations, [0.051, 0.052, 0.06, 0.3], xtol=1e-12)
    assert [*wave.strain, *wave.angle] == pytest.approx(found, abs=1e-11)  # accuracy of the root finder


@pytest.mark.parametrize("contact", CONTACTS)
def test_position_is_continuous_and_moves_with_the_velocity(contact: selfsimilar.Contact) -> None:
    wave = selfsimilar.moving_force(
        force=-800.0, speed=12.0, axial_stiffness=1e5, mass=1.0, prestrain=0.02, contact=contact
    )
    t = 0.4
    fronts = t * np.array([-wave.front_speed, -wave.kink_speed[0], wave.speed, wave.kink_speed[1], wave.front_speed])
    behind, ahead = wave.position(fronts - 1e-9, t), wave.position(fronts + 1e-9, t)
    assert behind == pytest.approx(ahead, abs=1e-8)  # points 2e-9 m apart, roundings at 100 m
    xi = np.linspace(-150.0, 150.0, 37)
    moved = (wave.position(xi, t + 1e-6) - wave.position(xi, t - 1e-6)) / 2e-6
    assert moved == pytest.approx(wave.velocity(xi, t), abs=1e-6)  # roundings at 150 m by 2e-6 s
    stretched = (wave.position(xi + 1e-6, t) - wave.position(xi - 1e-6, t)) / 2e-6
    assert stretched == pytest.approx(wave.gradient(xi, t), abs=1e-6)
    contact_place = wave.position(wave.speed * t, t)
    assert contact_place == pytest.approx(wave.contact_velocity * t, abs=1e-13)  # roundings
    assert contact_place[1] < 0.0  # a negative force moves it to its own side


def test_string_is_at_rest_before_and_far_away() -> None:
    wave = selfsimilar.moving_force(**CASE)
    assert wave.position([-1.0, 2.0], 0.0) == pytest.approx(np.array([[-1.05, 0.0], [2.1, 0.0]]))
    assert wave.position([-1.0, 2.0], -3.0) == pytest.approx(np.array([[-1.05, 0.0], [2.1, 0.0]]))
    assert np.all(wave.velocity([-1.01, 1.01], 1.0) == 0.0)
    assert wave.position(np.zeros((3, 1)), np.ones(4)).shape == (3, 4, 2)


@pytest.mark.parametrize("alpha", ALPHAS)
def test_small_force_gives_the_linear_limit(alpha: float) -> None:
    """v_z = F/(2 rho c), hold force F^2 alpha / (2 P (1 - alpha^2))."""
    force = 1e-6
    case = {"force": force, "speed": alpha * KINK_AT_REST, "prestrain": 0.05, **UNIT}
    clamped = selfsimilar.moving_force(**case)
    # the next terms are of the relative order (F/P)^2/(1 - alpha)^2
    assert clamped.contact_velocity[1] == pytest.approx(force / (2 * KINK_AT_REST), rel=1e-7)
    pulley = selfsimilar.moving_force(**case, contact="frictionless")
    hold = force**2 * alpha / (2 * 0.05 * (1 - alpha**2))
    assert pulley.hold_force == pytest.approx(hold, rel=1e-4)  # strains round at 1e-17, the force is 1e-11


@pytest.mark.parametrize("contact", CONTACTS)
@pytest.mark.parametrize("prestrain", [0.0, 0.05])
@pytest.mark.parametrize("velocity", [1e-6, 0.1, 2.0])
def test_force_at_rest_is_the_transverse_impact(
    velocity: float, prestrain: float, contact: selfsimilar.Contact
) -> None:
    impact = selfsimilar.transverse_impact(velocity=velocity, prestrain=prestrain, **UNIT)
    wave = selfsimilar.moving_force(force=impact.force[1], speed=0.0, prestrain=prestrain, contact=contact, **UNIT)
    # the inverse of a function known to 1e-15, twice
    assert wave.strain == pytest.approx(impact.strain, rel=1e-13)
    assert wave.angle == pytest.approx(impact.angle, rel=1e-12)
    assert wave.contact_velocity == pytest.approx([0.0, velocity], rel=1e-12, abs=1e-15)


def test_force_the_other_way_mirrors_the_wave() -> None:
    up, down = selfsimilar.moving_force(**CASE), selfsimilar.moving_force(**{**CASE, "force": -0.01})
    assert down.strain == up.strain
    assert down.angle == (-up.angle[0], -up.angle[1])
    assert down.contact_velocity == pytest.approx(up.contact_velocity * [1, -1], abs=0.0)
    assert down.dissipation == up.dissipation


@settings(deadline=None, max_examples=20)
@given(contacts, st.floats(-2.0, 6.0), st.floats(-2.0, 3.0))
def test_solution_scales_with_stiffness_and_mass(
    contact: selfsimilar.Contact, stiffness_decades: float, mass_decades: float
) -> None:
    stiffness, mass = 10.0**stiffness_decades, 10.0**mass_decades
    c_l = math.sqrt(stiffness / mass)
    unit = selfsimilar.moving_force(**CASE, contact=contact)
    scaled = selfsimilar.moving_force(
        force=0.01 * stiffness,
        speed=0.1 * c_l,
        axial_stiffness=stiffness,
        mass=mass,
        prestrain=0.05,
        contact=contact,
    )
    assert scaled.strain == pytest.approx(unit.strain, rel=1e-13)  # roundings of the scaled data
    assert scaled.contact_velocity / c_l == pytest.approx(unit.contact_velocity, rel=1e-13)
    assert scaled.hold_force / stiffness == pytest.approx(unit.hold_force, rel=1e-11, abs=1e-16)


def test_no_force_leaves_the_string_straight() -> None:
    wave = selfsimilar.moving_force(**{**CASE, "force": 0.0})
    assert wave.strain == (0.05, 0.05)
    assert wave.angle == (0.0, 0.0)
    assert wave.contact_velocity == pytest.approx([0.105, 0.0], rel=1e-15)
    still = selfsimilar.transverse_impact(velocity=0.0, prestrain=0.0, **UNIT)
    assert still.strain == (0.0, 0.0)
    assert still.force == (0.0, 0.0)


def test_heavy_force_may_outrun_the_kinks_of_the_string_at_rest() -> None:
    wave = selfsimilar.moving_force(**{**CASE, "force": 0.5, "speed": 1.05 * KINK_AT_REST})
    assert KINK_AT_REST < wave.speed < wave.kink_speed[1]
    slack = selfsimilar.moving_force(**{**CASE, "force": 0.5, "prestrain": 0.0})
    assert np.max(np.abs(slack.jump_residual())) < 1e-15  # roundings of quantities below 1


@pytest.mark.parametrize(("prestrain", "speed"), [(0.0, 0.1), (0.05, 1.05 * KINK_AT_REST)])
def test_solution_is_the_one_that_grows_from_the_force_at_rest(prestrain: float, speed: float) -> None:
    """Newton's method could also end at angles that differ by whole turns."""
    wave = selfsimilar.moving_force(force=0.01, speed=speed, prestrain=prestrain, **UNIT)
    assert 0.0 < wave.angle[0] < wave.angle[1] < 0.5 * math.pi


@pytest.mark.parametrize("contact", CONTACTS)
@pytest.mark.parametrize(("force", "alpha"), [(1e-9, 1.0), (1e-6, 1.05), (1e-3, 1.05), (1e-3, 3.0), (0.01, 5.0)])
def test_speed_beyond_the_kink_is_refused(force: float, alpha: float, contact: selfsimilar.Contact) -> None:
    with pytest.raises(ValueError, match="kink"):
        selfsimilar.moving_force(force=force, speed=alpha * KINK_AT_REST, prestrain=0.05, contact=contact, **UNIT)


def test_speed_without_force_beyond_the_kink_is_refused() -> None:
    with pytest.raises(ValueError, match="not below that of the kink"):
        selfsimilar.moving_force(**{**CASE, "force": 0.0, "speed": KINK_AT_REST * (1 + 1e-12)})


def test_frictionless_contact_that_no_tension_holds_is_refused() -> None:
    with pytest.raises(ValueError, match="cannot be held"):
        selfsimilar.moving_force(**{**CASE, "force": 10.0}, contact="frictionless")


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"speed": -0.1}, "^speed must"),
        ({"speed": math.nan}, "^speed must"),
        ({"force": math.inf}, "^force must"),
        ({"axial_stiffness": 0.0}, "^axial_stiffness must"),
        ({"mass": -1.0}, "^mass must"),
        ({"prestrain": -0.01}, "^prestrain must"),
        ({"contact": "glued"}, "^contact must"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        selfsimilar.moving_force(**(CASE | changed))


def test_impact_without_a_velocity_is_refused() -> None:
    with pytest.raises(ValueError, match="velocity"):
        selfsimilar.transverse_impact(velocity=math.nan, prestrain=0.0, **UNIT)
