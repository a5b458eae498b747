"""Between rope and beam: EI -> 0 tends to the rope as its boundary layers say, EI -> infinity to Euler and Bernoulli.

What an end that turns freely does is of the order EI; a clamped one turns the line within sqrt(EI/T), which is of the
order sqrt(EI). The rope is that of the other engine, without bending stiffness, on the same mesh. Sources: H. Fletcher,
Normal vibration frequencies of a stiff piano string (1964); the elastica as boundary layer; Timoshenko, Strength of
materials II, tie rods.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from ropewalk.model import Scenario
from ropewalk.simulate import simulate, spectrum_of
from ropewalk.theory.rope import elastic_catenary

Array = NDArray[np.float64]
LENGTH = 10.0
N = np.arange(1.0, 4.0)  # numbers of modes
CLAMPED = {"kind": "fixed", "clamped": True}
BOTH = {"start_support": CLAMPED, "end_support": CLAMPED}


def scenario(gravity: float, **line: Any) -> Scenario:
    given = {"start": [0, 0], "end": [LENGTH, 0], "mass": 1.0, "axial_stiffness": 1e9, **line}
    return Scenario.model_validate({"gravity": gravity, "lines": {"line": given}, "run": {"kind": "equilibrium"}})


def frequencies(**line: Any) -> Array:
    """The three lowest of a line without weight; each comes twice, up and sideways."""
    modes = spectrum_of(scenario(0.0, **line), how_many=6).modes
    assert modes is not None
    return modes.frequency[::2]


def orders(parameters: list[float], errors: Array) -> Array:
    """Observed orders between successive parameters."""
    found: Array = np.diff(np.log(np.abs(errors)), axis=0).T / np.diff(np.log(parameters))
    print("errors", errors, "orders", found)
    return found


# -- Towards the rope ----------------------------------------------------------------------------------------------

TENSION = 1e4
PARTS = [0.01, 0.02, 0.04]  # sqrt(EI / T) / L


def link_springs(clamped: bool) -> Array:
    """Frequencies of stiff strings over those of the string without stiffness, less one: (part, mode)."""
    own = {"tension": TENSION, "elements": 400}
    rope, ends = frequencies(**own), BOTH if clamped else {}
    stiff = [frequencies(**own, **ends, bending_stiffness=TENSION * (LENGTH * part) ** 2) for part in PARTS]
    return np.array(stiff) / rope - 1.0


def test_a_pinned_string_is_out_of_tune_in_proportion_to_its_bending_stiffness() -> None:
    """w^2 = w0^2 (1 + EI n^2 pi^2 / (T L^2)), exactly."""
    sharp = (1.0 + link_springs(clamped=False)) ** 2 - 1.0
    # 1e-5 is the strain, by which the line is longer than what its mass and bending stiffness are of, and the mesh.
    np.testing.assert_allclose(sharp, np.outer(np.square(PARTS), (N * np.pi) ** 2), rtol=1e-4)
    assert orders([part**2 for part in PARTS], sharp) == pytest.approx(np.full((3, 2), 1.0), abs=1e-4)


def test_a_clamped_string_is_out_of_tune_in_proportion_to_the_root_of_its_bending_stiffness() -> None:
    """w = w0 (1 + 2 e + (4 + n^2 pi^2 / 2) e^2) with e = sqrt(EI/T) / L: Fletcher (1964)."""
    sharp, e = link_springs(clamped=True), np.array(PARTS)[:, None]
    assert sharp[0] / (2.0 * e[0]) == pytest.approx(1.0 + e[0] * (2.0 + N**2 * np.pi**2 / 4.0), abs=0.01)
    first, last = orders([part**2 for part in PARTS], sharp[:, :1]).ravel()
    assert 0.5 < first < last < 0.58  # 1/2 and what the next power adds, which is less for smaller parts
    # That next power, after what the mesh of half a layer takes from the thinnest.
    rest = (sharp - 2.0 * e) / e**2 / (4.0 + N**2 * np.pi**2 / 2.0)
    print("second power", rest)
    np.testing.assert_allclose(rest[1:], 1.0, atol=0.1)


SLACK = {"end": [14.0, 0.0], "length": 20.0, "axial_stiffness": 1e8}
HALF = 10.0
CHAIN = elastic_catenary(span=14.0, height=0.0, length=20.0, weight=9.81, axial_stiffness=1e8)
BOTTOM, TOP = (float(CHAIN.tension(np.array([s]))[0]) for s in (HALF, 0.0))  # N


def rest(elements: int, **line: Any) -> tuple[float, float]:
    """Potential energy in J and sag in m of a slack line at rest."""
    found = simulate(scenario(9.81, elements=elements, **SLACK, **line))
    energy = found.energy.sel(form=["elastic", "gravitational"]).sum().item()
    return energy, -found.position.values[0, :, 1].min().item()


def test_a_slack_line_stores_what_it_takes_to_bend_the_catenary_and_tends_to_the_chain() -> None:
    """Pinned: energy + EI/2 times the integral of the squared curvature; the sag in proportion to EI as well.

    tan(angle) = s/a with a = H/w from the lowest point: the integral over both halves is l/(a^2+l^2) + arctan(l/a)/a.
    The curvature must vanish at the ends, within sqrt(EI/T): what that changes is of the order EI^(3/2).
    """
    a, sizes = BOTTOM / 9.81, [1e-2, 1e-1, 1.0]
    bent = 0.5 * (HALF / (a**2 + HALF**2) + np.arctan(HALF / a) / a)
    energy, sag = rest(320)
    assert rest(320, bending_stiffness=1e-9) == pytest.approx((energy, sag), rel=1e-9)
    more = np.array([rest(320, bending_stiffness=stiffness) for stiffness in sizes]) - [energy, sag]
    assert more[:, 0] / sizes == pytest.approx(np.full(3, bent), rel=1.5e-3)  # the mesh, and 1e-3 of the layers at 1
    found = orders(sizes, more)
    assert found[0] == pytest.approx([1.0, 1.0], abs=1e-3)
    assert found[1] == pytest.approx([1.0, 1.0], abs=5e-3)


def test_a_clamped_slack_line_is_a_chain_but_for_layers_at_its_ends_that_are_elasticae() -> None:
    """Clamped along the chord, a turn by f: energy + 4 sqrt(EI T) (1 - cos(f/2)) at each end, and the next power EI.

    EI theta'^2 / 2 = T (1 - cos theta) in a layer; the energy is the integral of sqrt(2 EI T (1 - cos theta)).
    """
    turn, sizes, more = np.arctan(HALF * 9.81 / BOTTOM), [4.0, 16.0, 64.0], []
    layers = 8.0 * np.sqrt(TOP) * (1.0 - np.cos(0.5 * turn))
    for elements in (320, 640):
        energy = rest(elements)[0]
        more.append([rest(elements, **BOTH, bending_stiffness=stiffness)[0] - energy for stiffness in sizes])
    coarse, fine = np.array(more)
    extra = fine + (fine - coarse) / 3.0  # layers of some links: they are met to the second order
    first, last = orders(sizes, extra)
    assert 0.5 < first < last < 0.56
    beyond = extra / np.sqrt(sizes) / layers - 1.0
    assert beyond[0] < 0.03
    assert orders(sizes, beyond) == pytest.approx([0.5, 0.5], abs=0.1)


# -- Towards the beam ----------------------------------------------------------------------------------------------

PULL = 100.0  # N
STIFF = [4e4, 16e4, 64e4]  # EI, N m^2: 4 to 64 times the tension times the length squared


def sag(stiffness: float, **line: Any) -> float:
    """Deflection in the middle in m, under a weight that is too small to stretch the line."""
    mass = {"mass": 1e-4, "elements": 80}
    found = simulate(scenario(9.81, **mass, **line, bending_stiffness=stiffness))
    return -found.position.values[0, 40, 1].item()


@pytest.mark.parametrize(("ends", "share", "next_power"), [({}, 5 / 384, 61 / 600), (BOTH, 1 / 384, 1 / 40)])
def test_a_stiff_line_bends_as_a_beam_and_its_tension_matters_in_proportion_to_one_over_its_stiffness(
    ends: dict[str, Any], share: float, next_power: float
) -> None:
    """Less by T L^2 / EI times 61/600 pinned and 1/40 clamped, the next terms of the series of tie rods."""
    beams = np.array([sag(stiffness, length=LENGTH, **ends) for stiffness in STIFF])
    exact = share * 1e-4 * 9.81 * LENGTH**4 / np.array(STIFF)
    np.testing.assert_allclose(beams, exact, rtol=1.5e-3)  # the second order of 80 elements
    less = 1.0 - np.array([sag(stiffness, tension=PULL, **ends) for stiffness in STIFF]) / beams
    ratio = PULL * LENGTH**2 / np.array(STIFF)
    # Rounding of deflections of 1e-9 m, and the next power of the ratio.
    np.testing.assert_allclose(less / ratio, next_power, rtol=0.03)
    assert orders(STIFF, less) == pytest.approx([-1.0, -1.0], abs=0.05)


def test_a_stiff_line_swings_as_a_beam_and_its_tension_matters_in_proportion_to_one_over_its_stiffness() -> None:
    """w^2 = (n pi / L)^4 EI / m (1 + T L^2 / (n^2 pi^2 EI))."""
    own = {"elements": 80}
    beams = np.array([frequencies(**own, length=LENGTH, bending_stiffness=stiffness) for stiffness in STIFF])
    euler = np.outer(np.sqrt(STIFF), (N * np.pi / LENGTH) ** 2)
    np.testing.assert_allclose(beams, euler, rtol=1.2e-3)  # (n pi h / L)^2 / 12
    taut = np.array([frequencies(**own, tension=PULL, bending_stiffness=stiffness) for stiffness in STIFF])
    more = (taut / beams) ** 2 - 1.0
    np.testing.assert_allclose(more, PULL * LENGTH**2 / np.outer(STIFF, (N * np.pi) ** 2), rtol=4e-3)  # the mesh
    assert orders(STIFF, more) == pytest.approx(np.full((3, 2), -1.0), abs=1e-2)
