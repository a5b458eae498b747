"""A sprung body on a taut string: the infinite string's closed form, the finite one's delay equation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from closed_forms import strings
from ropewalk.theory import string

UNIT = {"length": 1.0, "tension": 1.0, "mass": 1.0, "gravity": 1.0}
BODY = {"sprung_mass": 0.7, "contact_mass": 0.3, "stiffness": 20.0, "damping": 0.4}


@pytest.mark.parametrize("contact_mass", [0.0, 0.3])
@pytest.mark.parametrize("damping", [0.0, 0.5])
def test_infinite_string_by_numerical_integration(contact_mass: float, damping: float) -> None:
    given = {"sprung_mass": 0.7, "contact_mass": contact_mass, "stiffness": 2.5, "damping": damping}
    resistance, gravity = 2.0 * np.sqrt(8.0 * 2.0), 9.81

    def spring(v: float, u: float, d: float) -> float:
        return 2.5 * d + damping * (u - v)

    def rates(_: float, z: np.ndarray) -> list[float]:
        _, v, u, d = z
        if contact_mass == 0.0:  # N = 2 rho c v = M g + f
            v = (0.7 * gravity + 2.5 * d + damping * u) / (resistance + damping)
            return [v, 0.0, -spring(v, u, d) / 0.7, u - v]
        push = (0.7 + contact_mass) * gravity + spring(v, u, d) - resistance * v
        return [v, push / contact_mass, -spring(v, u, d) / 0.7, u - v]

    t = np.linspace(0.0, 6.0, 25)
    run = solve_ivp(rates, (0.0, 6.0), np.zeros(4), t_eval=t, method="DOP853", rtol=1e-11, atol=1e-13)
    motion = strings.moving_oscillator_infinite(t, **given, tension=8.0, mass=2.0, gravity=gravity)
    w, _, u, d = run.y
    assert motion.deflection == pytest.approx(w, abs=1e-9)  # tolerance of the integration
    assert motion.body_deflection == pytest.approx(w + d, abs=1e-9)
    assert motion.body_velocity == pytest.approx(u, abs=1e-9)
    assert motion.contact_force == pytest.approx(resistance * motion.velocity, rel=1e-14)


def test_infinite_string_settles_under_the_weight() -> None:
    motion = strings.moving_oscillator_infinite([0.0, 400.0], **BODY, tension=1.0, mass=1.0, gravity=1.0)
    assert motion.contact_force == pytest.approx([0.0, 1.0], abs=1e-12)
    assert motion.body_velocity[1] == pytest.approx(0.5, abs=1e-12)
    assert motion.contact_lost_at is None
    assert motion.body_deflection[1] == pytest.approx(motion.deflection[1], rel=1e-12)


def test_light_wheel_under_a_stiff_spring_bounces_off() -> None:
    """Before the string matters the wheel moves as g (t + (M/m) sin(omega t)/omega), omega^2 = K/m + K/M."""
    omega = np.sqrt(1e4 / 0.1 + 1e4 / 0.9)
    t = np.linspace(0.0, 0.05, 2001)
    motion = strings.moving_oscillator_infinite(
        t, sprung_mass=0.9, contact_mass=0.1, stiffness=1e4, tension=1.0, mass=1.0, gravity=1.0
    )
    assert motion.contact_lost_at == t[np.flatnonzero(motion.contact_force < 0.0)[0]]
    phase = 3.4990  # first root of phase + 9 sin(phase)
    assert motion.contact_lost_at == pytest.approx(phase / omega, rel=0.02)  # the string takes 20/333 of a radian
    finite = string.moving_oscillator(0.02, sprung_mass=0.9, contact_mass=0.1, stiffness=1e4, speed=1.0 - 1e-9, **UNIT)
    assert finite.contact_lost_at == pytest.approx(motion.contact_lost_at, abs=3e-5)  # spacing of t


def test_critical_damping_has_no_full_set_of_modes() -> None:
    """Contact without mass, no damper: d'' + K d'/(2 rho c) + K d/M = 0 has a double root at K M = (4 rho c)^2."""
    given = {"sprung_mass": 2.0, "tension": 1.0, "mass": 1.0, "gravity": 1.0}
    t = np.linspace(0.0, 5.0, 6)
    at, below, above = (
        strings.moving_oscillator_infinite(t, **given, stiffness=8.0 * (1.0 + step)) for step in (0.0, -1e-4, 1e-4)
    )
    for name in ("deflection", "contact_force", "body_deflection"):
        middle = 0.5 * (getattr(below, name) + getattr(above, name))
        assert getattr(at, name) == pytest.approx(middle, abs=1e-7), name  # second differences


@pytest.mark.parametrize("contact_mass", [0.0, 0.3])
def test_finite_string_is_the_infinite_one_until_waves_return_from_the_start(contact_mass: float) -> None:
    """Just below the wave speed the support behind sends nothing back in time: beta tends to 0."""
    given = BODY | {"contact_mass": contact_mass}
    t = np.array([0.1, 0.5, 0.95])
    finite = string.moving_oscillator(t, **given, speed=1.0 - 1e-12, **UNIT)
    infinite = strings.moving_oscillator_infinite(t, **given, tension=1.0, mass=1.0, gravity=1.0)
    for name in ("deflection", "velocity", "body_deflection", "body_velocity", "contact_force"):
        assert getattr(finite, name) == pytest.approx(getattr(infinite, name), abs=1e-9), name


@pytest.mark.parametrize("contact_mass", [0.0, 0.3])
@pytest.mark.parametrize("speed", [0.5, 0.8])
def test_string_under_the_contact_force_moves_as_the_contact(speed: float, contact_mass: float) -> None:
    """The image sum, which knows nothing of delays; and the momentum of both masses."""
    given = BODY | {"contact_mass": contact_mass}
    last = 0.9 / speed

    def force(s: np.ndarray) -> np.ndarray:
        return string.moving_oscillator(np.minimum(s, last), **given, speed=speed, **UNIT).contact_force

    t = np.linspace(0.0, last, 6)
    motion = string.moving_oscillator(t, **given, speed=speed, **UNIT)
    under = string.travelling_force(
        speed * t, t, path=lambda s: speed * s, force=force, length=1.0, tension=1.0, mass=1.0
    )
    assert under == pytest.approx(motion.deflection, abs=1e-9)  # tolerance of the march
    fine = (np.arange(40000) + 0.5) * last / 40000
    impulse = np.sum(0.7 + contact_mass - force(fine)) * last / 40000
    momentum = 0.7 * motion.body_velocity[-1] + contact_mass * motion.velocity[-1]
    assert momentum == pytest.approx(impulse, abs=3e-4)  # midpoints over jumps


def test_no_spring_is_a_moving_force() -> None:
    t = np.linspace(0.0, 2.0, 21)
    motion = string.moving_oscillator(t, sprung_mass=2.0, stiffness=0.0, speed=0.5, **UNIT)
    force = string.moving_force_path(t[:-1], force=2.0, speed=0.5, length=1.0, tension=1.0, mass=1.0)
    assert motion.deflection[:-1] == pytest.approx(force, abs=1e-12)
    assert motion.contact_force == pytest.approx(np.full(21, 2.0), rel=1e-9)
    assert motion.body_velocity == pytest.approx(np.zeros(21), abs=1e-12)


def test_stiff_spring_tends_to_one_mass() -> None:
    t = np.linspace(0.1, 1.8, 7)
    rigid = string.moving_mass(t, load_mass=1.0, speed=0.5, **UNIT)
    gap = []
    for stiffness in (1e3, 1e5):
        damping = 0.5 * np.sqrt(stiffness)
        motion = string.moving_oscillator(t, sprung_mass=0.5, contact_mass=0.5, stiffness=stiffness, damping=damping,
                                          speed=0.5, **UNIT)  # fmt: skip
        gap.append(np.max(np.abs(motion.deflection - rigid.deflection)))
    assert gap[1] < 0.2 * gap[0] < 0.01  # falls as one over sqrt(stiffness) or faster


@settings(deadline=None, max_examples=10)
@given(
    st.floats(0.4, 0.95),
    st.sampled_from([0.0, 5e-324, 1e-3, 0.5, 1e9]),
    st.floats(0.0, 50.0),
    st.floats(0.0, 3.0),
    st.floats(0.1, 20.0),
)
def test_linear_in_gravity_and_never_nan(
    speed: float, contact_mass: float, stiffness: float, damping: float, gravity: float
) -> None:
    given = {"sprung_mass": 1.0, "contact_mass": contact_mass, "stiffness": stiffness, "damping": damping,
             "speed": speed}  # fmt: skip
    t = np.array([0.0, 0.3, 0.8, 1.0]) / speed
    one = string.moving_oscillator(t, **given, **UNIT)
    other = string.moving_oscillator(t, **given, **(UNIT | {"gravity": gravity}))
    assert other.body_deflection == pytest.approx(gravity * one.body_deflection, rel=1e-12, abs=1e-300)
    assert not np.isnan([one.contact_force, one.velocity, one.deflection]).any()


def test_units_scale() -> None:
    """Length 3 m, 5 N, 0.8 kg/m: the same string with time in L/c, force in tension, mass in rho L."""
    time, gravity = 3.0 / 2.5, 9.81
    own = {"sprung_mass": 0.7 * 2.4, "contact_mass": 0.3 * 2.4, "stiffness": 20.0 * 5.0 / 3.0, "damping": 0.4 * 2.0}
    t = np.array([0.2, 0.9, 1.7])
    real = string.moving_oscillator(t * time, **own, speed=0.5 * 2.5, length=3.0, tension=5.0, mass=0.8)
    unit = string.moving_oscillator(t, **BODY, speed=0.5, **UNIT)
    assert real.deflection == pytest.approx(gravity * time**2 * unit.deflection, rel=1e-11)
    assert real.body_deflection == pytest.approx(gravity * time**2 * unit.body_deflection, rel=1e-11)
    assert real.velocity == pytest.approx(gravity * time * unit.velocity, rel=1e-11)
    assert real.body_velocity == pytest.approx(gravity * time * unit.body_velocity, rel=1e-11)
    assert real.contact_force == pytest.approx(gravity * 2.4 * unit.contact_force, rel=1e-11)


@pytest.mark.parametrize("speed", [0.0, 1.0, 2.5])
def test_standing_or_fast_load_does_not_move(speed: float) -> None:
    motion = string.moving_oscillator([0.0, 0.4], **BODY, speed=speed, **UNIT)
    assert np.all(motion.deflection == 0.0)
    assert np.all(motion.contact_force == 1.0)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"sprung_mass": 0.0}, "^sprung_mass must"),
        ({"contact_mass": -1.0}, "^contact_mass must"),
        ({"stiffness": np.nan}, "^stiffness must"),
        ({"damping": -1.0}, "^damping must"),
        ({"mass": 0.0}, "^mass must"),
        ({"speed": 0.01}, "at least 0.02"),
        ({"t": 3.0}, "^t must"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, float], said: str) -> None:
    arguments = {"t": 1.0, "speed": 0.5} | BODY | UNIT | changed
    with pytest.raises(ValueError, match=said):
        string.moving_oscillator(arguments.pop("t"), **arguments)
