"""Packed axial laws against the formulas of their declarations, and against each other: W' = T, T' = tangent."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ropewalk.mechanics import law as kernels
from ropewalk.mechanics.assembly import pack
from ropewalk.model import Hooke, Law, Polynomial, SecondPiolaKirchhoff, Tabulated, TensionOnly

EA = 2.5e4
TABLE = Tabulated(strain=(-0.02, 0.0, 0.01, 0.03, 0.05), tension=(-150.0, 0.0, 300.0, 300.0, 1500.0))
LAWS: dict[str, Law] = {
    "hooke": Hooke(),
    "tension_only": TensionOnly(),
    "second_piola_kirchhoff": SecondPiolaKirchhoff(),
    "cubic": Polynomial(coefficients=(EA, 3e4, 2e5)),
    "quintic": Polynomial(coefficients=(EA, -3e3, 2e5, 4e4, 7e5)),
    "table": TABLE,
    "pretensioned table": Tabulated(strain=(0.01, 0.02), tension=(100.0, 350.0)),
    "table with a gap": Tabulated(strain=(0.0, 0.004, 0.01, 0.02), tension=(0.0, 0.0, 60.0, 900.0)),
}


def packed(law: Law) -> np.ndarray:
    return pack(law, None if isinstance(law, Polynomial | Tabulated) else EA)


def kinks(law: Law) -> tuple[float, ...]:
    if isinstance(law, TensionOnly):
        return (0.0,)
    return law.strain if isinstance(law, Tabulated) else ()


def plain_tension(law: Law, eps: float) -> float:
    """The twin: the declaration's own formula, with nothing of the kernel in it."""
    if isinstance(law, Hooke):
        return EA * eps
    if isinstance(law, TensionOnly):
        return EA * eps if eps > 0.0 else 0.0
    if isinstance(law, SecondPiolaKirchhoff):
        return EA * eps * (1.0 + eps)
    if isinstance(law, Polynomial):
        return float(sum(c * eps**power for power, c in enumerate(law.coefficients, start=1)))
    strain, force = np.array(law.strain), np.array(law.tension)
    if eps < strain[0]:
        return float(force[0] + (force[1] - force[0]) / (strain[1] - strain[0]) * (eps - strain[0]))
    if eps > strain[-1]:
        return float(force[-1] + (force[-1] - force[-2]) / (strain[-1] - strain[-2]) * (eps - strain[-1]))
    return float(np.interp(eps, strain, force))


def plain_stored(law: Law, eps: float) -> float:
    """The integral of the twin from 0, exact to rounding: Gauss-Legendre between the kinks (degree 9 or less)."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    low, high = min(0.0, eps), max(0.0, eps)
    ends = [low, *(k for k in kinks(law) if low < k < high), high]
    total = 0.0
    for a, b in itertools.pairwise(ends):
        places = 0.5 * (a + b) + 0.5 * (b - a) * nodes
        total += 0.5 * (b - a) * float(weights @ [plain_tension(law, x) for x in places])
    return total if eps >= 0.0 else -total


def steepest(law: Law, reach: float) -> float:
    """The largest slope up to |eps| = reach, N: what turns a rounding of the strain into one of the tension."""
    if isinstance(law, Polynomial):
        return sum((i + 1) * abs(c) * max(reach, 1.0) ** i for i, c in enumerate(law.coefficients))
    if isinstance(law, Tabulated):
        return float((np.diff(law.tension) / np.diff(law.strain)).max())
    return EA * (1.0 + 2.0 * reach)


strains = st.floats(-0.9, 2.0)
increasing = st.lists(st.floats(1e-3, 0.3), min_size=2, max_size=6)
coefficients = st.lists(st.floats(-1e5, 1e5), max_size=7)


@st.composite
def any_law(draw: st.DrawFn) -> Law:
    kind = draw(st.sampled_from(["hooke", "tension_only", "spk", "polynomial", "table"]))
    if kind == "polynomial":
        return Polynomial(coefficients=(draw(st.floats(1.0, 1e6)), *draw(coefficients)))
    if kind == "table":
        strain = draw(st.floats(-0.5, 0.5)) + np.cumsum([0.0, *draw(increasing)])
        rises = draw(st.lists(st.floats(0.0, 1e5), min_size=strain.size - 2, max_size=strain.size - 2))
        tension = draw(st.floats(-1e3, 1e3)) + np.cumsum([0.0, *rises, draw(st.floats(1.0, 1e5))])
        return Tabulated(strain=tuple(strain), tension=tuple(tension))
    return {"hooke": Hooke(), "tension_only": TensionOnly(), "spk": SecondPiolaKirchhoff()}[kind]


@settings(deadline=None, max_examples=200)
@given(any_law(), strains)
def test_packed_law_equals_its_plain_twin(law: Law, eps: float) -> None:
    p, rounding = packed(law), 1e-14 * steepest(law, abs(eps)) * 10.0  # ten or so operations on numbers of that size
    offset = 1e-14 * max(map(abs, law.tension)) if isinstance(law, Tabulated) else 0.0
    assert kernels.tension(p, eps) == pytest.approx(plain_tension(law, eps), rel=1e-13, abs=rounding + offset)
    assert kernels.stored(p, eps) == pytest.approx(plain_stored(law, eps), rel=1e-12, abs=4.0 * (rounding + offset))


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("eps", [-0.5, -0.021, -0.013, 0.0, 0.002, 0.007, 0.015, 0.04, 0.051, 0.6])
def test_tension_is_the_derivative_of_stored_energy(name: str, eps: float) -> None:
    law, step = LAWS[name], 1e-5
    p = packed(law)
    slope = (kernels.stored(p, eps + step) - kernels.stored(p, eps - step)) / (2.0 * step)
    # at a kink the mean of both sides is off by a quarter of step times the jump of slope; else step^2 and roundings
    assert kernels.tension(p, eps) == pytest.approx(slope, rel=1e-9, abs=0.5 * step * steepest(law, abs(eps)))


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("eps", [-0.5, -0.021, -0.013, 0.002, 0.007, 0.015, 0.04, 0.051, 0.6])
def test_tangent_is_the_derivative_of_tension(name: str, eps: float) -> None:
    law, step = LAWS[name], 1e-5
    p = packed(law)
    slope = (kernels.tension(p, eps + step) - kernels.tension(p, eps - step)) / (2.0 * step)
    # third derivatives up to 6e7 N times step^2, and roundings of tensions near 1e5 N over step
    assert kernels.tangent(p, eps) == pytest.approx(slope, abs=1e-9 * steepest(law, 1.0) + 1e-6)


@settings(deadline=None, max_examples=100)
@given(any_law(), strains)
def test_tangent_follows_every_law_away_from_its_kinks(law: Law, eps: float) -> None:
    step = 1e-5
    assume(all(abs(eps - kink) > 2.0 * step for kink in kinks(law)))
    slope = (plain_tension(law, eps + step) - plain_tension(law, eps - step)) / (2.0 * step)
    # step^2 times third derivatives (at most 200 times the largest slope), roundings over step
    offset = max(map(abs, law.tension)) if isinstance(law, Tabulated) else 0.0
    allowed = 5e-8 * steepest(law, abs(eps)) + 1e-10 * offset
    assert kernels.tangent(packed(law), eps) == pytest.approx(slope, abs=allowed)


@pytest.mark.parametrize("name", LAWS)
@settings(deadline=None, max_examples=60)
@given(force=st.floats(0.0, 1e5))
def test_strain_is_the_inverse_of_tension(name: str, force: float) -> None:
    law = LAWS[name]
    p = packed(law)
    eps = kernels.strain(p, force)
    assert math.isfinite(eps)
    # the strain is found to a rounding of 1 + eps
    allowed = 1e-15 * (1.0 + abs(eps)) * steepest(law, abs(eps))
    assert plain_tension(law, eps) == pytest.approx(force, rel=1e-14, abs=allowed)


def test_strain_is_not_a_number_where_the_law_never_gives_the_tension() -> None:
    falling = packed(Polynomial(coefficients=(1e5, -1e6)))  # at most 2500 N, at a strain of 0.05
    assert kernels.strain(falling, 2400.0) == pytest.approx(0.04, rel=1e-13)
    assert math.isnan(kernels.strain(falling, 2600.0))


def test_a_table_goes_on_with_its_end_slopes() -> None:
    p = packed(TABLE)
    assert kernels.tension(p, -1.0) == pytest.approx(-150.0 - 7500.0 * 0.98, rel=1e-14)
    assert kernels.tension(p, 1.0) == pytest.approx(1500.0 + 6e4 * 0.95, rel=1e-14)
    assert kernels.tangent(p, -1.0) == pytest.approx(7500.0, rel=1e-14)
    assert kernels.tangent(p, 1.0) == pytest.approx(6e4, rel=1e-13)
    assert kernels.strain(p, 1500.0 + 6e4) == pytest.approx(1.05, rel=1e-14)


def test_a_slack_tension_only_link_holds_nothing() -> None:
    p = packed(TensionOnly())
    for eps in (-1.0, -0.3, -1e-12, 0.0):
        assert kernels.tension(p, eps) == 0.0
        assert kernels.stored(p, eps) == 0.0
        assert kernels.tangent(p, eps) == 0.0
    assert kernels.tension(p, 0.01) == EA * 0.01


def test_second_piola_kirchhoff_stores_what_the_paper_prints() -> None:
    """W = k (2 lam^3 - 3 lam^2 + 1) / 6."""
    p = packed(SecondPiolaKirchhoff())
    for lam in (0.6, 1.0, 1.02, 1.7):
        expected = EA * (2.0 * lam**3 - 3.0 * lam**2 + 1.0) / 6.0
        assert kernels.stored(p, lam - 1.0) == pytest.approx(expected, abs=1e-15 * EA)  # roundings of the sum


def test_arrays_of_strains_give_what_single_strains_give() -> None:
    eps, rest = np.linspace(-0.1, 0.1, 9), np.linspace(0.5, 1.5, 9)
    for law in LAWS.values():
        p = packed(law)
        assert np.array_equal(kernels.tensions(p, eps), [kernels.tension(p, e) for e in eps])
        assert np.array_equal(kernels.tangents(p, eps), [kernels.tangent(p, e) for e in eps])
        total = sum(kernels.stored(p, e) * h for e, h in zip(eps, rest, strict=True))
        assert kernels.stored_total(p, eps, rest) == pytest.approx(total, rel=1e-14)


def test_a_law_without_its_stiffness_is_refused() -> None:
    with pytest.raises(ValueError, match="axial stiffness"):
        pack(Hooke(), None)


@pytest.mark.parametrize("name", ["tension_only", "table with a gap", "table", "hooke"])
def test_what_only_pulls_may_be_let_push(name: str) -> None:
    """Where it pulls it is as it was; elsewhere it goes on with the slope that it begins to pull with."""
    law = packed(LAWS[name])
    found = kernels.pushing(law)
    first = {"table with a gap": 0.004, "table": -0.02}.get(name, 0.0)
    above = np.linspace(first, 0.06, 50)
    assert kernels.tensions(found, above) == pytest.approx(kernels.tensions(law, above), abs=1e-9)
    slope = kernels.tangent(law, first + 1e-6)
    below = np.array([-0.03, -1e-3]) + min(first, 0.0)
    assert kernels.tensions(found, below) == pytest.approx(kernels.tension(law, first) + slope * (below - first))
