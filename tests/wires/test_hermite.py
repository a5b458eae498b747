"""Wires in Hermite elements: closed forms, a plain Newmark beside the compiled one, and the model of EN 50318:2002.

Data, acceptance and converged answers of the standard's model: public secondary sources and independent calculations,
as collected in the notes on overhead lines; the standard itself is not open.
"""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np
import pytest
import scipy.linalg
from scipy.signal import butter, sosfiltfilt

import hermite
from ropewalk.errors import EquilibriumError, RopewalkError
from ropewalk.wires.plan import Array, Contact, EndKind, Hold, PointMass, Spot, TravellingLoad, Wire, WirePlan, WireTie

FIXED = (0.0, 0.0, np.inf)


def beam(length: float, ends: tuple[EndKind, EndKind] = ("held", "held"), **kinds: float) -> WirePlan:
    return WirePlan((Wire("beam", (0, 0, 0), (length, 0, 0), kinds.pop("tension", 0.0), 2.0, ends=ends, **kinds),))


@pytest.mark.parametrize(("stiffness", "order"), [(500.0, 4.0), (0.0, 6.0)])
def test_frequencies_of_a_tight_beam_converge_at_the_order_of_the_element(stiffness: float, order: float) -> None:
    length, mode, errors = 10.0, 3, []
    k = mode * np.pi / length
    exact = np.sqrt((stiffness * k**4 + 1e3 * k**2) / 2.0)
    for elements in (12, 24, 48):
        model = hermite.rest_of(beam(length, tension=1e3, bending_stiffness=stiffness), length / elements)
        free = model.free.ravel()
        K, M = (matrix.toarray()[np.ix_(free, free)] for matrix in (model.stiffness, model.mass))
        errors.append(np.sqrt(scipy.linalg.eigh(K, M, eigvals_only=True)[mode - 1]) / exact - 1.0)
    assert errors[0] > errors[1] > errors[2] > 0.0  # consistent mass: from above
    rates = np.log2(np.divide(errors[:-1], errors[1:]))
    print(rates)
    # The first of the errors at three elements a half-wave has terms of higher order left.
    assert rates[-1] == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize(("ends", "station", "part"), [(("clamped", "free"), 6.0, 3), (("clamped", "clamped"), 3, 192)])
def test_a_beam_yields_exactly_at_a_node(ends: tuple[EndKind, EndKind], station: float, part: float) -> None:
    EI, L = 700.0, 6.0
    model = hermite.rest_of(beam(L, ends, bending_stiffness=EI), 1.0)
    # L^3 / (3 EI) at the tip, L^3 / (192 EI) at midspan; to round-off of a matrix with condition 1e5.
    assert hermite.elasticity(model, 0, [station])[0] == pytest.approx(L**3 / (part * EI), rel=1e-9)


@pytest.mark.parametrize("tension", [0.0, 2e4])
def test_a_long_beam_on_a_bed_yields_as_an_endless_one(tension: float) -> None:
    k, EI = 2e3, 8e4
    model = hermite.rest_of(beam(80.0, tension=tension, bending_stiffness=EI, bed=k), 0.5)
    # 1 / (2 sqrt(k) sqrt(T + 2 sqrt(k EI))), lambda / (2 k) without tension; lengths of 3 m, elements with errors of
    # order (0.5 / 3)^4 / 720.
    exact = 0.5 / np.sqrt(k * (tension + 2.0 * np.sqrt(k * EI)))
    assert hermite.elasticity(model, 0, [40.0])[0] == pytest.approx(exact, rel=1e-5)


def test_a_string_yields_too_little_by_a_part_of_an_element() -> None:
    lacks = []
    for h in (0.5, 0.25, 0.125):
        model = hermite.rest_of(beam(20.0, tension=1e3), h)
        lacks.append(20.0 / 4e3 - hermite.elasticity(model, 0, [10.0])[0])
    # The kink under a force is rounded off by cubics without kinks: first order, and all of it beside the force.
    np.testing.assert_allclose(np.divide(lacks[:-1], lacks[1:]), 2.0, rtol=1e-6)


def tied(pushes: float, drag: float = 0.0, retardation: float = 0.0) -> WirePlan:
    """Two wires of unlike length and mesh with everything that may be attached."""
    low = Wire("low", (0, 0, 0), (9, 0, 0), 2e3, 1.3, 40.0, drag=drag, retardation=retardation, bed=50.0)
    high = Wire("high", (1, 0, 1), (12, 0, 1), 1e3, 0.9, drag=0.5 * drag)
    ties = tuple(
        WireTie(f"{x}", Spot(1, x - 1.0), Spot(0, x), 4e3, 0.9, pushes=pushes, mass=0.1) for x in (2.2, 4.0, 4.5, 7.0)
    )
    holds = (
        Hold("spring", Spot(0, 3.0), (0, 0, 5e3), (0, 0, 2.0 * drag)),
        Hold("fast", Spot(1, 8.0), FIXED, place=(0, 0, 1.0)),
    )
    arm = WireTie("arm", Spot(0, 5.5), (5.5, 1.0, 0.3), 1e4, 1.0, pushes=1e4)
    return WirePlan((low, high), (*ties, arm), holds, (PointMass(Spot(0, 6.0), 0.4),), watched={"six": Spot(0, 6.0)})


def all_springs(model: hermite.HermiteModel) -> tuple[Array, Array]:
    """Stiffness of everything if ties obey one law in both directions, and damping of what is not of the wires."""
    K, C = model.stiffness.toarray(), np.zeros((2 * model.station.size,) * 2)
    for tie, rise, force, far in zip(
        model.plan.ties, model.rest.tie_rise, model.rest.tie_force, model.rest.tie_distance, strict=True
    ):
        row = np.zeros(K.shape[0])
        row[2 * model.node(tie.spot)] = -1.0
        if isinstance(tie.other, Spot):
            row[2 * model.node(tie.other)] = 1.0
        K += np.outer(row, row) * (tie.stiffness * rise**2 + force / far * (1.0 - rise**2))
    for hold in model.plan.holds:
        i = 2 * model.node(hold.spot)
        if np.isfinite(hold.stiffness[2]):
            K[i, i] += hold.stiffness[2]
            C[i, i] += hold.damping[2]
    return K, C


def nothing(steps: int) -> hermite.StepInputs:
    return hermite.StepInputs(np.zeros((steps, 0)), np.zeros((steps, 0)), np.zeros((steps, 0)), np.zeros((steps, 0, 0)))


def plucked(model: hermite.HermiteModel) -> hermite.State:
    rng = np.random.default_rng(3)
    wires = np.zeros((3, model.station.size, 2))
    for w, (a, b) in enumerate(zip(model.first[:-1], model.first[1:], strict=True)):
        s = np.pi * model.station[a:b] / model.plan.wires[w].length
        for mode in (1, 2, 3):
            for kind, size in ((0, 1e-3), (1, 0.1)):
                amount = size * rng.standard_normal()
                wires[kind, a:b, 0] += amount * np.sin(mode * s)
                wires[kind, a:b, 1] += amount * mode * np.pi / model.plan.wires[w].length * np.cos(mode * s)
    wires *= model.free
    return hermite.State(wires, np.zeros((3, 0, 0)))


def with_inertia(model: hermite.HermiteModel, state: hermite.State, K: Array) -> hermite.State:
    inertia = -(K @ state.wires[0].ravel()).reshape(-1, 2) * model.free
    return hermite.State(np.stack([state.wires[0], state.wires[1], inertia]), state.moving_loads)


def test_without_damping_the_energy_stays_and_the_motion_can_be_turned_back() -> None:
    model = hermite.rest_of(tied(pushes=4e3), 0.25)
    K, _ = all_springs(model)
    M = model.mass.toarray()

    def energy(state: hermite.State) -> float:
        u, v = (x.ravel() for x in state.wires[:2])
        return float(0.5 * u @ K @ u + 0.5 * v @ M @ v)

    start = with_inertia(model, plucked(model), K)
    there = hermite.run(model, [], nothing(1001), 1e-3, start).end
    # 1000 steps of round-off; an error of a term is seen at its part of the energy at once.
    assert energy(there) == pytest.approx(energy(start), rel=1e-9)
    turned = hermite.State(there.wires * np.array([1.0, -1.0, 1.0])[:, None, None], there.moving_loads)
    back = hermite.run(model, [], nothing(1001), 1e-3, turned).end
    for kind, sign in ((0, 1.0), (1, -1.0)):
        size = np.abs(start.wires[kind]).max()
        np.testing.assert_allclose(sign * back.wires[kind], start.wires[kind], rtol=0, atol=1e-8 * size)


SPRUNG = TravellingLoad(
    "sprung", np.diag([1.0, 5.0]), np.array([[3.0, -3.0], [-3.0, 5.0]]), np.array([[900.0, -900.0], [-900.0, 950.0]]),
    (Contact(0, (1.0, 0.0), stiffness=3e4), Contact(0, (1.0, 0.3), behind=0.8, stiffness=2e4)),
)  # fmt: skip
FORCE = TravellingLoad("force", np.zeros((0, 0)), np.zeros((0, 0)), np.zeros((0, 0)), (Contact(1),))


def test_steps_are_those_of_a_plain_newmark_with_one_matrix() -> None:
    model, dt, steps = hermite.rest_of(tied(4e3, drag=0.4, retardation=2e-3), 0.3), 2e-3, 200
    K, C = all_springs(model)
    for w, wire in enumerate(model.plan.wires):
        own = np.repeat(model.wire == w, 2)
        part = np.outer(own, own)
        C += part * (wire.drag * model.mass.toarray() + wire.retardation * model.stiffness.toarray())
    n = K.shape[0]
    t = np.arange(steps) * dt
    station = np.stack([2.0 + 10.0 * t, 1.2 + 10.0 * t, 3.0 + 15.0 * t], axis=1)
    rough, given = 1e-3 * np.sin(3.0 * station), np.zeros((steps, 3))
    given[:, 2] = 40.0 * t
    push = np.zeros((steps, 2, 2))
    push[:, 0, 1] = -50.0 * np.minimum(1.0, t / 0.05)
    record = hermite.run(model, [SPRUNG, FORCE], hermite.StepInputs(station, rough, given, push), dt)

    M, D, S = (scipy.linalg.block_diag(a, b) for a, b in (
        (model.mass.toarray(), SPRUNG.mass), (C, SPRUNG.damping), (K, SPRUNG.stiffness)))  # fmt: skip
    free = np.concatenate([model.free.ravel(), [True, True]])
    u, v, a = np.zeros((3, n + 2))
    heights, level = np.zeros((steps, 2)), hermite.height(model, 0, [2.0])[0]
    for i in range(1, steps):
        stiff, force = S.copy(), np.concatenate([np.zeros(n), push[i, 0]])
        force[:n] += given[i, 2] * row_of(model, 1, station[i, 2])
        for k, contact in enumerate(SPRUNG.contacts):
            row = np.concatenate([-row_of(model, 0, station[i, k]), contact.row])
            gap = level - rough[i, k] - hermite.height(model, 0, [station[i, k]])[0]
            stiff += contact.stiffness * np.outer(row, row)
            force -= contact.stiffness * gap * row
        ahead, later = u + dt * v + 0.25 * dt**2 * a, v + 0.5 * dt * a
        left = M + 0.5 * dt * D + 0.25 * dt**2 * stiff
        new = np.zeros(n + 2)
        new[free] = np.linalg.solve(left[np.ix_(free, free)], (force - D @ later - stiff @ ahead)[free])
        u, v, a = ahead + 0.25 * dt**2 * new, later + 0.5 * dt * new, new
        heights[i] = u[n:]
    size = np.abs(u[:n:2]).max()
    assert size > 1e-3
    # The forces of ties and contacts are found to 1e-9 of the largest in every step.
    np.testing.assert_allclose(record.end.wires[0].ravel()[::2], u[:n:2], rtol=0, atol=1e-7 * size)
    np.testing.assert_allclose(record.q[:, 0], heights, rtol=0, atol=1e-7 * np.abs(heights).max())


def row_of(model: hermite.HermiteModel, wire: int, station: float) -> Array:
    """Shape functions at a station, from the closed form of the cubic."""
    a, b = model.first[wire : wire + 2]
    i = a + min(int(np.searchsorted(model.station[a:b], station, side="right")) - 1, b - a - 2)
    h = model.station[i + 1] - model.station[i]
    q = (station - model.station[i]) / h
    row = np.zeros(2 * model.station.size)
    row[2 * i : 2 * i + 4] = 1 - 3 * q**2 + 2 * q**3, h * (q - 2 * q**2 + q**3), 3 * q**2 - 2 * q**3, h * (q**3 - q**2)
    return row


def roll(dt: float, lifts_off: bool = False, lift: float = 0.0) -> hermite.Record:
    """A mass that rolls along a string at a fourth of the wave speed, and is lifted later."""
    model = hermite.rest_of(dataclasses.replace(beam(20.0, tension=2e3), gravity=0.0), 0.5)
    t = np.arange(round(1.5 / dt)) * dt
    push = np.zeros((t.size, 1, 1))
    push[:, 0, 0] = np.where(t < 0.9, -30.0 * np.minimum(1.0, t / 0.3), lift or -30.0)
    inputs = hermite.StepInputs((1.0 + 8.0 * t)[:, None], np.zeros((t.size, 1)), np.zeros((t.size, 1)), push)
    mass, none = np.array([[3.0]]), np.zeros((1, 1))
    return hermite.run(
        model, [TravellingLoad("mass", mass, none, none, (Contact(0, (1.0,), lifts_off=lifts_off),))], inputs, dt
    )


def test_what_rolls_rigidly_stays_on_the_wire_but_for_the_square_of_the_step() -> None:
    gaps = []
    for dt in (1e-3, 5e-4):
        record = roll(dt)
        gaps.append(np.abs(record.q[1:, 0, 0] - record.contact_height[1:, 0]).max())
        # Weight, and what the mass and the elements add to it; a contact that swings from step to step has no bound.
        assert np.abs(record.contact_force).max() < 60.0
    assert gaps[0] < 4e-4
    assert np.log2(gaps[0] / gaps[1]) == pytest.approx(2.0, abs=0.4)  # peaks of the force move a little


def test_what_rolls_hops_off_only_if_it_may() -> None:
    restrained, hops = roll(1e-3, lift=300.0), roll(1e-3, lifts_off=True, lift=300.0)
    assert restrained.contact_force.min() < -100.0
    assert hops.contact_force.min() == 0.0
    assert hops.q[-1, 0, 0] > hops.contact_height[-1, 0] + 0.1
    assert abs(restrained.q[-1, 0, 0] - restrained.contact_height[-1, 0]) < 4e-3


def test_slack_droppers_do_not_hold_and_do_not_push() -> None:
    wire = Wire("wire", (0, 0, 0), (10, 0, 0), 1e3, 1.0)
    tie = WireTie("tie", Spot(0, 5.0), (5.0, 0.0, 5.0), 1e5, 6.0)
    slack = hermite.rest_of(WirePlan((wire,), (tie,)), 0.5)
    free = hermite.rest_of(WirePlan((wire,)), 0.5)
    assert hermite.tie_forces(slack)[0] == 0.0
    # w g L^2 / (8 T) at midspan
    assert hermite.height(free, 0, [5.0])[0] == pytest.approx(-9.81 * 100.0 / 8e3, rel=1e-10)
    assert hermite.height(slack, 0, [5.0])[0] == pytest.approx(-9.81 * 100.0 / 8e3, rel=1e-10)
    # A tight one goes slack under 300 N: the wire alone has then to bear what the lift exceeds the pull by.
    tight = hermite.rest_of(WirePlan((wire,), (dataclasses.replace(tie, length=5.0),)), 0.5)
    pull = hermite.tie_forces(tight)[0]
    rise = 300.0 * hermite.elasticity(tight, 0, [5.0], 300.0)[0]
    assert rise == pytest.approx((300.0 - pull) * hermite.elasticity(free, 0, [5.0])[0], rel=1e-9)
    assert 40.0 < pull < 60.0


def test_what_cannot_be_is_said() -> None:
    with pytest.raises(RopewalkError, match="can be attached at 11 m"):
        hermite.rest_of(dataclasses.replace(beam(10.0, tension=1.0), watched={"off": Spot(0, 11.0)}), 1.0)
    with pytest.raises(EquilibriumError, match="a wire is not supported"):
        hermite.rest_of(beam(10.0, ("free", "free"), tension=1e3), 1.0)


# EN 50318:2002

DROPPERS = (5.0, 10.5, 17.0, 23.5, 30.0, 36.5, 43.0, 49.5, 55.0)
AT = [60.0 * span + x for span in range(10) for x in DROPPERS]
MASTS = [60.0 * mast for mast in range(1, 10)]
PANTOGRAPH = TravellingLoad(
    "pantograph", np.diag([7.2, 15.0]), np.array([[10.0, -10.0], [-10.0, 100.0]]),
    np.array([[4200.0, -4200.0], [-4200.0, 4250.0]]),
    (Contact(0, (1.0, 0.0), stiffness=50e3, below=True, lifts_off=True),),
)  # fmt: skip


@cache
def overhead_line(pushes: float = 0.0) -> WirePlan:
    """The reference model: contact wire level at droppers and masts, lengths of the droppers from there."""
    contact = Wire("contact", (0, 0, 0), (600, 0, 0), 20e3, 1.35)
    messenger = Wire("messenger", (0, 0, 1.2), (600, 0, 1.2), 16e3, 1.07)
    arms = tuple(PointMass(Spot(0, x), 1.0 / 3.0) for x in MASTS)
    level = tuple(Hold("", Spot(0, x), FIXED) for x in AT + MASTS)
    first = hermite.rest_of(WirePlan((contact,), holds=level, masses=arms), 1.0)
    shape = np.column_stack([first.rest.height, first.rest.slope]).ravel()
    upright = np.tile([1.0, 0.0], first.station.size)
    reaction = first.stiffness @ shape + 9.81 * (first.mass @ upright)
    up = {x: float(reaction[2 * first.node(Spot(0, x))]) for x in AT + MASTS}
    masts = tuple(Hold("mast", Spot(1, x), FIXED, place=(0, 0, 1.2)) for x in MASTS)
    above = [dataclasses.replace(mast, spot=Spot(0, mast.spot.station)) for mast in masts]
    pulled = [Hold("", Spot(0, x), (0, 0, 0), force=(0, 0, -up[x])) for x in AT]
    second = hermite.rest_of(WirePlan((messenger,), holds=(*above, *pulled)), 1.0)
    ties = tuple(
        WireTie("", Spot(1, x), Spot(0, x), 1e5, z - up[x] / 1e5, pushes)
        for x, z in zip(AT, hermite.height(second, 0, AT), strict=True)
    )
    steady = tuple(Hold("arm", Spot(0, x), (0, 0, 0), force=(0, 0, up[x])) for x in MASTS)
    watched = {f"{x:g}": Spot(0, x) for x in MASTS}
    return WirePlan((contact, messenger), ties, masts + steady, arms, watched=watched)


def passage(pushes: float, element: float) -> tuple[hermite.Record, Array, Array]:
    """A run at 250 km/h: what happened, the filtered contact force in spans 5 and 6, and all of the raw one."""
    dt, speed = 1e-3, 250.0 / 3.6
    t = np.arange(round(580.0 / speed / dt) + 1) * dt
    push = np.zeros((t.size, 1, 2))
    push[:, 0, 1] = 120.0 * np.minimum(1.0, t / 0.3)
    inputs = hermite.StepInputs((10.0 + speed * t)[:, None], np.zeros((t.size, 1)), np.zeros((t.size, 1)), push)
    record = hermite.run(hermite.rest_of(overhead_line(pushes), element), [PANTOGRAPH], inputs, dt)
    smooth = sosfiltfilt(butter(4, 20.0, fs=1.0 / dt, output="sos"), record.contact_force[:, 0])
    inside = (inputs.station[:, 0] >= 240.0) & (inputs.station[:, 0] <= 360.0)
    return record, smooth[inside], record.contact_force[:, 0]


def test_en_50318_droppers_have_the_lengths_and_forces_of_the_table() -> None:
    model = hermite.rest_of(overhead_line(), 1.0)
    forces = hermite.tie_forces(model)[36:45]
    np.testing.assert_allclose(forces, [69, 79, 86, 86, 86, 86, 86, 79, 69], atol=1.0)
    lengths = [tie.length for tie in model.plan.ties[36:45]]
    np.testing.assert_allclose(lengths, [0.999, 0.817, 0.661, 0.567, 0.535, 0.567, 0.661, 0.817, 0.999], atol=2e-3)
    np.testing.assert_allclose(hermite.height(model, 0, AT), 0.0, atol=1e-5)


def test_en_50318_run_at_250_gives_the_converged_answers() -> None:
    record, force, raw = passage(0.0, 0.5)
    # Within what 0.5 m against 0.25 m and 0.5 ms changes: 0.05, 0.2, 0.1 and 1.1 N, and 0.1 mm; and the last digits.
    assert force.mean() == pytest.approx(116.0, abs=0.2)
    assert force.std() == pytest.approx(28.2, abs=0.3)
    assert force.max() == pytest.approx(190.0, abs=2.5)
    assert force.min() == pytest.approx(54.0, abs=1.5)
    assert 1e3 * record.watched[:, 3:6].max() == pytest.approx(52.9, abs=0.2)
    assert (raw[300:] > 0.0).all()
    # Droppers slacken, each at its time, and never push.
    assert record.tie_force.min() == 0.0
    assert (record.tie_force == 0.0).any(axis=0).sum() > 20


def test_en_50318_droppers_that_push_are_found_out() -> None:
    _, force, _ = passage(1e5, 0.5)
    assert 39.0 < force.std() < 55.0
