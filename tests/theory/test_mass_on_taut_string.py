"""A mass on a taut string with mass: the delay equation against its exact series, the image sum and Galerkin's method.

Deflections in units of m g L/P, kappa = 2 rho L/m. Reference numbers are derived in docs/notes.
"""

import time
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from closed_forms import strings
from ropewalk.theory import string

UNIT = {"length": 1.0, "tension": 1.0, "mass": 1.0, "gravity": 1.0}


def passage(place: np.ndarray | list[float] | float, alpha: float, kappa: float) -> string.MassPassage:
    """On a string of 3 m, 5 N, 0.8 kg/m under g = 9.81; deflection in m g L/P, force in m g, velocity in m g/(2 rho c),
    time in L/V."""
    c, mass = 2.5, 2.0 * 0.8 * 3.0 / kappa
    t = np.asarray(place) * 3.0 / (alpha * c)
    motion = string.moving_mass(t, load_mass=mass, speed=alpha * c, length=3.0, tension=5.0, mass=0.8)
    lost = None if motion.contact_lost_at is None else motion.contact_lost_at * alpha * c / 3.0
    weight = mass * 9.81
    return string.MassPassage(
        motion.deflection / (weight * 3.0 / 5.0),
        motion.velocity / (weight / (2.0 * 0.8 * c)),
        motion.contact_force / weight,
        lost,
    )


def series(alpha: float, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Velocity in m g/(2 rho c) and its integral over tau = t/T0 until the first wave comes back from the far end."""
    beta = (1.0 - alpha) / (1.0 + alpha)
    term, v, path = np.asarray(tau, dtype=float), np.zeros_like(tau), np.zeros_like(tau)
    for k in range(1, 80):
        v, path = v + term, path + term * tau / (k + 1)
        term = -term * tau / ((k + 1) * (1.0 - beta ** (k + 1)))
    return v, path


@pytest.mark.parametrize(
    ("alpha", "kappa", "place", "deflection"),
    [
        (0.5, 2.0, 0.1, 0.01728790107248517),
        (0.5, 2.0, 0.25, 0.088190205746976),
        (0.5, 2.0, 0.5, 0.2612362397707865),
        (0.8, 2.0, 0.25, 0.039957755767492),
        (0.8, 2.0, 0.5, 0.1333886654582961),
        (0.2, 2.0, 0.1, 0.07110279440190522),
        (0.2, 2.0, 0.25, 0.2222146027873685),
        (0.5, 0.5, 0.1, 0.004817270842105381),
        (0.5, 0.5, 0.25, 0.02850122303016951),
        (0.5, 0.5, 0.5, 0.1043208696099338),
    ],
)
def test_path_before_the_first_reflection(alpha: float, kappa: float, place: float, deflection: float) -> None:
    assert passage(place, alpha, kappa).deflection == pytest.approx(
        deflection, abs=1e-15
    )  # 15 to 16 digits are given, and roundings


@pytest.mark.parametrize(
    ("alpha", "kappa", "place", "deflection"),
    [
        (0.5, 2.0, 0.75, 0.4441557),
        (0.5, 2.0, 0.9, 0.445899),
        (0.8, 2.0, 0.75, 0.2549321),
        (0.8, 2.0, 0.9, 0.335346),
        (0.2, 2.0, 0.5, 0.312407),
        (0.2, 2.0, 0.75, 0.167982),
        (0.2, 2.0, 0.9, 0.100613),
        (0.5, 0.5, 0.75, 0.2146828),
        (0.5, 0.5, 0.9, 0.280308),
    ],
)
def test_path_after_the_first_reflection(alpha: float, kappa: float, place: float, deflection: float) -> None:
    assert passage(place, alpha, kappa).deflection == pytest.approx(deflection, abs=2e-6)  # as the reference was given


@pytest.mark.parametrize(
    ("alpha", "kappa", "deflection"), [(0.5, 2.0, 0.2738), (0.8, 2.0, 0.3467), (0.2, 2.0, 0.0125), (0.5, 0.5, 0.2946)]
)
def test_load_does_not_end_at_the_support(alpha: float, kappa: float, deflection: float) -> None:
    end = passage([1.0, 1.0 - 1e-9], alpha, kappa)
    assert end.deflection == pytest.approx([deflection] * 2, abs=1e-3)  # as the reference was given
    assert end.deflection[0] == pytest.approx(end.deflection[1], abs=1e-6)  # a limit, approached as r log r
    assert np.isinf(end.contact_force[0])
    assert end.velocity[0] == -end.contact_force[0]  # m y'' = -N
    beta = (1.0 - alpha) / (1.0 + alpha)
    left = 1e-4 * beta ** ((np.arange(400) + 0.5) / 400)  # from one meeting with the bouncing wave to the next
    mean = np.mean(passage(1.0 - left, alpha, kappa).contact_force * left)
    assert np.sign(end.contact_force[0]) == np.sign(mean) == np.sign(deflection)


def test_contact_force() -> None:
    force = passage([0.1, 0.25, 0.5, 0.75, 0.9], 0.5, 2.0).contact_force
    early = [0.3679839184350227, 0.6969893032601512, 0.9342479861425337]
    assert force[:3] == pytest.approx(early, abs=3e-15)  # 16 digits are given
    assert force[3:] == pytest.approx([2.468469, 4.812715], abs=2e-6)  # as the reference was given


def test_force_grows_as_the_inverse_of_the_way_left() -> None:
    """Times a function that repeats itself from one meeting with the bouncing wave to the next, beta = 1/3."""
    left = 2e-2 * np.array([1.0, 1.3, 2.1])[:, np.newaxis] / 3.0 ** np.array([6, 9, 12])
    force = passage(1.0 - left, 0.5, 2.0).contact_force * left
    assert force[:, 1] == pytest.approx(force[:, 2], rel=2e-3)  # the rest falls as left times its logarithm
    assert force[:, 0] == pytest.approx(force[:, 2], rel=2e-2)


@settings(deadline=None, max_examples=15)
@given(st.floats(0.3, 0.99), st.floats(0.05, 4.0), st.floats(0.0, 1.0))
def test_start_is_the_exact_series(alpha: float, kappa: float, part: float) -> None:
    place = part * 2.0 * alpha / (1.0 + alpha)
    age = kappa * place / alpha
    beta = (1.0 - alpha) / (1.0 + alpha)
    v, path = series(alpha, np.array(age))
    motion = passage(place, alpha, kappa)
    noise = 1e-15 * np.exp(2.0 * np.sqrt(age / (1.0 - beta))) + 3e-13  # terms of the series cancel; last coefficients
    assert motion.velocity == pytest.approx(float(v), abs=noise)
    assert motion.deflection * 2.0 * kappa == pytest.approx(float(path), abs=8.0 * noise)


@pytest.mark.parametrize(("alpha", "load_mass"), [(0.3, 3.0), (0.5, 1.0), (0.7, 0.2), (0.97, 1.0)])
def test_string_under_the_contact_force_moves_as_the_load(alpha: float, load_mass: float) -> None:
    """The image sum, which knows nothing of delays, gives the deflection at the load; Newton gives the load's."""
    last = 0.9 / alpha

    def force(s: np.ndarray) -> np.ndarray:
        return string.moving_mass(np.minimum(s, last), load_mass=load_mass, speed=alpha, **UNIT).contact_force

    t = np.linspace(0.0, last, 8)
    motion = string.moving_mass(t, load_mass=load_mass, speed=alpha, **UNIT)
    under = string.travelling_force(
        alpha * t, t, path=lambda s: alpha * s, force=force, length=1.0, tension=1.0, mass=1.0
    )
    assert under == pytest.approx(motion.deflection, abs=1e-9 * load_mass)  # tolerance of the march
    fine = np.linspace(0.0, last, 20001)
    pull = load_mass - string.moving_mass(fine, load_mass=load_mass, speed=alpha, **UNIT).contact_force
    gained = np.sum(0.5 * (pull[1:] + pull[:-1])) * fine[1] / load_mass
    assert gained == pytest.approx(motion.velocity[-1], abs=1e-5)  # trapezoids over kinks


def galerkin(modes: int, alpha: float, place: float) -> float:
    """The twin that the package does not use: modes of the string with the mass's convective terms, m = 1."""
    k = np.pi * np.arange(1, modes + 1)

    def rates(t: float, z: np.ndarray) -> np.ndarray:
        q, p = z[:modes], z[modes:]
        sine, cosine = np.sin(k * alpha * t), np.cos(k * alpha * t)
        convective = 2.0 * alpha * (k * cosine) @ p - alpha**2 * (k**2 * sine) @ q
        right = -(k**2) * q + 2.0 * sine * (1.0 - convective)
        return np.concatenate([p, right - 2.0 * sine * (sine @ right) / (1.0 + 2.0 * sine @ sine)])

    run = solve_ivp(rates, (0.0, place / alpha), np.zeros(2 * modes), method="DOP853", rtol=1e-8, atol=1e-10)
    return float(np.sin(k * place) @ run.y[:modes, -1])


def test_galerkins_method_converges_to_the_delay_equation_but_only_as_one_over_modes() -> None:
    exact = float(passage(0.5, 0.5, 2.0).deflection)
    error = {modes: exact - galerkin(modes, 0.5, 0.5) for modes in (25, 50, 100)}
    assert exact - error[50] == pytest.approx(0.25806, abs=5.1e-6)  # 5 digits are given
    for coarse, fine in pairwise(error):
        rate = np.log2(error[coarse] / error[fine])
        print(f"{coarse} to {fine} modes: order {rate:.3f}")
        assert 0.95 < rate < 1.1  # 1.05 and 1.04 when written


def test_infinite_string_and_the_limit_of_the_wave_speed() -> None:
    t = np.array([0.0, 1e-9, 0.0299, 0.0301, 1.0, 60.0])
    motion = strings.moving_mass_infinite(t, load_mass=2.0, tension=8.0, mass=2.0, gravity=3.0)
    age = t / 0.25  # T0 = m/(2 rho c)
    assert motion.contact_force == pytest.approx(-6.0 * np.expm1(-age), rel=1e-15)
    assert motion.velocity == pytest.approx(-6.0 / 8.0 * np.expm1(-age), rel=1e-15)
    terms = np.cumprod(-np.minimum(age, 1.0)[:, np.newaxis] / np.arange(1, 25), axis=1)[:, 1:]
    path = np.where(age < 1.0, np.sum(terms, axis=1), age + np.expm1(-age))
    assert motion.deflection == pytest.approx(3.0 * 0.25**2 * path, rel=1e-13)
    around = strings.moving_mass_infinite([0.03 * 0.25 * (1 - 1e-9), 0.03 * 0.25 * (1 + 1e-9)], load_mass=2.0,
                                         tension=8.0, mass=2.0, gravity=3.0).deflection  # fmt: skip
    assert around[0] == pytest.approx(around[1], rel=5e-9)  # twice the step of 2e-9, and no jump between the forms
    fast = string.moving_mass([0.2, 0.9], load_mass=1.0, speed=1.0 - 1e-12, **UNIT)
    free = strings.moving_mass_infinite([0.2, 0.9], load_mass=1.0, tension=1.0, mass=1.0, gravity=1.0)
    assert fast.deflection == pytest.approx(free.deflection, abs=1e-11)
    assert fast.contact_force == pytest.approx(free.contact_force, abs=1e-11)


@pytest.mark.parametrize("alpha", [1.0, 1.0 + 1e-12, 1.7, 40.0])
def test_at_and_above_the_wave_speed_the_load_meets_a_string_at_rest(alpha: float) -> None:
    motion = passage([0.0, 0.5, 1.0], alpha, 2.0)
    assert np.all(motion.deflection == 0.0)
    assert np.all(motion.velocity == 0.0)
    assert motion.contact_force == pytest.approx(np.ones(3), rel=1e-15)
    assert motion.contact_lost_at is None


def test_contact_is_lost_where_the_force_turns_negative() -> None:
    motion = passage(0.5, 0.2, 2.0)
    lost = motion.contact_lost_at
    assert lost == pytest.approx(0.95312475, abs=1e-7)  # seen with smaller tolerances of the march
    before, at, after = passage([lost - 1e-6, lost, lost + 1e-6], 0.2, 2.0).contact_force
    assert before > 0.0 > after
    assert at == pytest.approx(0.0, abs=1e-6)
    earlier = passage(np.linspace(0.0, lost - 1e-6, 4001), 0.2, 2.0).contact_force
    assert np.min(earlier) > -1e-12
    assert passage(0.5, 0.5, 2.0).contact_lost_at is None
    assert passage(0.5, 0.8, 2.0).contact_lost_at is None  # not at the start either, where N = 0 up to rounding


@pytest.mark.parametrize("lam", [1.0, 8.0])
def test_light_string_tends_to_the_massless_one(lam: float) -> None:
    place = np.array([0.25, 0.5, 0.75, 0.9])
    limit = string.moving_mass(place * np.sqrt(lam), load_mass=1.0, speed=1.0 / np.sqrt(lam), length=1.0, tension=1.0,
                               mass=0.0, gravity=1.0)  # fmt: skip
    gap = []
    for mass in (0.02, 0.005):
        motion = string.moving_mass(place * np.sqrt(lam), load_mass=1.0, speed=1.0 / np.sqrt(lam), length=1.0,
                                    tension=1.0, mass=mass, gravity=1.0)  # fmt: skip
        gap.append(np.max(np.abs(motion.deflection - limit.deflection)))
    assert gap[1] < 0.4 * gap[0] < 0.02  # the gap falls with the mass of the string


@pytest.mark.parametrize("load_mass", [1e-12, 1e-5])
def test_light_load_moves_as_its_weight_would(load_mass: float) -> None:
    t = np.linspace(0.1, 1.9, 7)
    motion = string.moving_mass(t, load_mass=load_mass, speed=0.5, **UNIT)
    force = string.moving_force_path(t, force=1.0, speed=0.5, length=1.0, tension=1.0, mass=1.0)
    assert motion.deflection / load_mass == pytest.approx(force, abs=10.0 * load_mass + 1e-9)


@pytest.mark.parametrize("load_mass", [1e6, 1e12])
def test_heavy_load_falls_freely(load_mass: float) -> None:
    t = np.array([0.0, 0.1, 1.0, 1.9, 2.0])
    motion = string.moving_mass(t, load_mass=load_mass, speed=0.5, **UNIT)
    assert motion.deflection == pytest.approx(0.5 * t**2, rel=10.0 / load_mass, abs=20.0 / load_mass)
    assert not np.isnan([motion.contact_force, motion.velocity]).any()


def test_standing_load_and_gravity_scale() -> None:
    still = string.moving_mass([0.0, 7.0], load_mass=2.0, speed=0.0, **UNIT)
    assert np.all(still.deflection == 0.0)
    assert np.all(still.contact_force == 2.0)
    once = string.moving_mass(1.2, load_mass=1.0, speed=0.5, **UNIT)
    thrice = string.moving_mass(1.2, load_mass=1.0, speed=0.5, **(UNIT | {"gravity": 3.0}))
    assert thrice.deflection == pytest.approx(3.0 * float(once.deflection), rel=1e-15)
    assert thrice.contact_force == pytest.approx(3.0 * float(once.contact_force), rel=1e-15)
    assert once.deflection.shape == ()


def test_passage_at_half_the_wave_speed_is_quick() -> None:
    spent = []
    for _ in range(3):
        start = time.process_time()
        string.moving_mass(1.0, load_mass=1.0, speed=0.5, **UNIT)
        spent.append(time.process_time() - start)
    assert min(spent) < 0.5  # 0.02 s when written


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"speed": 0.019}, "at least 0.02"),
        ({"load_mass": np.inf}, "^load_mass must"),
        ({"tension": np.nan}, "^tension must"),
        ({"mass": -1.0}, "^mass must"),
        ({"gravity": 0.0}, "^gravity must"),
        ({"t": 2.01}, "length/speed = 2 s"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, float], said: str) -> None:
    arguments = {"t": 1.0, "load_mass": 1.0, "speed": 0.5} | UNIT | changed
    with pytest.raises(ValueError, match=said):
        string.moving_mass(arguments.pop("t"), **arguments)


def test_infinite_string_refuses_nonsense() -> None:
    with pytest.raises(ValueError, match=r"^t must"):
        strings.moving_mass_infinite(-1.0, load_mass=1.0, tension=1.0, mass=1.0)
    with pytest.raises(ValueError, match=r"^load_mass must"):
        strings.moving_mass_infinite(1.0, load_mass=0.0, tension=1.0, mass=1.0)
