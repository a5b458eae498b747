"""Eigenmodes of clamped and simply supported beams with axial force on a bed, against tables and Galerkin's method."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh

from ropewalk.theory import beam, beam_modes

BEAM = {"length": 2.0, "bending_stiffness": 3.0, "mass": 1.5}
EULER = 4.0 * np.pi**2 * 3.0 / 4.0


def galerkin(tension: float, foundation: float) -> np.ndarray:
    """The six lowest frequencies of the clamped beam in the space (1 - y^2)^2 times polynomials."""
    y, weights = np.polynomial.legendre.leggauss(120)
    shapes = []
    for degree in range(30):
        series = np.polynomial.Legendre.basis(degree) * np.polynomial.Polynomial([1, 0, -2, 0, 1]).convert(
            kind=np.polynomial.Legendre
        )
        bend = series.deriv(2)(y)
        shapes.append(np.array([series(y), series.deriv(1)(y), bend]) / math.sqrt(np.sum(weights * bend**2)))
    w, slope, bend = np.array(shapes).transpose(1, 0, 2)
    product = lambda a: (a * weights) @ a.T  # noqa: E731
    stiffness = 3.0 * product(bend) + tension * product(slope) + foundation * product(w)
    return np.sqrt(eigh(stiffness, 1.5 * product(w), eigvals_only=True)[:6])


def test_clamped_beam_without_tension_is_that_of_the_tables() -> None:
    roots = [4.730040744862704, 7.853204624095838, 10.995607838001671, 14.137165491257464]
    computed = beam.natural_frequencies(4, ends="clamped", length=1.0, bending_stiffness=1.0, mass=1.0)
    assert np.sqrt(computed) == pytest.approx(roots, rel=1e-15)
    speeds = beam.resonance_speeds(4, ends="clamped", length=1.0, bending_stiffness=1.0, mass=1.0)
    assert speeds == pytest.approx(roots, rel=1e-15)


@pytest.mark.parametrize(
    ("tension", "foundation"),
    [(50.0, 0.0), (3e3, 10.0), (-25.0, 0.0), (-29.7, 100.0), (-60.5, 3e3), (-100.0, 2e3), (-200.0, 5e3)],
)
def test_clamped_frequencies_agree_with_galerkin(tension: float, foundation: float) -> None:
    """From -29.7 on, modes softer than the bed: two wavenumbers instead of one and decay."""
    computed = beam.natural_frequencies(6, ends="clamped", tension=tension, foundation=foundation, **BEAM)
    assert computed == pytest.approx(galerkin(tension, foundation), rel=1e-10)  # rounding of the reference


@settings(deadline=None, max_examples=40)
@given(st.floats(-0.97, 300.0), st.floats(0.0, 1e5), st.sampled_from(["simply_supported", "clamped"]))
def test_modes_are_orthonormal_and_meet_ends_and_equation(pull: float, foundation: float, kind: str) -> None:
    limit = beam.buckling_force(length=2.0, bending_stiffness=3.0, foundation=foundation, ends=kind)
    tension = pull * limit
    modes = beam_modes.Beam(tension=tension, foundation=foundation, ends=kind, **BEAM).modes(9)
    y, weights = np.polynomial.legendre.leggauss(60)
    w = modes.shape(1.0 + y)
    assert 1.5 * (w.T * weights) @ w == pytest.approx(np.eye(9), abs=1e-9)  # 1e-10 near a change of form
    bend, fourth = modes.shape(1.0 + y, 2), modes.shape(1.0 + y, 4)
    inertia = 1.5 * modes.frequency**2 * w
    scale = np.max(np.abs(inertia)) + 3.0 * np.max(np.abs(fourth)) + foundation
    assert np.max(np.abs(3.0 * fourth - tension * bend + foundation * w - inertia)) < 1e-9 * scale
    ends = np.array([0.0, 2.0])
    assert np.max(np.abs(modes.shape(ends))) < 1e-9
    restrained = modes.shape(ends, 1 if kind == "clamped" else 2)
    assert np.max(np.abs(restrained)) < 1e-9 * np.max(modes.wavenumber) ** 2


def test_mode_whose_two_waves_both_end_flat() -> None:
    """Both wavelengths fit the beam: the condition of slopes at the ends is empty, that of values is used."""
    tension = -5.0 * EULER
    modes = beam_modes.Beam(tension=tension, foundation=5e3, ends="clamped", **BEAM).modes(6)
    assert modes.frequency == pytest.approx(galerkin(tension, 5e3), rel=1e-10)
    y, weights = np.polynomial.legendre.leggauss(60)
    w = modes.shape(1.0 + y)
    assert 1.5 * (w.T * weights) @ w == pytest.approx(np.eye(6), abs=1e-10)
    assert np.max(np.abs(modes.shape(np.array([0.0, 2.0])))) < 1e-10


def test_high_modes_stay_clean() -> None:
    modes = beam_modes.Beam(ends="clamped", **BEAM).modes(5000)
    assert np.max(np.abs(modes.shape(np.array([0.0, 2.0])))) < 1e-11
    assert np.all(np.diff(modes.frequency) > 0.0)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    y = (np.linspace(-1.0, 1.0, 121)[:-1, np.newaxis] + (1.0 + nodes) / 120).ravel()
    weights = np.tile(weights / 120, 120)
    shape = beam_modes.Beam(ends="clamped", **BEAM).modes(400).shape(1.0 + y)[:, 300:]
    assert 1.5 * (shape.T * weights) @ shape == pytest.approx(np.eye(100), abs=1e-11)


def test_buckling_forces() -> None:
    line = {"length": 2.0, "bending_stiffness": 3.0}
    assert beam.buckling_force(**line) == pytest.approx(np.pi**2 * 3.0 / 4.0, rel=1e-15)
    assert beam.buckling_force(ends="clamped", **line) == pytest.approx(EULER, rel=1e-14)
    assert beam.buckling_force(ends="clamped", foundation=1e-9, **line) == pytest.approx(EULER, rel=1e-9)
    # two half waves: EI (2 pi/L)^2 + k (L/2 pi)^2
    assert beam.buckling_force(foundation=600.0, **line) == pytest.approx(3.0 * np.pi**2 + 600.0 / np.pi**2, rel=1e-14)
    for kind in ("simply_supported", "clamped"):
        long = beam.buckling_force(length=500.0, bending_stiffness=3.0, foundation=12.0, ends=kind)
        assert long == pytest.approx(2.0 * math.sqrt(36.0), rel=1e-3)  # the infinite beam


@pytest.mark.parametrize("kind", ["simply_supported", "clamped"])
@pytest.mark.parametrize("foundation", [0.0, 50.0, 3e3, 1e5])
def test_lowest_frequency_vanishes_at_buckling(kind: str, foundation: float) -> None:
    limit = beam.buckling_force(length=2.0, bending_stiffness=3.0, foundation=foundation, ends=kind)
    line = BEAM | {"foundation": foundation, "ends": kind}
    squares = [np.min(beam.natural_frequencies(9, tension=-(1 - e) * limit, **line)) ** 2 for e in (1e-6, 2e-6)]
    assert squares[1] / squares[0] == pytest.approx(2.0, rel=1e-3)
    assert np.isfinite(beam.moving_force(1.0, 0.7, force=1.0, speed=1.0, modes=9, tension=-(1 - 1e-15) * limit, **line))
    with pytest.raises(ValueError, match="buckles"):
        beam.natural_frequencies(1, tension=-limit, **line)
