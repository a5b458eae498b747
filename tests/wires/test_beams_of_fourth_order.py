"""Beams in small motion are of the fourth order in the mesh, at all of their ends and under loads between nodes.

Sources: roots of the frequency equations of Euler-Bernoulli beams (Blevins, Formulas for natural frequency and mode
shape, table 8-1), with tension and beds in closed form; Fryba, Vibration of solids and structures under moving loads,
chapter 1; static deflections of textbooks.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from ropewalk.model import Scenario
from ropewalk.results.frame import ENERGY_FORMS
from ropewalk.results.line_response import responses
from ropewalk.simulate import simulate
from ropewalk.theory import beam, beam_vehicle
from ropewalk.wires.bending import HIGHEST, fourth_order, shares
from ropewalk.wires.contact_location import location_at
from ropewalk.wires.mesh import mesh_of
from ropewalk.wires.plan import Hold, PointMass, Spot, WirePlan
from ropewalk.wires.rest import moving, rest_of, vertical_stiffness
from ropewalk.wires.spectrum import spectrum
from ropewalk.wires.task import WireTask
from wire_cases import course, force, rolling, straight

LENGTH, MASS, EI = 25.0, 2303.0, 2.87e9 * 2.90
GIVEN = {"length": LENGTH, "bending_stiffness": EI, "mass": MASS}
SPEED = 100 / 3.6
FIRM = 1e15  # N, so that waves along the beam are faster than all that is looked at
MESHES = (48, 96)
ROUNDING = 2e-8  # of frequencies, of the solver for eigenvalues
STIFF = 2e7  # N/m, of the springs under a beam's ends


def roots(equation, brackets) -> np.ndarray:
    """b of k = b / L, from brackets about the roots."""
    return np.array([brentq(equation, low, high, xtol=1e-14) for low, high in brackets])


def by_roots(b: np.ndarray, length: float = LENGTH) -> np.ndarray:
    return np.asarray(b**2 * np.sqrt(EI / MASS) / length**2)


def both_clamped(b):
    return np.cos(b) - 1.0 / np.cosh(b)


def cantilever(b):
    return np.cos(b) + 1.0 / np.cosh(b)


def propped(b):
    return np.tan(b) - np.tanh(b)


def on_springs(b: float) -> float:
    """Determinant of w'' = 0 and EI w''' = -k w, or k w, at the ends, of sin, cos and two exponentials."""
    c = STIFF * LENGTH**3 / (EI * b**3)
    s, o, e = np.sin(b), np.cos(b), np.exp(-b)
    return float(
        np.linalg.det([
            [0.0, -1.0, 1.0, e],
            [-s, -o, e, 1.0],
            [-1.0, c, c - 1.0, e * (c + 1.0)],
            [-o - c * s, s - c * o, -e * (1.0 + c), 1.0 - c],
        ])
    )  # fmt: skip


def supported(station: float, stiffness: float = np.inf) -> Hold:
    return Hold(f"at {station:g}", Spot(0, station), (0.0, np.inf, stiffness), place=(station, 0.0, 0.0))


AROUND = [(n * np.pi + 1.0, n * np.pi + 2.5) for n in (1, 2, 3)]
CLAMPED = by_roots(roots(both_clamped, AROUND))
HINGED = np.pi * np.arange(1.0, 4.0)
SPANS = by_roots(np.sort([np.pi, roots(propped, [(3.5, 4.5)])[0], 2.0 * np.pi]), 0.5 * LENGTH)
CASES = {
    "hinged": (("pinned", "pinned"), {}, by_roots(HINGED)),
    "clamped": (("clamped", "clamped"), {}, CLAMPED),
    "free": (("free", "free"), {}, CLAMPED),
    "a cantilever": (("clamped", "free"), {}, by_roots(roots(cantilever, [(1.0, 3.0), *AROUND[:2]]))),
    "propped": (("clamped", "pinned"), {}, by_roots(roots(propped, [(3.5, 4.5), (6.5, 7.5), (9.5, 10.6)]))),
    "under tension": (("pinned", "pinned"), {"tension": 1e8}, beam.natural_frequencies(3, tension=1e8, **GIVEN)),
    "pushed together": (("pinned", "pinned"), {"tension": -5e7}, beam.natural_frequencies(3, tension=-5e7, **GIVEN)),
    "clamped under tension": (
        ("clamped", "clamped"), {"tension": 1e8}, beam.natural_frequencies(3, tension=1e8, ends="clamped", **GIVEN),
    ),
    "on a bed": (("pinned", "pinned"), {"bed": 5e6}, beam.natural_frequencies(3, foundation=5e6, **GIVEN)),
    "on springs": (
        ("free", "free"), {"holds": (supported(0.0, STIFF), supported(LENGTH, STIFF))},
        by_roots(roots(on_springs, [(2.2, 3.1), (3.3, 4.3), (4.9, 5.8)])),
    ),
    "on a bearing that slides": (("pinned", "free"), {"holds": (supported(LENGTH),)}, by_roots(HINGED)),
}  # fmt: skip


def frequencies(links: int, ends: tuple[str, str], **more) -> np.ndarray:
    """The lowest ones of small motion, upwards and sideways."""
    holds, masses, tension = more.pop("holds", ()), more.pop("masses", ()), more.pop("tension", 0.0)
    wire = straight(LENGTH, tension, MASS, EI, ends=ends, axial_stiffness=FIRM, **more)
    plan = WirePlan((wire,), holds=holds, masses=masses, gravity=0.0)
    task = WireTask(plan, (), (), element=[links], geometry="linearised")
    modes = spectrum(task, 16).modes
    assert modes is not None
    return np.asarray(modes.frequency)


def errors_of(exact: np.ndarray, ends: tuple[str, str], meshes=MESHES, **more) -> np.ndarray:
    found = [frequencies(n, ends, **more) for n in meshes]
    return np.array([[np.abs(w / one - 1.0).min() for one in exact] for w in found])


@pytest.mark.parametrize("name", CASES)
def test_frequencies_are_those_of_euler_and_bernoulli_with_the_fourth_order(name: str) -> None:
    ends, more, exact = CASES[name]
    errors = errors_of(exact, ends, **more)
    order = np.log2(errors[0] / errors[1])
    print(name, "errors", errors, "orders", order)
    assert errors[1].max() < 5e-6
    counted = errors[1] > ROUNDING
    assert counted.sum() >= 2
    assert (order[counted] > 3.7).all()
    assert (order[counted] < 4.3).all()


@pytest.mark.parametrize("links", [(15, 31, 61), (16, 32, 64)], ids=["between nodes", "at a node"])
def test_beams_over_a_pier_have_the_frequencies_of_their_spans_with_the_fourth_order(links: tuple[int, ...]) -> None:
    """Half of the modes are those of a propped span, half those of a hinged one."""
    pier = supported(0.5 * LENGTH)
    errors = errors_of(SPANS, ("pinned", "pinned"), links, holds=(pier,))
    print("errors", errors)
    # On a pier the spectrum gives way by 1e-12 m/N: 2e-4 of the frequency of the propped span on fine meshes.
    order = np.log(errors[0, [0, 2]] / errors[2, [0, 2]]) / np.log(links[2] / links[0])
    assert (np.abs(order - 4.1) < 0.3).all()
    assert (errors[1] < 5e-4).all()


def test_a_mass_at_the_tip_of_a_cantilever() -> None:
    """As heavy as the beam: 1 + cos b cosh b = b (sin b cosh b - cos b sinh b), b = 1.2479."""
    b = roots(lambda b: 1.0 / np.cosh(b) + np.cos(b) - b * (np.sin(b) - np.cos(b) * np.tanh(b)), [(1.0, 1.5)])
    assert b == pytest.approx(1.2479, abs=1e-4)
    tip = PointMass(Spot(0, LENGTH), MASS * LENGTH)
    assert errors_of(by_roots(b), ("clamped", "free"), (16,), masses=(tip,)).max() < 1e-6


@pytest.mark.parametrize("ends", [(False, False), (True, False), (True, True)], ids=["hinged", "one", "both"])
@pytest.mark.parametrize("links", [8, 9, 16, 40])
def test_one_energy_is_stored_and_no_end_is_stiffer_than_the_stencil(links: int, ends: tuple[bool, bool]) -> None:
    K, part = fourth_order(links, ends).toarray(), 1.0 / np.sqrt(shares(links, fourth=True))
    assert np.array_equal(K, K.T)
    assert K.sum(axis=0) == pytest.approx(0.0, abs=1e-12)
    free = slice(int(ends[0]), links + 1 - int(ends[1]))  # a clamped end does not move
    found = np.linalg.eigvalsh((part[:, None] * K * part)[free, free])
    rigid = 0 if any(ends) else 2
    assert np.abs(found[:rigid]).max(initial=0.0) < 1e-12
    assert found[rigid] > 1e-6
    assert found[-1] < 1.001 * HIGHEST
    assert shares(links, fourth=True).sum() == pytest.approx(links, rel=1e-14)


@pytest.mark.parametrize("ends", [("pinned", "pinned"), ("clamped", "clamped"), ("clamped", "free")])
def test_a_beam_hangs_as_textbooks_say(ends: tuple[str, str]) -> None:
    q = 9.81 * MASS
    exact = {"pinned": 5.0 * q * LENGTH**4 / 384.0, "clamped": q * LENGTH**4 / 384.0, "free": q * LENGTH**4 / 8.0}
    errors = []
    for links in (16, 32):
        plan = WirePlan((straight(LENGTH, 0.0, MASS, EI, ends=ends, axial_stiffness=FIRM),), gravity=9.81)
        z = rest_of(mesh_of(plan, [links], small=True)).position[2]
        errors.append(abs(-z[-1 if ends[1] == "free" else links // 2] * EI / exact[ends[1]] - 1.0))
    print(ends, "errors", errors)
    assert errors[0] < 3e-4
    assert errors[1] < max(errors[0] / 15.0, 1e-10)


def test_a_standing_force_between_nodes_has_the_deflection_of_the_beam_under_itself() -> None:
    """a^2 b^2 / (3 EI L) at every part of a link: nodes are exact, and beside the spline a point yields by h^3 / EI."""
    plan = WirePlan((straight(LENGTH, 0.0, MASS, EI, axial_stiffness=FIRM),), gravity=0.0)
    mesh = mesh_of(plan, [16], small=True)
    free, K = moving(mesh), vertical_stiffness(mesh).toarray()
    for links in (1.0, 1.5, 2.25, 5.0, 7.1, 7.5, 12.7, 14.6):
        location = location_at(mesh, 0, links)
        row = np.zeros(mesh.nodes)
        row[location.first : location.first + location.weight.shape[1]] = location.weight[0]
        spline = row[free] @ np.linalg.solve(K[np.ix_(free, free)], row[free])
        a = links * LENGTH / 16.0
        exact = (a * (LENGTH - a)) ** 2 / (3.0 * EI * LENGTH)
        assert spline + location.local == pytest.approx(exact, abs=2e-6 * (LENGTH / 16.0) ** 3 / EI)
        assert spline < exact * (1.0 - 1e-5)


def crossing(links: int, ends: str) -> tuple[float, float]:
    """Largest errors at midspan and under a force that crosses, over the largest deflections there."""
    kind, times = ("clamped" if ends == "clamped" else "pinned"), np.linspace(0.0, 0.9, 181)
    wire = straight(LENGTH, 0.0, MASS, EI, ends=(kind, kind))
    frames, _ = course(wire, [force(5e4, SPEED)], times, links)
    found = np.array([[frame.sampled_uplift[0, 0], frame.sampled_height[0, 0]] for frame in frames[1:]])
    place = SPEED * times[:-1]
    exact = -np.array(
        [
            beam.moving_force(np.array([0.5 * LENGTH, x]), t, force=5e4, speed=SPEED, ends=ends, **GIVEN).ravel()
            for x, t in zip(place, times[:-1], strict=True)
        ]
    )
    middle, under = np.abs(found - exact).max(axis=0) / np.abs(exact).max(axis=0)
    return float(middle), float(under)


@pytest.mark.parametrize(("ends", "largest"), [("simply_supported", 1.1e-4), ("clamped", 3e-4)])
def test_a_force_moves_a_beam_as_fryba_says_with_24_links_to_four_digits(ends: str, largest: float) -> None:
    """Short waves from the start of the crossing come out of step: of the order 10/3, where frequencies are of 4."""
    errors = np.array([crossing(links, ends) for links in (12, 24, 48)])
    order = np.log2(errors[0] / errors[2]) / 2.0
    print(ends, "errors", errors, "orders", order)
    assert (errors[1] < largest).all()
    assert (order > 2.9).all()
    assert (order < 4.0).all()


@pytest.mark.parametrize("end", [{}, {"end_support": {"kind": "fixed", "clamped": True}}], ids=["hinged", "propped"])
def test_moments_under_a_force_between_nodes_are_those_of_the_beam(end: dict[str, object]) -> None:
    """Against 128 links, at nodes of 16, but for those beside a clamped end; means over both links miss F h / 6."""
    found = {}
    for links in (16, 32, 128):
        deck = {"start": [0, 0], "end": [LENGTH, 0], "length": LENGTH, "mass": MASS, "axial_stiffness": 1e10,
                "bending_stiffness": EI, "elements": links, **end}  # fmt: skip
        load = {"kind": "force", "on": "deck", "force": [0, -1e5], "travel": {"speed": SPEED}}
        run = {"kind": "dynamic", "geometry": "linearised", "until": 0.85, "every": 0.01}
        tree = {"lines": {"deck": deck}, "loads": {"axle": load}, "run": run, "gravity": 0.0}
        moment = responses(simulate(Scenario.model_validate(tree)))[0]["deck"].moment
        found[links] = moment[:, :: links // 16][:, 1:-2]
    largest = np.abs(found[128]).max()
    away = [np.abs(found[links] - found[128]).max() / largest for links in (16, 32)]
    assert away[0] < 2.5e-2
    assert away[1] < away[0] / 4.0


def test_the_energy_of_an_oscillator_on_a_beam_closes() -> None:
    times = np.linspace(0.0, 0.9, 181)
    load = rolling(beam_vehicle.oscillator(5750.0, load_stiffness=1595e3), SPEED)
    for ends in ("pinned", "clamped"):
        wire = straight(LENGTH, 0.0, MASS, EI, ends=(ends, ends))
        energy = np.array([frame.energy for frame in course(wire, [load], times, 24)[0]])
        missed = energy[:, ENERGY_FORMS.index("imbalance")]
        assert np.abs(missed).max() < 2e-5 * np.abs(energy).max()
