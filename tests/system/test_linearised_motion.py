"""Motion that is linearised about rest: the second-order expansion of the energy of cable runs.

Sources: superposition; the spectrum of the same network; a force on any course along a taut string by images
(`ropewalk.theory.image_sum`); the same motion with all geometry as the load goes to nothing; a mass that crosses a
beam, in modes (`ropewalk.theory.beam_crossing`), and on the engine of beams, which moves them vertically alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg as linalg

from motion_cases import order
from ropewalk.capabilities import SYSTEM, WIRES, engine_of
from ropewalk.cosim import stepwise
from ropewalk.errors import EquilibriumError, ScenarioError
from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.simulate import simulate, spectrum_of
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.equilibrium.rest import about_rest, at_rest
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.equilibrium.structures import structure_of
from ropewalk.system.loads.loaded_structure import LoadedStructure
from ropewalk.theory import beam_crossing
from ropewalk.theory.image_sum import travelling_force
from system_cases import ROPE, TRIPOD, frames_of, imbalance, scenario, with_steps_of

SAGGING = {**ROPE, "bending_stiffness": 50.0}
GEOMETRIES = ("linearised", "nonlinear")
STRUCTURES = {"slack rope": {"deck": ROPE}, "joined ropes": TRIPOD, "stiff cable": {"deck": SAGGING}}


def motion(
    lines: dict[str, Any], loads: dict[str, Any], until: float = 0.6, geometry: str = "linearised", **run: Any
) -> Scenario:
    run = {"kind": "dynamic", "until": until, "every": until / 6.0, "geometry": geometry} | run
    return scenario(lines, loads, until, 0.1, gravity=9.81, run=run)


def force(size: float, **keys: Any) -> dict[str, Any]:
    travel = {"speed": 6.0, "from": 4.0} | keys.pop("travel", {})
    return {"kind": "force", "on": "deck", "force": [0.3 * size, -size], "travel": travel} | keys


def moves(given: Scenario) -> np.ndarray:
    """Places of nodes and of the first contact, (frame, place, axis) m."""
    return np.array([np.vstack([frame.position, frame.contact_position[:1]]) for frame in frames_of(given)])


@pytest.mark.parametrize("structure", STRUCTURES)
@pytest.mark.parametrize(
    "keys", [{}, {"contact": "frictionless"}, {"travel": {"measured": "horizontal"}}, {"travel": {"measured": "slip"}}],
    ids=["clamped", "frictionless", "horizontal", "slip"],
)  # fmt: skip
def test_given_forces_add_up(structure: str, keys: dict[str, Any]) -> None:
    """However large: places of 20 m are rounded to 4e-15 m, and their links have stiffnesses of 2e5 N/m."""
    lines = STRUCTURES[structure]
    one, other = force(40.0, **keys), force(-25.0, **keys)
    other["travel"] = {**other["travel"], "from": 12.0}
    bare = moves(motion(lines, {"a": {**one, "force": [0.0, 0.0]}}))
    first, both = moves(motion(lines, {"a": one})) - bare, moves(motion(lines, {"a": one, "b": other})) - bare
    second = moves(motion(lines, {"a": {**one, "force": [0.0, 0.0]}, "b": other})) - bare
    twice = moves(motion(lines, {"a": {**one, "force": [24.0, -80.0]}})) - bare
    assert np.abs(first).max() > 0.1
    assert np.abs(both - first - second).max() < 1e-10 * np.abs(both).max()
    assert np.abs(twice - 2.0 * first).max() < 1e-10 * np.abs(twice).max()


def test_its_energy_has_the_forces_and_the_stiffness_of_rest() -> None:
    """Central differences of a quadratic are exact; its second derivatives are those of all geometry at rest."""
    beam = {**SAGGING, "start_support": {"kind": "fixed", "clamped": True}, "foundation": 20.0, "elements": 6}
    found = structure_of(motion({"deck": beam}, {}), 0.0)
    structure, rest = at_rest(found.structure, np.array([0.0, -9.81]), found.near)
    full, small = (
        SystemPotential(one, LoadedStructure(one, rest), 20.0) for one in (structure, about_rest(structure, rest))
    )  # fmt: skip
    r = (rest + 0.5 * np.random.default_rng(1).standard_normal(rest.shape)).ravel()
    K = full.stiffness(rest.ravel()).toarray()
    assert small.stiffness(r).toarray() == pytest.approx(K, rel=1e-9, abs=1e-9 * np.abs(K).max())
    unknowns, step = small.free.shape[1], 0.1
    for i in range(unknowns):
        way = np.zeros(unknowns)
        way[i] = step
        ahead, behind = small.moved(r, way), small.moved(r, -way)
        slope = (small.energy(ahead) - small.energy(behind)) / (2.0 * step)
        scale = np.abs(K[i]).max()
        assert small.out_of_balance(r)[i] == pytest.approx(-slope, rel=1e-9, abs=1e-9 * scale)
        row = (small.out_of_balance(behind) - small.out_of_balance(ahead)) / (2.0 * step)
        assert np.abs(K[i] - row).max() < 1e-9 * scale


def test_a_network_swings_in_the_modes_of_its_spectrum() -> None:
    """It stays in one, however far it is deflected; Verlet's frequency is 2/dt asin(w dt/2)."""
    lines = {name: {**line, "axial_damping": 0.0} for name, line in TRIPOD.items()}
    given = motion(lines, {}, until=0.5)

    def missed(part: float) -> float:
        scene = with_steps_of(given, part)
        times = np.linspace(0.0, 0.5, 26)
        moving = SystemMotion(scene, RunInfo(), times)
        structure = moving.structure._replace(about=moving.structure.about.nothing(2))
        potential = SystemPotential(structure, LoadedStructure(structure, moving.rest), 20.0)
        K, M = potential.stiffness(moving.rest.ravel()).toarray(), potential.masses().toarray()
        squares, modes = linalg.eigh(K, M)
        w, mode = float(np.sqrt(squares[4])), modes[:, 4]
        shape = (potential.free @ mode).reshape(moving.rest.shape)
        moving.state.r[:] += shape / np.abs(shape).max()  # by 1 m
        seen = []
        for i in range(times.size):
            assert moving.advance(i) is None
            away = (moving.state.r - moving.rest) * np.abs(shape).max()
            q = float(mode @ (M @ np.linalg.lstsq(potential.free.toarray(), away.ravel(), rcond=None)[0]))
            assert np.abs(away - q * shape).max() < 1e-8 * np.abs(shape).max()
            seen.append(q)
        return float(np.abs(seen - np.cos(w * times)).max())

    errors = [missed(part) for part in (1.0, 0.5, 0.25)]
    assert errors[-1] < 1e-3
    assert 1.95 < order([4.0, 2.0, 1.0], errors) < 2.05


def test_a_force_on_a_taut_string_is_that_of_images() -> None:
    """A push of half the tension that comes and goes; bounds are twice what was seen.

    At the load between the second and the third order; far from it by the shortest waves of the mesh, which a load
    makes that passes its nodes: to the first, 1e-4 of the deflection.
    """
    speed, until, stretch = 0.4, 1.5, 1.0 + 1e-4
    times = np.linspace(0.0, until, 31)

    def push(t: Any) -> Any:
        return 0.5 * np.sin(np.pi * np.asarray(t) / until) ** 4

    def error(elements: int) -> tuple[float, float]:
        t = np.linspace(0.0, until, 2001)
        string = {"start": [0, 0], "end": [1, 0], "length": 1.0 / stretch, "mass": 1.0, "axial_stiffness": 1e4,
                  "elements": elements}  # fmt: skip
        table = {"time": t.tolist(), "value": [[0.0, -float(push(a))] for a in t]}
        load = {"kind": "force", "on": "s", "force": table, "travel": {"speed": speed, "from": 0.2}}
        run = {"kind": "dynamic", "until": until, "every": until / 30.0, "geometry": "linearised"}
        frames = frames_of(scenario({"s": string}, {"p": load}, until, until / 30.0, run=run), times)
        own = {"length": 1.0 / stretch, "tension": 1.0 / stretch, "mass": 1.0}
        xi = np.arange(elements + 1) / elements / stretch

        def path(at: Any) -> Any:
            return 0.2 + speed * np.asarray(at)

        missed, under_it = [], []
        for frame in frames[1:]:
            exact = travelling_force(xi, frame.path, path=path, force=push, **own)
            beside = np.abs(xi - path(frame.path)) > 0.2  # not where nodes share the load
            missed.append(np.abs(-frame.position[:, 1] - exact)[beside].max())
            under = travelling_force(path(frame.path), frame.path, path=path, force=push, **own)
            under_it.append(abs(-frame.contact_position[0, 1] - float(under)))
        return max(under_it), max(missed)

    at_it, beside_it = zip(*(error(n) for n in (32, 64, 128)), strict=True)
    print(at_it, beside_it)
    assert at_it[-1] < 4.4e-6
    assert 2.2 < order([4.0, 2.0, 1.0], list(at_it)) < 2.8
    assert beside_it[-1] < 1.3e-5


@pytest.mark.parametrize("structure", STRUCTURES)
@pytest.mark.parametrize("kind", ["force", "oscillator"])
def test_it_is_what_all_geometry_tends_to_as_the_load_vanishes(structure: str, kind: str) -> None:
    """What differs goes with the square of the load."""

    def differs(size: float) -> float:
        load = force(size)
        if kind == "oscillator":
            load = {"kind": "oscillator", "mass": size / 10.0, "stiffness": 20.0 * size, "on": "deck",
                    "travel": {"speed": 0.0, "from": 6.0}}  # fmt: skip
        ends = [
            frames_of(motion(STRUCTURES[structure], {"a": load}, 0.3, geometry, step=2e-4))[-1].position
            for geometry in GEOMETRIES
        ]
        return float(np.abs(ends[1] - ends[0]).max())

    sizes = [2.0, 1.0, 0.5]
    found = [differs(size) for size in sizes]
    print(found)
    assert 1.8 < order(sizes, found) < 2.2


BEAM = {"start": [0, 0], "end": [10, 0], "tension": 1.0, "mass": 100.0, "axial_stiffness": 1e7,
        "bending_stiffness": 1e6}  # fmt: skip


def crosses(elements: int, *, by_beams: bool) -> tuple[np.ndarray, np.ndarray]:
    """Times in s and heights in m of a mass that crosses a beam without weight at 12 m/s."""
    until = 10.0 / 12.0
    load = {"kind": "mass", "mass": 300.0, "force": [0.0, -300.0 * 9.81], "on": "b",
            "travel": {"speed": 12.0, "from": 0.0, "at_end": "leave"}}  # fmt: skip
    run = {"kind": "dynamic", "until": 0.95 * until, "every": 0.05 * until, "geometry": "linearised"}
    given = scenario({"b": {**BEAM, "elements": elements}}, {"p": load}, until, 0.05 * until, run=run)
    if by_beams:
        assert engine_of(given) is WIRES
        result = simulate(given)
        return np.asarray(result.time), np.asarray(result.contact_position.sel(axis="z"))[:, 0]
    frames = frames_of(given)
    return np.array([f.path for f in frames]), np.array([f.contact_position[0, 1] for f in frames])


def test_a_mass_that_crosses_a_beam_is_that_of_modes_and_of_the_engine_of_beams() -> None:
    """Errors over the largest deflection; bounds are twice what was seen. What both differ by is the other one's."""
    errors, apart = [], []
    for elements in (12, 24, 48):
        times, heights = crosses(elements, by_beams=False)
        exact = beam_crossing.moving_mass(
            times, load_mass=300.0, speed=12.0, length=10.0, bending_stiffness=1e6, mass=100.0, tension=1.0
        )
        scale = np.abs(exact.deflection).max()
        errors.append(float(np.abs(-heights - exact.deflection.ravel()).max() / scale))
        apart.append(float(np.abs(heights - crosses(elements, by_beams=True)[1]).max() / scale))
    print(errors, apart)
    assert errors[-1] < 1.6e-5
    assert 2.6 < order([4.0, 2.0, 1.0], errors) < 3.5
    assert apart[-1] < 1.4e-4
    assert apart[-1] < 0.3 * apart[-2] < 0.12 * apart[0] * 2.0  # beams bear rigid masses to the second order at last


@pytest.mark.parametrize("kind", ["mass", "oscillator", "trolley", "free"])
@pytest.mark.parametrize("structure", STRUCTURES)
def test_its_energy_audit_closes(kind: str, structure: str) -> None:
    travel: dict[str, Any] = {"speed": 6.0, "from": 4.0}
    load = {
        "mass": {"kind": "mass", "mass": 2.0}, "free": {"kind": "mass", "mass": 2.0},
        "oscillator": {"kind": "oscillator", "mass": 2.0, "stiffness": 400.0, "damping": 3.0},
        "trolley": {"kind": "trolley", "mass": 1.0, "payload": {"mass": 2.0, "length": 1.0}},
    }[kind]  # fmt: skip
    if kind == "free":
        travel |= {"kind": "free", "friction": 0.05, "speed": 3.0}
    given = motion(STRUCTURES[structure], {"p": load | {"on": "deck", "travel": travel}}, 0.9)
    missed = [imbalance(frames_of(with_steps_of(given, part))) for part in (1.0, 0.5)]
    print(missed)
    # Verlet's method: a quarter with half the step; a contact without mass follows its damper to the first order, and
    # friction that begins or ends does so within a step. Bounds are twice what was seen.
    assert missed[1] < {"oscillator": 5e-5, "free": 4e-6}.get(kind, 2e-6)
    assert missed[1] < {"oscillator": 0.55, "free": 0.75}.get(kind, 0.45) * missed[0]


@pytest.mark.parametrize("kind", ["force", "mass", "oscillator"])
@pytest.mark.parametrize("structure", STRUCTURES)
def test_what_rests_linearised_with_its_loads_stays_there(kind: str, structure: str) -> None:
    """As far from rest as a quarter of the sag, where all geometry would differ by a tenth of that."""
    load = {
        "force": {"force": [10.0, -60.0]}, "mass": {"mass": 6.0},
        "oscillator": {"mass": 6.0, "stiffness": 400.0, "damping": 3.0},
    }[kind]  # fmt: skip
    loads = {"p": {"kind": kind, "on": "deck", "travel": {"speed": 0.0, "from": 6.3}} | load}
    frames = frames_of(motion(STRUCTURES[structure], loads, start={"with_loads": True}))
    bare = frames_of(motion(STRUCTURES[structure], {}))[0]
    assert np.abs(frames[0].position - bare.position).max() > 0.3
    assert max(float(np.abs(frame.velocity).max()) for frame in frames) < 1e-8


@pytest.mark.parametrize("kind", ["trolley", "walker"])
def test_what_only_the_system_bears_goes_over_a_beam_as_with_all_geometry_if_that_is_stiff(kind: str) -> None:
    """A beam that is twice as stiff, taut and heavy yields half as much, and what differs is a quarter."""
    load = {"trolley": {"kind": "trolley", "mass": 40.0, "payload": {"mass": 100.0, "length": 2.0}, "air_drag": 1.0},
            "walker": {"kind": "walker", "foot_mass": 1.0, "leg_damping": 100.0}}[kind]  # fmt: skip
    load |= {"on": "b", "travel": {"speed": 4.0, "from": 5.0}} if kind == "trolley" else {
        "on": "b", "speed": 1.2, "from": 8.0}  # fmt: skip

    def differs(times: float) -> float:
        line = {"start": [0, 0], "end": [20, 0], "tension": 2e4 * times, "mass": 40.0 * times,
                "axial_stiffness": 4e6 * times, "bending_stiffness": 1e5 * times, "elements": 40}  # fmt: skip
        ends = []
        for geometry in GEOMETRIES:
            given = motion({"b": line}, {"p": load}, 0.6, geometry, step=2e-4)
            assert engine_of(given) is SYSTEM
            ends.append(simulate(given).position.values[-1])
        return float(np.abs(ends[1] - ends[0]).max())

    found = [differs(times) for times in (2.0, 4.0, 8.0)]
    print(found)
    assert 1.75 < order([4.0, 2.0, 1.0], found) < 2.1


def test_who_computes_what_moves_linearised() -> None:
    straight = {**BEAM, "elements": 10}
    mass = {"kind": "mass", "mass": 1.0, "travel": {"speed": 1.0}}
    assert engine_of(motion({"b": straight}, {"p": mass | {"on": "b"}})) is WIRES
    free = {**mass, "on": "b", "travel": {"kind": "free", "speed": 1.0, "from": 1.0}}
    assert engine_of(motion({"b": straight}, {"p": free})) is SYSTEM
    for structure in STRUCTURES.values():
        assert engine_of(motion(structure, {"p": mass | {"on": "deck"}})) is SYSTEM


def test_a_rope_without_tension_bears_nothing_in_small_motion() -> None:
    rope = {"start": [0, 0], "end": [10, 0], "length": 10.0, "mass": 1.0, "axial_stiffness": 1e4, "elements": 10}
    given = scenario({"r": rope}, {}, 1.0, 1.0, run={"kind": "dynamic", "until": 1.0, "geometry": "linearised"})
    with pytest.raises(EquilibriumError, match="r is slack in equilibrium"):
        frames_of(given, np.array([0.0, 1.0]))


@pytest.mark.parametrize("structure", STRUCTURES)
def test_what_would_not_be_linearised_is_refused(structure: str) -> None:
    """Co-simulation of ropes alone, and spectra at an instant: other engines do them."""
    given = motion(STRUCTURES[structure], {"p": force(1.0)})
    if structure != "joined ropes":
        with pytest.raises(ScenarioError):
            stepwise(given, {})
    with pytest.raises(ScenarioError, match="linearised geometry is not implemented"):
        spectrum_of(given, at=0.1)


def test_its_spectrum_is_that_of_the_rest_that_it_moves_about() -> None:
    found = [spectrum_of(motion({"deck": SAGGING}, {}, geometry=geometry), how_many=6) for geometry in GEOMETRIES]
    small, full = (spectrum.modes.frequency for spectrum in found if spectrum.modes is not None)
    assert small == pytest.approx(full, rel=1e-12)
