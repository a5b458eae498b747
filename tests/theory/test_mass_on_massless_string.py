"""A mass on a massless string: Smith 1964; Dyniewicz and Bajer 2009; the paradox at the end support.

Deflections in units of m g L/P, ``lam = P L/(m V^2)``. Reference numbers are derived in docs/notes.
"""

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from ropewalk.theory import _massless, string
from ropewalk.theory._massless import contact_lost, shape

PLACES = np.array([0.25, 0.5, 0.75, 0.9, 1.0])
TABLE = {
    1: (0.0297900552525951, 0.111523075670698, 0.225793329256423, 0.289877029119572, 0.296675134743591),
    3: (0.0812024805595766, 0.265773227560426, 0.430300067848398, 0.422996708444314, 0.259139775251689),
    8: (0.170332549775333, 0.39598124731258, 0.345910888687183, 0.124686204000131, -0.048838147117021),
    50: (0.187560040516801, 0.278107573156461, 0.174785768971776, 0.109483208134133, -0.00637551382828719),
}


def passage(xi: np.ndarray | float, lam: float) -> string.MassPassage:
    """On a string of 3 m under 5 N, with a mass of 2 kg and g = 9.81; lengths in m g L/P, forces in m g."""
    speed = np.sqrt(5.0 * 3.0 / 2.0 / lam)
    t = np.asarray(xi) * 3.0 / speed
    unit = 2.0 * 9.81 * 3.0 / 5.0
    motion = string.moving_mass(t, load_mass=2.0, speed=speed, length=3.0, tension=5.0, mass=0.0)
    lost = None if motion.contact_lost_at is None else motion.contact_lost_at * speed / 3.0
    return string.MassPassage(
        motion.deflection / unit, motion.velocity / unit * 3.0 / speed, motion.contact_force / (2.0 * 9.81), lost
    )


@pytest.mark.parametrize("lam", TABLE)
def test_path(lam: int) -> None:
    assert passage(PLACES, lam).deflection == pytest.approx(TABLE[lam], abs=3e-15)  # 15 digits are given


@pytest.mark.parametrize(
    ("lam", "place"),
    [
        (7, 0.98219338260575),
        (8, 0.966176051035418),
        (9, 0.954301885450633),
        (10, 0.948560305195002),
        (11, 0.95298369757745),
    ],
)
def test_contact_is_lost(lam: float, place: float) -> None:
    assert passage(0.5, lam).contact_lost_at == pytest.approx(place, abs=2e-14)  # 14 digits are given


@pytest.mark.parametrize("lam", [0.1, 1.0, 2.0, 5.9, 6.0, 12.0, 16.0, 20.0])
def test_contact_is_kept(lam: float) -> None:
    assert contact_lost(lam) is None


@pytest.mark.parametrize("lam", [6.001, 11.999, 20.5, 95.0, 1.0e6, 1.2e8])
def test_force_changes_sign_where_contact_is_lost(lam: float) -> None:
    place = contact_lost(lam)
    if place is None:  # the degree's fraction decides
        a = 0.5 * (np.sqrt(1.0 + 4.0 * lam) - 1.0)
        assert np.sin(np.pi * a) < 0.0
        return
    gap = 1e-3 * (1.0 - place)
    before, after = shape(lam, np.array([place - gap, place + gap]))[0]
    assert before > 0.0 > after


@settings(deadline=None, max_examples=30)
@given(st.floats(0.01, 300.0))
def test_end_value_is_the_paradox(lam: float) -> None:
    a = 0.5 * (np.sqrt(1.0 + 4.0 * lam) - 1.0)
    end = passage(1.0, lam)
    if abs(lam - 2.0) > 1e-3:
        # rounding of sin(pi a), magnified near lam = 2
        assert end.deflection == pytest.approx(-np.sin(np.pi * a) / (np.pi * (lam - 2.0)), abs=1e-12)
    close = passage(1.0 - 1e-12, lam)
    # the slope is logarithmic, at most 30 lam times 1e-12 away
    assert close.deflection == pytest.approx(float(end.deflection), abs=1e-10 * max(lam, 1.0))
    assert not np.isnan([end.velocity, end.contact_force]).any()


@pytest.mark.parametrize("lam", [6.0, 12.0, 20.0, 30.0])
def test_whole_degrees_are_polynomials_and_end_at_the_support(lam: float) -> None:
    xi = np.linspace(0.0, 1.0, 21)
    polynomial = {
        6.0: 3.0 * xi**2 * (1.0 - xi),
        12.0: 6.0 * xi**2 * (1.0 - xi) ** 2,
        20.0: 20.0 / 18.0 * xi * (1 - xi) * (1.0 - (1.0 - 9.0 * xi + 21.0 * xi**2 - 14.0 * xi**3)),
        30.0: 30.0 / 28.0 * xi * (1 - xi) * (1.0 - (1.0 - 14.0 * xi + 56.0 * xi**2 - 84.0 * xi**3 + 42.0 * xi**4)),
    }[lam]
    motion = passage(xi, lam)
    assert motion.deflection == pytest.approx(polynomial, abs=1e-13)  # interpolated in the degree
    expected_end = {6.0: 3.0, 12.0: 0.0, 20.0: 20.0 / 9.0, 30.0: 0.0}[lam]
    assert motion.contact_force[-1] == pytest.approx(expected_end, abs=1e-12)
    assert motion.velocity[-1] == pytest.approx(-expected_end, abs=1e-12)


def test_degenerate_ratio_two() -> None:
    assert passage(1.0, 2.0).deflection == pytest.approx(1.0 / 3.0, abs=1e-14)
    around = [passage(PLACES, 2.0 + step).deflection for step in (-1e-9, 0.0, 1e-9)]
    assert around[1] == pytest.approx(0.5 * (around[0] + around[2]), abs=1e-13)  # smooth, nothing cancels


@pytest.mark.parametrize("lam", [1e-7, 0.02, 0.7, 1.97, 2.0, 2.03, 5.93, 5.999, 6.02, 33.3, 400.0])
def test_newtons_law(lam: float) -> None:
    xi = np.array([0.02, 0.2, 0.5, 0.8, 0.97])
    start = 1e-4
    first = [0.5 * lam * start**2 - lam**2 * start**3 / 12.0, lam * start - 0.25 * (lam * start) ** 2]

    def law(x: float, z: np.ndarray) -> list[float]:
        return [z[1], lam - lam * z[0] / (x * (1.0 - x))]

    direct = solve_ivp(law, (start, xi[-1]), first, t_eval=xi, method="DOP853", rtol=1e-12, atol=1e-14 * min(lam, 1.0))
    motion = passage(xi, lam)
    scale = min(lam, 1.0)
    # the start leaves out (lam xi)^2 of a term that is 1e-4 xi lam
    assert motion.deflection == pytest.approx(direct.y[0], abs=1e-9 * scale * max(lam, 1.0))
    assert motion.velocity == pytest.approx(direct.y[1], abs=1e-8 * scale * max(lam, 1.0))
    assert motion.contact_force == pytest.approx(direct.y[0] / (xi * (1.0 - xi)), abs=1e-7 * scale * max(lam, 1.0))


@pytest.mark.parametrize("degree", [8000.3, 9999.7])
def test_recurrence_meets_the_leading_terms(degree: float) -> None:
    """Where the degree passes 1e4 the method changes, and the result must not."""
    xi = np.array([1e-9, 1e-4, 0.3, 0.5, 0.51, 0.99, 1.0 - 1e-7])
    climbed = _massless._rise(degree, xi)
    leading = _massless._leading_terms(degree, degree * (degree + 1.0), xi)
    assert leading[0] == pytest.approx(climbed[0], abs=2e-11)  # a^(-5/2)/8, the term left out
    assert leading[1] == pytest.approx(climbed[1], abs=2e-10)  # a^(-5/2), the term left out


@pytest.mark.parametrize("speed", [1e-3, 1e-5, 1e-9, 1e-40, 1e-170, 1e-300])
def test_slow_load_runs_along_the_static_deflection(speed: float) -> None:
    unit = {"load_mass": 1.0, "speed": speed, "length": 1.0, "tension": 1.0, "mass": 0.0, "gravity": 1.0}
    motion = string.moving_mass(np.array([0.0, 0.25, 0.5, 1.0]) / speed, **unit)
    assert motion.deflection == pytest.approx(
        [0.0, 0.1875, 0.25, 0.0], abs=2.0 * speed**1.5 + 1e-15
    )  # waves ~ lam^-3/4
    assert motion.contact_force[1:3] == pytest.approx([1.0, 1.0], abs=20.0 * speed**1.5 + 1e-14)
    assert not np.isnan([motion.velocity, motion.contact_force]).any()


@pytest.mark.parametrize("lam", [1e-12, 1e-30])
def test_very_heavy_or_fast_load_falls_freely(lam: float) -> None:
    xi = np.array([1e-3, 0.5, 0.9, 1.0])
    assert passage(xi, lam).deflection == pytest.approx(0.5 * lam * xi**2, rel=1e-11)


def test_standing_load_stays_on_its_support() -> None:
    motion = string.moving_mass([0.0, 1e9], load_mass=2.0, speed=0.0, length=1.0, tension=1.0, mass=0.0)
    assert np.all(motion.deflection == 0.0)
    assert np.all(motion.contact_force == 2.0 * 9.81)


def test_large_ratio_takes_well_under_a_second_and_the_shape_is_kept() -> None:
    start = time.process_time()
    motion = passage(np.full((3, 2), 0.4), 9.9e7)
    assert time.process_time() - start < 6.0  # 0.9 s when written
    assert motion.deflection.shape == motion.velocity.shape == motion.contact_force.shape == (3, 2)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"load_mass": 0.0}, "^load_mass must"),
        ({"gravity": -1.0}, "^gravity must"),
        ({"speed": -1.0}, "^speed must"),
        ({"length": np.inf}, "^length must"),
        ({"tension": 0.0}, "^tension must"),
        ({"mass": -1.0}, "^mass must"),
        ({"t": 2.1}, "length/speed = 2 s"),
        ({"t": -0.1}, "^t must lie in the passage"),
        ({"t": np.nan}, "^t must lie in the passage"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, float], said: str) -> None:
    arguments = {"t": 1.0, "load_mass": 1.0, "speed": 0.5, "length": 1.0, "tension": 1.0, "mass": 0.0} | changed
    with pytest.raises(ValueError, match=said):
        string.moving_mass(arguments.pop("t"), **arguments)
