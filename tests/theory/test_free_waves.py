"""Dispersion of strings and beams: Graff, Wave Motion in Elastic Solids; critical speeds: Timoshenko, Fryba."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ropewalk.theory import waves

RAIL = {"mass": 60.21, "bending_stiffness": 6.4155e6, "foundation": 1e7}
STRING = {"mass": 2.0, "tension": 8.0}  # wave speed 2

masses = st.floats(0.1, 10.0)
stiffnesses = st.floats(0.0, 10.0)
numbers = st.floats(0.05, 20.0)


@st.composite
def lines(draw: st.DrawFn) -> dict[str, float]:
    line = {
        "mass": draw(masses),
        "tension": draw(stiffnesses),
        "bending_stiffness": draw(stiffnesses),
        "foundation": draw(stiffnesses),
    }
    assume(line["tension"] > 1e-3 or line["bending_stiffness"] > 1e-3)
    return line


@pytest.mark.parametrize(("tension", "speed"), [(0.0, 515.808282609), (5e5, 523.796193956)])
def test_timoshenko_critical_speed_is_the_minimum_phase_velocity(tension: float, speed: float) -> None:
    rail = RAIL | {"tension": tension}
    least = waves.minimum_phase_velocity(**rail)
    assert least == pytest.approx(speed, abs=6e-10)  # 12 digits are given
    at = (1e7 / 6.4155e6) ** 0.25
    assert waves.phase_velocity(at, **rail) == pytest.approx(least, rel=1e-14)
    assert waves.group_velocity(at, **rail) == pytest.approx(least, rel=1e-14)
    assert np.all(waves.phase_velocity(at * np.array([0.9, 1.1]), **rail) > least)


def test_string_waves_all_travel_at_the_wave_speed() -> None:
    k = np.array([-3.0, 0.5, 40.0])
    assert waves.frequency(k, **STRING) == pytest.approx(2.0 * np.abs(k))
    assert waves.phase_velocity(k, **STRING) == pytest.approx(2.0 * np.sign(k))
    assert waves.group_velocity(k, **STRING) == pytest.approx(2.0 * np.sign(k))
    assert waves.wavenumbers(3.0, **STRING) == pytest.approx([1.5])
    hardly_a_beam = waves.wavenumbers(3.0, bending_stiffness=5e-324, **STRING)
    assert hardly_a_beam[0] == pytest.approx(1.5)
    assert hardly_a_beam[1].imag == -np.inf
    assert waves.minimum_phase_velocity(**STRING) == pytest.approx(2.0)


def test_beam_waves_travel_at_twice_their_phase_velocity() -> None:
    beam = {"mass": 3.0, "bending_stiffness": 12.0}
    assert waves.frequency(1.5, **beam) == pytest.approx(2.0 * 1.5**2)
    assert waves.group_velocity(1.5, **beam) == pytest.approx(2.0 * waves.phase_velocity(1.5, **beam))
    assert waves.wavenumbers(8.0, **beam) == pytest.approx([2.0, -2.0j])


@settings(deadline=None)
@given(lines(), numbers)
def test_group_velocity_is_the_slope_of_the_frequency(line: dict[str, float], k: float) -> None:
    step = 1e-4 * k
    rise = waves.frequency(np.array([k - 2 * step, k - step, k + step, k + 2 * step]), **line)
    slope = (rise[0] - 8 * rise[1] + 8 * rise[2] - rise[3]) / (12 * step)
    scale = waves.frequency(k, **line) / k
    # rounding of the differences over 1e-4
    assert waves.group_velocity(k, **line) == pytest.approx(slope, abs=1e-10 * scale)


@settings(deadline=None)
@given(lines(), numbers)
def test_waves_are_symmetric_and_the_inverse_inverts(line: dict[str, float], k: float) -> None:
    omega = waves.frequency(k, **line)
    assert waves.frequency(-k, **line) == omega
    assert waves.group_velocity(-k, **line) == pytest.approx(-waves.group_velocity(k, **line), rel=1e-15)  # k^3
    assert omega == pytest.approx(k * waves.phase_velocity(k, **line), rel=1e-14)
    back = waves.wavenumbers(omega, **line)
    stiffness = line["bending_stiffness"] * k**4 + line["tension"] * k**2
    # the root of omega^2 - foundation/mass, which cancels
    lost = (stiffness + line["foundation"]) / stiffness
    assert back[0] == pytest.approx(k, rel=1e-14 * lost)
    assert np.all(back.imag <= 0.0)
    for root in back[np.abs(back) < 1e3]:
        found = (line["bending_stiffness"] * root**4 + line["tension"] * root**2 + line["foundation"]) / line["mass"]
        assert found == pytest.approx(omega**2, rel=1e-9)


@settings(deadline=None)
@given(lines(), st.floats(0.0, 30.0), st.floats(0.0, 30.0), st.floats(0.0, 3.0))
def test_excited_waves_solve_the_equation_in_the_moving_frame(
    line: dict[str, float], speed: float, frequency: float, damping: float
) -> None:
    assume(line["bending_stiffness"] > 1e-3 or line["bending_stiffness"] == 0.0)
    assume(abs(line["tension"] - line["mass"] * speed**2) > 1e-3)
    roots = waves.excited_wavenumbers(speed, frequency, damping=damping, **line)
    omega = frequency + roots * speed
    terms = np.array(
        [
            line["bending_stiffness"] * roots**4,
            line["tension"] * roots**2,
            line["foundation"] + 0.0 * roots,
            1j * damping * omega,
            -line["mass"] * omega**2,
        ]
    )
    # a double root is found to the square root of the rounding
    assert np.all(np.abs(np.sum(terms, axis=0)) <= 1e-9 * np.sum(np.abs(terms), axis=0) + 1e-12)
    assert len(roots) == (2 if line["bending_stiffness"] == 0.0 else 4)


def test_a_constant_force_radiates_only_above_the_critical_speed() -> None:
    critical = waves.minimum_phase_velocity(**RAIL)
    below, above = waves.excited_wavenumbers(np.array([0.99, 1.01]) * critical, **RAIL)
    assert np.all(below.imag != 0.0)
    assert np.all(above.imag == 0.0)
    # short waves ahead of the load, long ones behind it, both with its speed as phase velocity
    ahead, behind = above[above.real > 0.0].real[::-1]
    assert waves.phase_velocity(np.array([ahead, behind]), **RAIL) == pytest.approx(1.01 * critical, rel=1e-12)
    assert waves.group_velocity(ahead, **RAIL) > 1.01 * critical > waves.group_velocity(behind, **RAIL)


def test_harmonic_load_on_a_bedded_string_radiates_above_the_moving_cut_off() -> None:
    """Omega_cr = sqrt(foundation/mass) sqrt(1 - (V/c)^2)."""
    string = {"mass": 2.0, "tension": 8.0, "foundation": 5.0}
    critical = np.sqrt(5.0 / 2.0) * np.sqrt(1 - 0.6**2)
    below, above = waves.excited_wavenumbers(1.2, critical * np.array([0.999, 1.001]), **string)
    assert np.all(below.imag != 0.0)
    assert np.all(above.imag == 0.0)


def test_nothing_travels_below_the_cut_off() -> None:
    cut_off = waves.cut_off_frequency(**RAIL)
    assert cut_off == pytest.approx(np.sqrt(1e7 / 60.21))
    assert waves.frequency(0.0, **RAIL) == pytest.approx(cut_off)
    assert np.all(waves.wavenumbers(0.99 * cut_off, **RAIL).imag < 0.0)
    assert waves.wavenumbers(1.01 * cut_off, **RAIL)[0].imag == 0.0
    string = {"mass": 1.0, "tension": 1.0, "foundation": 1.0}
    assert waves.wavenumbers([0.0, 1.0], **string)[:, 0] == pytest.approx([-1j, 0.0])


def test_compression_lowers_the_cut_off_and_turns_a_phase_backwards() -> None:
    pressed = {"mass": 1.0, "tension": -1.0, "bending_stiffness": 1.0, "foundation": 1.0}
    cut_off = waves.cut_off_frequency(**pressed)
    assert cut_off == pytest.approx(np.sqrt(0.75))
    k = waves.wavenumbers(0.9, **pressed)
    assert np.all(k.imag == 0.0)
    assert np.all(waves.group_velocity(k.real, **pressed) > 0.0)
    assert np.min(k.real) < 0.0 < np.max(k.real)
    assert waves.minimum_phase_velocity(**pressed) == pytest.approx(1.0)


def test_limits_are_values_and_not_nan() -> None:
    assert waves.phase_velocity(0.0, **STRING) == waves.group_velocity(0.0, **STRING) == 2.0
    assert waves.phase_velocity(0.0, mass=1.0, bending_stiffness=1.0) == 0.0
    assert waves.group_velocity(0.0, mass=1.0, bending_stiffness=1.0) == 0.0
    assert waves.phase_velocity(0.0, **RAIL) == np.inf
    assert waves.group_velocity(0.0, **RAIL) == 0.0
    assert np.all(waves.wavenumbers(0.0, mass=1.0, bending_stiffness=1.0) == 0.0)
    assert np.all(waves.excited_wavenumbers(0.0, mass=1.0, bending_stiffness=1.0) == 0.0)
    assert waves.minimum_phase_velocity(mass=1.0, bending_stiffness=1.0) == 0.0
    edge = {"mass": 1.0, "tension": -2.0, "bending_stiffness": 1.0, "foundation": 1.0}  # the verge of buckling
    assert waves.frequency(1.0, **edge) == waves.group_velocity(1.0, **edge) == waves.cut_off_frequency(**edge) == 0.0


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"mass": 0.0}, "^mass must"),
        ({"tension": -1.0}, "buckles"),
        ({"bending_stiffness": -1.0}, "^bending_stiffness must"),
        ({"foundation": np.nan}, "^foundation must"),
        ({"tension": 0.0}, "all be 0"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        waves.frequency(1.0, **(STRING | changed))


def test_waves_that_do_not_exist_are_refused() -> None:
    with pytest.raises(ValueError, match="wave speed"):
        waves.excited_wavenumbers([1.0, 2.0], **STRING)
    with pytest.raises(ValueError, match=r"^frequency must"):
        waves.wavenumbers(-1.0, **STRING)
    with pytest.raises(ValueError, match="nothing travels"):
        waves.wavenumbers(1.0, mass=1.0, foundation=1.0)
    with pytest.raises(ValueError, match=r"^wavenumber must"):
        waves.frequency(np.nan, **STRING)
