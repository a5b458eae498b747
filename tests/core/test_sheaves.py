"""Ropes over sheaves in the core: equilibria from bad drawings, slips, motions as exact, nodes that pass."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from core_structures import over_sheaves, step_of
from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, RunProperties, SpringProperties
from ropewalk.engine.equilibrium import find_equilibrium
from ropewalk.engine.library import variants
from ropewalk.engine.slipping import follow_slips
from ropewalk.errors import RopewalkError

Array = NDArray[np.float64]
DRAWINGS = pytest.mark.parametrize("drawing", ["straight", "arch", "zigzag", "noise"])


class Rope(NamedTuple):
    """A rope over a sheave, and the nodes at its ends."""

    bound: Bound
    begin: int
    end: int


def drawn(begin: Array, end: Array, links: int, drawing: str) -> Array:
    """Points (axis, node) between two points in the plane."""
    part, way, draw = np.arange(links + 1) / links, end - begin, np.random.default_rng(2)
    shapes = {"straight": 0.0 * part, "arch": 0.2 * np.sin(np.pi * part), "zigzag": 0.05 * (np.arange(links + 1) % 2),
              "noise": 0.05 * draw.normal(size=links + 1)}  # fmt: skip
    aside = shapes[drawing]
    aside[[0, -1]] = 0.0
    return np.asarray(begin[:, None] + way[:, None] * part + np.array([[-way[1]], [way[0]]]) * aside)


def add_rope(builder: Builder, corners: list[list[float]], run: RunProperties, links: int, share: float, drawing: str,
             friction: float = 0.0) -> tuple[int, int]:  # fmt: skip
    """Add a rope of so many links, of which a share is drawn before its sheave; return its ends."""
    begin, corner, end = (np.array(each) for each in corners)
    sheave, first = builder.add_node(corner, 0.0), round(share * links)
    builder.fix(sheave)
    a, _ = builder.add_run(drawn(begin, corner, first, drawing)[:, :-1], run)
    _, b = builder.add_run(drawn(corner, end, links - first, drawing)[:, 1:], run)
    builder.add_sheave(sheave, friction)
    return a, b


def tower(drawing: str, length: float = 92.0, links: int = 60, EA: float = 1e7, share: float = 0.55) -> Rope:
    """The input c-p3-31: from a tower's foot over its sheave to an anchor, with 2 m to spare."""
    builder = Builder()
    run = RunProperties(length / links, 1.0, EA)
    a, b = add_rope(builder, [[-50.0, 100.0], [0.0, 100.0], [0.0, 60.0]], run, links, share, drawing)
    builder.fix(a, b)
    return Rope(Bound(*builder.build()), a, b)


def guided(drawing: str, links: int = 80, share: float = 0.4) -> Rope:
    """The input t-12: two equal weights over a sheave, each on a guide with a spring."""
    builder = Builder()
    run = RunProperties(8.0 / links, 0.02, 2e5, axial_damping=5.0)
    ends = add_rope(builder, [[-0.05, -4.0], [0.0, 0.0], [0.05, -4.0]], run, links, share, drawing, 0.03)
    for end, x in zip(ends, (-0.05, 0.05), strict=True):
        foot = builder.add_node([x, -5.0], 0.0)
        builder.add_mass(end, 6.0)
        builder.fix(end, axes=[0])
        builder.fix(foot)
        builder.add_spring(foot, end, SpringProperties(100.0, 1.0))
    return Rope(Bound(*builder.build()), *ends)


def pulley(drawing: str, links: int = 31, at: tuple[float, float] = (-0.1, 1.0)) -> tuple[Rope, int]:
    """The input c-p3-12: 1 kg and 1.5 kg over a pulley, the second held by a thread, too; and the thread's end."""
    builder = Builder()
    run = RunProperties(1.5 / links, 1e-3, 2e4)
    a, b = add_rope(builder, [list(at), [0.0, 2.0], [0.1, 1.5]], run, links, 0.6, drawing)
    builder.add_mass(a, 1.0)
    builder.add_mass(b, 1.5)
    thread, last = builder.add_run(
        drawn(np.array([0.1, 2.5]), np.array([0.1, 1.5]), 5, drawing), RunProperties(0.2, 1e-3, 2e4)
    )
    builder.fix(thread)
    builder.join(last, b)
    return Rope(Bound(*builder.build()), a, b), thread


@DRAWINGS
@pytest.mark.parametrize("changes", [{}, {"links": 59}, {"links": 20}, {"EA": 1e5}, {"EA": 1e9}, {"share": 0.2}])
def test_a_rope_over_a_sheave_has_the_tension_of_its_catenary(drawing: str, changes: dict[str, float]) -> None:
    """The catenary of 52 m over 50 m has 564.55 N at its ends, if it does not stretch; the tail bears 40 m less."""
    rope = tower(drawing, **changes)  # type: ignore[arg-type]
    assert find_equilibrium(rope.bound, 500).outcome == "found"
    sheaves, pull = rope.bound.sheaves(), np.hypot(*rope.bound.forces()[:, [rope.begin, rope.end]])
    stretched = 0.07 if changes.get("EA") == 1e5 else 1.6e-3  # by 0.5 %, and by 5e-5
    mesh = 0.006 if changes.get("links") == 20 else 0.0
    assert pull[0] == pytest.approx(564.55, rel=stretched + mesh)
    # but for half of the strain of what the pieces weigh, and rounding
    assert sheaves.before == pytest.approx(sheaves.behind, rel=10.0 / changes.get("EA", 1e7) + 2e-8)
    assert pull[1] == pytest.approx(sheaves.behind[0] - 40.0 * 9.81, rel=0.02 if "EA" in changes else 1e-3)


@DRAWINGS
@pytest.mark.parametrize("length", [94.0, 110.0])
def test_a_slack_tail_hangs_at_the_sheave(drawing: str, length: float) -> None:
    """Tensions on both sides are equal, so that the sheave is in balance with both ends and the weight."""
    rope = tower(drawing, length)
    assert find_equilibrium(rope.bound, 500).outcome == "found"
    borne = -rope.bound.forces()[:, [rope.begin, rope.end, rope.bound.model.sheave_node[0]]].sum(axis=1)
    assert borne == pytest.approx([0.0, length * 9.81], abs=1e-6)
    assert rope.bound.sheaves().before == pytest.approx(rope.bound.sheaves().behind, rel=1e-6)


@DRAWINGS
@pytest.mark.parametrize("links", [78, 79, 80, 20])
def test_equal_weights_over_a_sheave_come_to_rest(drawing: str, links: int) -> None:
    """6 kg on each side less what the springs bear, above 4 m of rope: with any number of links."""
    rope = guided(drawing, links)
    assert find_equilibrium(rope.bound, 500).outcome == "found"
    heights = rope.bound.state.position[1, [rope.begin, rope.end]]
    assert heights[0] == pytest.approx(heights[1], abs=1e-9)
    vertical = 6.0 * 9.81 - 100.0 * (-4.0 - heights[0]) + 0.02 * 4.0 * 9.81
    assert rope.bound.sheaves().before == pytest.approx(vertical * np.hypot(1.0, 0.05 / 4.0), rel=5e-6)  # it sags
    assert rope.bound.sheaves().before == pytest.approx(rope.bound.sheaves().behind, rel=2e-7)


@DRAWINGS
@pytest.mark.parametrize("at", [(-0.1, 1.0), (-0.6, 2.5), (0.4, 1.7), (-1.1, 0.5)])
def test_weights_over_a_pulley_come_to_rest_from_any_drawing(drawing: str, at: tuple[float, float]) -> None:
    """The rope of 1 g/m bears 1 kg, and the thread the other half of a kilogram."""
    rope, thread = pulley(drawing, at=at)
    assert find_equilibrium(rope.bound, 500).outcome == "found"
    assert rope.bound.sheaves().before == pytest.approx(9.81, rel=1.1e-3)  # its own weight
    assert np.hypot(*rope.bound.forces()[:, thread]) == pytest.approx(4.905, rel=6e-3)  # its own, and 1 : 13 of slope


def capstan(friction: float, axes: int = 2) -> Rope:
    """A rope without weight over a sheave between two held ends, whose second one is 8 m away."""
    builder, run = Builder(axes, gravity=0.0), RunProperties(0.5, 1.0, 1e4)
    begin, end = np.array([-4.0, *[0.0] * (axes - 2), -4.0]), np.array([5.0, *[2.0] * (axes - 2), -3.0])
    sheave = builder.add_node(np.zeros(axes), 0.0)
    a, _ = builder.add_run(begin[:, None] * np.arange(11, 0, -1) / 11, run)
    _, b = builder.add_run(end[:, None] * np.arange(1, 12) / 11, run)
    builder.add_sheave(sheave, friction)
    builder.fix(sheave, a, b)
    return Rope(Bound(*builder.build()), a, b)


@pytest.mark.parametrize("axes", [2, 3])
def test_a_rope_sticks_and_slips_where_euler_and_eytelwein_say(axes: int) -> None:
    """Its end is drawn out and let in: T2/T1 is exp(mu angle), then in between, then exp(-mu angle)."""
    rope, kinds = capstan(0.3, axes), list[int]()
    state, end = rope.bound.state, rope.bound.state.position[:, rope.end].copy()
    for part in (*np.linspace(0.0, 0.1, 6), *np.linspace(0.09, -0.05, 15)):
        before = state.position[0, rope.bound.model.sheave_split[0]] + 0.5 * state.run_links[0]
        state.position[:, rope.end] = (1.0 + part) * end
        assert follow_slips(rope.bound).outcome == "found"
        sheaves = rope.bound.sheaves()
        slip = state.position[0, rope.bound.model.sheave_split[0]] + 0.5 * state.run_links[0] - before
        limit, ratio = np.exp(0.3 * sheaves.angle[0]), float(sheaves.behind[0] / sheaves.before[0])
        kinds.append(0 if abs(slip) < 1e-12 else int(np.sign(slip)))
        if kinds[-1]:
            assert ratio == pytest.approx(limit ** -kinds[-1], rel=1e-6)
        else:
            assert 1.0 / limit < ratio < limit
    assert kinds[1:6] == [-1] * 5
    assert sorted(kinds[6:]) == kinds[6:]  # sticks, then slips back
    assert kinds[6:9] == [0] * 3
    assert kinds[-3:] == [1] * 3


def hung(links: int, longer: int, EA: float, masses: tuple[float, float] = (0.0, 0.0), friction: float = 0.0,
         line_mass: float = 1.0) -> Rope:  # fmt: skip
    """A rope of 2.4 m that hangs straight down on both sides of a sheave, by so many links more on the second one."""
    h, first = 2.4 / links, (links - longer) // 2
    builder, run = Builder(), RunProperties(h, line_mass, EA)
    sheave = builder.add_node([0.0, 0.0], 0.0)
    builder.fix(sheave)
    a, _ = builder.add_run([[0.0] * first, -h * np.arange(first, 0, -1)], run)
    _, b = builder.add_run([[0.0] * (links - first), -h * np.arange(1, links - first + 1)], run)
    builder.add_sheave(sheave, friction)
    builder.add_mass(a, masses[0])
    builder.add_mass(b, masses[1])
    return Rope(Bound(*builder.build()), a, b)


def advanced(rope: Rope, time: float, factor: int = 1) -> Array:
    """Move a rope over a time; return by how much its two ends have gone down, m."""
    begin, h = rope.bound.state.position[1, [rope.begin, rope.end]].copy(), rope.bound.model.link_length[0]
    line = rope.bound.model.line_mass[0] / rope.bound.model.axial_stiffness[0]
    steps = factor * int(4.0 * time / (h * np.sqrt(line)))
    assert rope.bound.advance(steps, time / steps).outcome == "done"
    return np.asarray(begin - rope.bound.state.position[1, [rope.begin, rope.end]])


@pytest.mark.parametrize("masses", [(0.0, 0.0), (1.0, 1.3)])
def test_a_heavy_rope_runs_off_a_sheave_as_cosh(masses: tuple[float, float]) -> None:
    """(m1 + m2 + rho L) x'' = (m2 - m1) g + 2 rho g x; it stretches, which goes with 1/EA."""
    rate = np.sqrt(2.0 * 9.81 / (sum(masses) + 2.4))
    begin = 0.1 + (masses[1] - masses[0]) / 2.0
    exact = begin * (np.cosh(rate * 0.6) - 1.0)
    errors = []
    for EA in (1e5, 1e6):
        rope = hung(24, 2, EA, masses)
        down = advanced(rope, 0.6)
        errors.append(abs(0.5 * (down[1] - down[0]) / exact - 1.0))
        assert rope.bound.state.run_links[0] < 9  # of 10
    print("cosh", masses, errors)
    assert errors[0] < 1e-3
    assert errors[1] < 0.2 * errors[0]


def test_a_rope_that_rubs_at_a_sheave_sticks_or_runs() -> None:
    """Light rope, weights on both sides: x'' = g (M2 - E M1)/(M2 + E M1) with E = exp(mu pi), 1.369."""
    E = np.exp(0.1 * np.pi)
    for mass in (1.3, 1.8):
        held = hung(24, 0, 4e6, (1.0, mass), friction=1.0, line_mass=1e-2)
        assert follow_slips(held.bound).outcome == "found"  # with the tensions of both weights
        rubs = held.bound.model.copy()
        rubs.sheave_friction[0] = 0.1
        rope = held._replace(bound=Bound(rubs, held.bound.state))
        split = rope.bound.state.position[0, rope.bound.model.sheave_split[0]]
        down = advanced(rope, 0.3)
        M1, M2 = 1.0 + 0.012, mass + 0.012
        exact = 0.5 * 9.81 * max(0.0, M2 - E * M1) / (M2 + E * M1) * 0.3**2
        print("rubs", mass, down, exact)
        if mass == 1.3:
            assert rope.bound.state.position[0, rope.bound.model.sheave_split[0]] == split
        else:
            assert down == pytest.approx([-exact, exact], rel=5e-3)  # waves shake it as it starts: by EA^-1/2


def test_a_rope_that_is_drawn_over_a_sheave_slips_at_the_limit() -> None:
    """In steady motion T2 = T1 exp(mu angle) while nodes pass, and friction takes (T2 - T1) times the way."""
    builder, run, turn = Builder(gravity=0.0), RunProperties(0.1, 0.1, 1e4, 5.0), 2.0
    sheave = builder.add_node([0.0, 0.0], 0.0)
    ways = np.array([[-1.0, 0.0], [np.cos(turn), np.sin(turn)]])[:, :, None]
    a, _ = builder.add_run(ways[0] * 0.1005 * np.arange(21, 0, -1), run)
    _, b = builder.add_run(ways[1] * 0.1005 * np.arange(1, 22), run)
    builder.add_sheave(sheave, 0.3)
    builder.fix(sheave, a, b)
    bound = Bound(*builder.build())
    bound.state.velocity[:, [a, b]] = 0.2 * np.array([-ways[0, :, 0], ways[1, :, 0]]).T
    dt = 0.4 * step_of(bound)
    steps = int(0.25 / dt)
    bound.advance(2 * steps, dt)
    for _ in range(4):
        lost = bound.state.sheave_loss[0]
        bound.advance(steps, dt)
        sheaves = bound.sheaves()
        assert sheaves.angle == pytest.approx(turn, abs=1e-9)
        assert sheaves.behind / sheaves.before == pytest.approx(np.exp(0.3 * sheaves.angle), rel=5e-5)  # its inertia
        power = (bound.state.sheave_loss[0] - lost) / (steps * dt)
        assert power == pytest.approx(
            0.2 * (sheaves.behind[0] - sheaves.before[0]), rel=0.02
        )  # it is stretched by 0.5 %
    assert bound.state.run_links[0] < 18  # of 20


def swinging(links: int, factor: int = 1) -> tuple[Array, float, float]:
    """An Atwood machine whose lighter weight swings: positions of both, energy missed, and lost where nodes pass."""
    h, first = 2.4 / links, links // 2
    builder, run = Builder(), RunProperties(h, 0.5, 1e5)
    sheave = builder.add_node([0.0, 0.0], 0.0)
    builder.fix(sheave)
    a, _ = builder.add_run(np.array([[-0.6], [-0.8]]) * h * np.arange(first, 0, -1), run)
    _, b = builder.add_run([[0.0] * first, -h * np.arange(1, first + 1)], run)
    builder.add_sheave(sheave)
    builder.add_mass(a, 1.0)
    builder.add_mass(b, 2.0)
    bound = Bound(*builder.build())
    begin, steps = sum(bound.potentials()), factor * 200 * links
    assert bound.advance(steps, 0.5 / steps).outcome == "done"
    kinetic, lost = bound.kinetic_energy(), float(bound.state.sheave_loss[0])
    missed = sum(bound.potentials()) + kinetic - begin + lost
    return bound.state.position[:, [a, b]], missed / kinetic, lost / kinetic


def test_motions_over_a_sheave_converge_and_energy_is_accounted_for() -> None:
    """Of the second order of the mesh, while 4, 8 and 16 nodes pass."""
    found = [swinging(links) for links in (24, 48, 96)]
    places, missed, lost = zip(*found, strict=True)
    order = np.log2(np.abs(places[0] - places[1])[:, 0].max() / np.abs(places[1] - places[2])[:, 0].max())
    print("swinging", order, missed, lost, swinging(24, 4)[1])
    assert order > 1.8
    assert np.abs(missed).max() < 1e-5
    assert np.abs(lost).max() < 3e-4
    assert abs(lost[2]) < 0.6 * abs(lost[0])


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_division_and_resume_over_a_sheave_change_no_bit(friction: float) -> None:
    """1000 steps in which nodes pass are 10 times 100, also from copies of the State, and in every variant."""
    step = 2.0**-13
    whole = over_sheaves(3, 10.0, friction)
    before = whole.state.run_links.copy()
    whole.advance(1000, step)
    assert np.any(whole.state.run_links != before)
    for variant in variants():
        part = over_sheaves(3, 10.0, friction)
        for _ in range(10):
            part = Bound(part.model, part.state.copy())
            part.advance(100, step, variant)
        np.testing.assert_array_equal(part.state.memory, whole.state.memory)


def test_nodes_pass_back_and_return_where_they_were() -> None:
    """A rope that runs to and fro without weight and stretch has the same nodes at the same places."""
    bound = over_sheaves(friction=0.0, speed=0.0)
    split = bound.model.sheave_split[0]
    begin, links = bound.state.position.copy(), bound.state.run_links.copy()
    bound.state.position[0, split] = 0.19
    assert bound.pass_nodes() == 1
    assert bound.state.run_links.tolist() == [links[0] - 1, links[1] + 1, links[2]]
    assert bound.state.position[0, split] == pytest.approx(0.69)
    bound.state.position[0, split] = 0.81
    assert bound.pass_nodes() == 1
    assert bound.state.run_links.tolist() == links.tolist()
    first = bound.state.run_first[1] - 1
    assert bound.state.position[0, split] == pytest.approx(0.31)
    assert bound.state.position[:, first] == pytest.approx(begin[:, first], abs=0.15)  # as long as the piece was drawn


def test_momentum_goes_from_nodes_that_pass_to_a_sheave_that_moves() -> None:
    bound = over_sheaves()
    model, state, block = bound.model, bound.state, bound.model.sheave_node[1]
    moves = np.all(model.mobility > 0.0, axis=0)
    state.velocity[:, block] = 0.3, -2.0
    state.position[0, model.sheave_split[1]] = 0.19
    begin = (state.velocity[:, moves] / model.mobility[:, moves]).sum(axis=1)
    speeds = state.velocity.copy()
    assert bound.pass_nodes() == 1
    assert not np.allclose(state.velocity, speeds)
    end = (state.velocity[:, moves] / model.mobility[:, moves]).sum(axis=1)
    np.testing.assert_allclose(end, begin, rtol=1e-12)


def test_a_rope_that_has_come_to_its_end_ends_the_motion() -> None:
    rope = hung(24, 14, 1e5)
    taken, outcome = rope.bound.advance(10**6, 2e-5)
    assert outcome == "ended"
    assert rope.bound.state.run_links[0] == 1
    assert 10_000 < taken < 100_000


SPOILT = [
    ("sheave_run", 0, 2, "sheave_run[0] is 2; a rope over a sheave is two runs"),
    ("sheave_run", 1, 0, "sheave_run[1] is 0; a rope"),
    ("axial_stiffness", 1, 2e4, "sheave_run[0] is 0; a rope"),
    ("link_length", 2, 0.4, "sheave_run[1] is 1; a rope"),
    ("run_links", 0, 5, "sheave_run[0] is 0; a rope"),
    ("mobility", (0, 5), 1.0, "mobility[0, 5] is 1.0; a rope"),
    ("weight", (1, 12), -1.0, "weight[0, 12] is 0.0; a rope"),
    ("sheave_split", 0, 1, "sheave_split[0] is 1; a rope"),
    ("sheave_split", 1, 21, "sheave_split[1] is 21; a rope"),
    ("sheave_node", 0, 5, "mobility[0, 5] is 2.0; a rope"),
    ("spring_begin", 0, 12, "mobility[0, 12] is 2.0; a rope"),
    ("position", (0, 21), 0.0, "position[0, 21] is 0.0; a rope"),
    ("position", (0, 22), 1.1, "position[0, 22] is 1.1; a rope"),
    ("sheave_node", 0, 99, "sheave_node[0] is node 99; nodes are 0 to 22"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "entry", "value", "message"), SPOILT)
def test_what_is_no_rope_over_a_sheave_is_refused(name: str, entry: int, value: float, message: str) -> None:
    sound = over_sheaves()
    model, state = sound.model.copy(), sound.state.copy()
    Bound(model.copy(), state.copy())
    getattr(state if name in state.names() else model, name)[entry] = value
    with pytest.raises(RopewalkError) as caught:
        Bound(model, state)
    assert str(caught.value).startswith(message)


def test_no_force_travels_over_a_sheave() -> None:
    builder, run = Builder(), RunProperties(0.1, 1.0, 1e4)
    sheave = builder.add_node([0.0, 0.0], 0.0)
    builder.fix(sheave)
    for way in (-1.0, 1.0):
        builder.add_run([way * 0.1 * np.arange(1, 5)[:: int(way)], [-0.1] * 4], run)
    builder.add_sheave(sheave)
    builder.add_force(1, [0.0, -1.0], 0.0, 1.0)
    with pytest.raises(RopewalkError, match=r"contact_run\[0\] is 1; a rope over a sheave"):
        Bound(*builder.build())


def test_the_energy_is_infinite_where_a_piece_would_have_no_length() -> None:
    bound = over_sheaves()
    for split in (-0.1, 0.0, 1.0, 1.2):
        bound.state.position[0, bound.model.sheave_split[0]] = split
        assert bound.potentials().elastic == np.inf
