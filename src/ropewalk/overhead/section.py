"""A section of overhead line as a plan of wires: wire 0 is the contact wire, wire 1 the messenger, then stitch wires.

The plan lies along x at y = 0: effects of the stagger on vertical motion are in its ties, places aside are kept apart.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.model.overhead import OverheadLine, stations_of
from ropewalk.model.overhead_wire import OverheadWire
from ropewalk.overhead.condition import in_condition
from ropewalk.overhead.forming import (
    Dropper,
    Form,
    FormFindingTask,
    Hanger,
    StitchEnd,
    form_by_heights,
    form_by_lengths,
)
from ropewalk.overhead.lateral import radial_forces
from ropewalk.overhead.plan_view import CONTACT, MESSENGER, PlanView, plan_view_of
from ropewalk.wires.mesh import Mesh, clamped_at, mesh_of
from ropewalk.wires.plan import Array, EndKind, Hold, PointMass, Relief, Spot, Wire, WirePlan, WireTie
from ropewalk.wires.rest import WiresAtRest, rest_of, rows

_Pair = tuple[float, float]

_SOFT_LINK = 200e3  # N/m, at most, of the last piece of a stitch wire in small motion: turning hardly changes its pull
_NO_KINK = 1e-9
_STEEPEST = 1.0  # of a steady arm, rise over run: one that is steeper holds the wire up rather than aside


@dataclass(frozen=True)
class Section:
    """A section at rest, and what its parts are called: `section.3.5` is dropper 5 of span 3, counted from 1."""

    name: str
    plan: WirePlan
    element: float  # m
    supports: Array  # (span + 1,) m, stations of all supports with both ends
    analysed: tuple[float, float]  # m, stations between which statistics are made
    view: PlanView
    droppers: dict[str, int] = field(default_factory=dict)  # their ties
    lengths: Array = field(default_factory=lambda: np.zeros(0))  # (dropper,) m, unstrained, in space
    stations: Array = field(default_factory=lambda: np.zeros(0))  # (dropper,) m
    pull: Array = field(default_factory=lambda: np.zeros(0))  # (dropper,) N at rest
    slack: tuple[str, ...] = ()  # droppers that are slack at rest
    arms: dict[str, int] = field(default_factory=dict)  # ties of steady arms with stagger
    holds: dict[str, int] = field(default_factory=dict)  # of the messenger's supports and level steady arms
    registered: Array = field(default_factory=lambda: np.zeros(0))  # (span + 1,) m over the level, at supports

    @property
    def level(self) -> float:
        """Height of the contact wire that counts as level, m: at its first end, less the rise there."""
        return self.plan.wires[CONTACT].start[2] - (float(self.registered[0]) if self.registered.size else 0.0)

    @property
    def length(self) -> float:
        """Length of the contact wire between its ends, m."""
        return self.plan.wires[CONTACT].length

    @property
    def is_level(self) -> NDArray[np.bool_]:
        """Which spans have both supports at that height, (span,)."""
        rise = self.registered if self.registered.size else np.zeros(self.supports.size)
        return np.asarray((rise[:-1] == 0.0) & (rise[1:] == 0.0))

    def mesh(self, element: float | None = None) -> Mesh:
        """Divide it, at the length of links that it was formed with."""
        return mesh_of(self.plan, self.element if element is None else element)

    @cached_property
    def rest(self) -> WiresAtRest:
        """Its rest on that mesh."""
        return rest_of(self.mesh())

    def aside(self, station: Array, wire: int = CONTACT) -> Array:
        """Where a wire runs in plan view, y in m at stations of it in m."""
        return self.view.aside(wire, self.view.station(wire, station))


def section_of(name: str, line: OverheadLine, gravity: float = 9.81) -> Section:
    """Find the rest of an overhead line as declared, its droppers' lengths or, where these are given, its heights.

    Raises:
        EquilibriumError: it cannot rest as wanted, or not with the given lengths.
    """
    supports, view = np.array(stations_of(line)), plan_view_of(line)
    task = _task(name, line, gravity, supports, view)
    given = line.dropper_lengths
    try:
        if given is None:
            form = form_by_heights(task)
        else:
            form = form_by_lengths(task, np.array([length for row in given for length in row]))
    except EquilibriumError as error:
        raise EquilibriumError(f"overhead line {name}: {error}") from None
    fitted = _finished(name, line, task, form, supports, view)
    return fitted if line.condition is None else _changed(name, line, fitted)


def joined(sections: Sequence[Section]) -> tuple[WirePlan, list[int]]:
    """Put sections into one plan; list the number of the first wire of each, which its own wires are counted from."""
    wires: tuple[Wire, ...] = ()
    plan, offsets = replace(sections[0].plan, wires=(), ties=(), holds=(), masses=(), reliefs=(), watched={}), []
    for section in sections:
        n, part = len(wires), section.plan

        def moved(spot: Spot, n: int = n) -> Spot:
            return Spot(spot.wire + n, spot.station)

        ties = (
            replace(t, spot=moved(t.spot), other=moved(t.other) if isinstance(t.other, Spot) else t.other)
            for t in part.ties
        )
        plan = replace(
            plan,
            ties=(*plan.ties, *ties),
            holds=(*plan.holds, *(replace(hold, spot=moved(hold.spot)) for hold in part.holds)),
            masses=(*plan.masses, *(replace(lump, spot=moved(lump.spot)) for lump in part.masses)),
            reliefs=(*plan.reliefs, *(replace(r, start=moved(r.start), end=moved(r.end)) for r in part.reliefs)),
            watched=plan.watched | {key: moved(spot) for key, spot in part.watched.items()},
        )
        offsets.append(n)
        wires = (*wires, *part.wires)
    return replace(plan, wires=wires), offsets


def elasticity(
    section: Section, force: float = 100.0, span: int | None = None, stations: Array | None = None
) -> tuple[Array, Array]:
    """Static rise of the contact wire per force, droppers slackening as they are relieved.

    Args:
        section: the line at rest.
        force: upwards on the contact wire, N.
        span: counted from 1 (default: the middle one), of which 25 stations are taken.
        stations: where instead, m.

    Returns:
        Stations in m and elasticities in m/N.

    Raises:
        EquilibriumError: there is no rest.
    """
    if stations is None:
        number = (section.supports.size - 1) // 2 if span is None else span - 1
        stations = np.linspace(section.supports[number], section.supports[number + 1], 25)
        if number == 0 or number == section.supports.size - 2:  # ends do not move
            stations = stations[int(number == 0) : 25 - int(number == section.supports.size - 2)]
    pushes = tuple(Hold(f"push {x:g}", Spot(CONTACT, float(x)), (0.0, 0.0, 0.0)) for x in stations)
    mesh = mesh_of(replace(section.plan, holds=section.plan.holds + pushes), section.element)
    at, own = clamped_at(mesh.strands, [push.spot for push in pushes]), len(section.plan.holds)
    before = rest_of(mesh).position[2]
    found = np.empty(stations.size)
    for i in range(stations.size):
        given = mesh.holds.force.copy()
        given[own + i, 2] = force
        z = rest_of(mesh._replace(holds=mesh.holds._replace(force=given))).position[2]
        found[i] = ((rows(at, mesh.nodes) @ (z - before))[i] + at.local[i] * force) / force
    return stations, found


def _task(name: str, line: OverheadLine, gravity: float, supports: Array, view: PlanView) -> FormFindingTask:
    """What is wanted, in terms of wires."""
    z0, end = line.start[-1], float(supports[-1])
    kind: EndKind = "free" if line.ends == "weights" else "pinned"
    top = z0 + line.system_height
    rise = np.array(line.registered)

    def risen(station: float) -> float:
        return float(np.interp(station, supports, rise))

    wires = [
        _wire(f"{name}.contact", line.contact_wire, line, (0.0, end), (z0 + rise[0], z0 + rise[-1]), kind),
        _wire(f"{name}.messenger", line.messenger_wire, line, (0.0, end), (top + rise[0], top + rise[-1]), kind),
    ]
    weighted = [hold for i, wire in enumerate(wires) if kind == "free" for hold in _tensioned(i, wire)]
    inner, links, masses = [float(s) for s in supports[1:-1]], [], []
    reliefs: list[Relief] = []
    stitch, reach = line.stitch_wire, 0.0
    if stitch is not None:
        reach = 0.5 * stitch.length - line.element
        for i, s in enumerate(inner, start=1):
            own, ends = f"{name}.stitch.{i}", (s - reach, s + reach)
            wires.append(_wire(own, stitch, line, ends, (top - 0.5 + risen(s),) * 2, "free"))
            stiffness = min(stitch.axial_stiffness / line.element, _SOFT_LINK)
            for side, station, along in (("a", 0.0, -line.element), ("b", 2.0 * reach, line.element)):
                clamp = Spot(MESSENGER, s - reach + station + along)
                low = Spot(len(wires) - 1, station)
                links.append(StitchEnd(f"{own}.{side}", low, clamp, stitch.tension, along, stiffness))
                masses.append(PointMass(clamp, stitch.clamp + stitch.mass * line.element))  # the last piece's, too
            reliefs.append(Relief(links[-2].high, links[-1].high, stitch.tension))
    hangers, cut = [], line.droppers.cut
    for span, (places, sags) in enumerate(zip(line.dropper_places, line.sags, strict=True)):
        for i, (place, sag) in enumerate(zip(places, sags, strict=True), start=1):
            x = float(supports[span]) + place
            height = z0 + risen(x) - sag
            high = Spot(MESSENGER, x)
            for number in (span - 1, span) if stitch is not None else ():
                if 0 <= number < len(inner) and abs(x - inner[number]) < reach:
                    high = Spot(2 + number, x - inner[number] + reach)
            at = np.array([x])
            aside = float((view.aside(high.wire, at) + view.inside(high.wire, at) - view.aside(CONTACT, at))[0])
            fails = cut.time if cut is not None and (span + 1, i) in cut.droppers else math.inf
            hangers.append(Hanger(f"{name}.{span + 1}.{i}", Spot(CONTACT, x), high, height, aside, fails))
    arms = line.steady_arms
    masses += [PointMass(Spot(CONTACT, s), arms.moving_mass) for s in inner]
    levels = [] if arms.free else [(Spot(CONTACT, s), z0 + risen(s)) for s in inner]
    levels += [(Spot(MESSENGER, s), top + risen(s)) for s in inner]
    d = line.droppers
    dropper = Dropper(
        d.stiffness, d.pushes, d.damping, d.mass or 0.0, d.mass_per_length or 0.0, (d.contact_clamp, d.messenger_clamp),
        d.strength or math.inf,
    )  # fmt: skip
    hints = (
        f"give more system_height (it is {line.system_height:g} m), more tension to messenger_wire "
        f"(it is {line.messenger_wire.tension:g} N), or shorter spans"
    )
    # What an arm weighs at the wire beyond what moves with it.
    more = gravity * (arms.hanging_mass - arms.moving_mass)
    weights = [Hold(f"{name}.arm.{i}.weight", Spot(CONTACT, s), (0.0, 0.0, 0.0), force=(0.0, 0.0, -more))
               for i, s in enumerate(inner, start=1) if more]  # fmt: skip
    plan = WirePlan(
        tuple(wires), holds=(*weighted, *weights), masses=tuple(masses), reliefs=tuple(reliefs), gravity=gravity
    )
    return FormFindingTask(plan, line.element, tuple(hangers), dropper, tuple(links), tuple(levels), hints)


def _tensioned(number: int, wire: Wire) -> Iterator[Hold]:
    """What holds the ends of a wire that weights pull: they slide along x."""
    for side, station, place, pull in (("start", 0.0, wire.start, -1.0), ("end", wire.length, wire.end, 1.0)):
        slides, force = (0.0, np.inf, np.inf), (pull * wire.tension, 0.0, 0.0)
        yield Hold(f"{wire.name}.{side}", Spot(number, station), slides, place=place, force=force)


def _wire(name: str, wire: OverheadWire, line: OverheadLine, along: _Pair, height: _Pair, end: EndKind) -> Wire:
    """A wire between two stations; where these are unequally high, it is as long as they are apart, and inclined."""
    x = (x_of(line, along[0]), x_of(line, along[0]) + _level_length(along[1] - along[0], height[1] - height[0]))
    return Wire(
        name, (x[0], 0.0, height[0]), (x[1], 0.0, height[1]), wire.tension, wire.mass, wire.bending_stiffness,
        wire.axial_stiffness, wire.drag, wire.retardation, ends=(end, end),
    )  # fmt: skip


def x_of(line: OverheadLine, station: float) -> float:
    """Where a station of a line is along x, m: stations count along the wires, which may be inclined as a whole."""
    rise = line.registered[-1] - line.registered[0]
    return line.start[0] + station * (_level_length(line.length, rise) / line.length)


def _level_length(length: float, rise: float) -> float:
    """Level part of a length, m; exactly that length, where nothing rises."""
    return math.sqrt(length**2 - rise**2) if rise else length


def _finished(
    name: str, line: OverheadLine, task: FormFindingTask, form: Form, supports: Array, view: PlanView
) -> Section:
    """Hold the line by what holds it in fact, with the forces that it takes."""
    inner = supports[1:-1]
    stiffness, damping = _three(line.messenger_supports.stiffness, np.inf), _three(line.messenger_supports.damping, 0.0)
    if line.messenger_supports.swings:
        stiffness, damping = (0.0, *stiffness[1:]), (0.0, *damping[1:])
    spots, lift = [Spot(CONTACT, float(s)) for s in inner], np.zeros(inner.size)  # N, of the arms
    own: list[Hold] = []
    for i, ((spot, height), force) in enumerate(zip(task.levels, form.restraint, strict=True)):
        number = i % inner.size
        if spot.wire == CONTACT:
            lift[number] = force
        else:
            z = height if np.isinf(stiffness[2]) else height + float(force) / stiffness[2]
            place = x_of(line, spot.station), 0.0, z
            own.append(Hold(f"{name}.support.{number + 1}", spot, stiffness, damping, place))
    arms = _arms(name, line, form, spots, lift) if line.staggers is not None else ()
    if not arms and not line.steady_arms.free:
        for i, spot in enumerate(spots):
            own.append(Hold(f"{name}.arm.{i + 1}", spot, (0.0, 0.0, 0.0), force=(0.0, 0.0, float(lift[i]))))
    plan = replace(
        task.plan, ties=(*form.ties, *arms), holds=(*task.plan.holds, *own), masses=form.masses,
        watched={f"{name}.support.{i}": spot for i, spot in enumerate(spots, start=1)},
    )  # fmt: skip
    first, last = line.analysed
    hangers = task.hangers
    return Section(
        name, plan, line.element, supports, (float(supports[first - 1]), float(supports[last])), view,
        droppers={hanger.name: i for i, hanger in enumerate(hangers)},
        lengths=form.lengths,
        stations=np.array([hanger.low.station for hanger in hangers]),
        pull=form.pull,
        slack=tuple(hanger.name for hanger, pull in zip(hangers, form.pull, strict=True) if pull <= 0.0),
        arms={arm.name: len(form.ties) + i for i, arm in enumerate(arms)},
        holds={hold.name: len(task.plan.holds) + i for i, hold in enumerate(own)},
        registered=np.array(line.registered),
    )  # fmt: skip


def _changed(name: str, line: OverheadLine, fitted: Section) -> Section:
    """A fitted line in the condition that is declared."""
    condition, names, count = line.condition, list(fitted.droppers), len(fitted.droppers)
    assert condition is not None
    try:
        plan, kept = in_condition(fitted.plan, line.element, names, condition, anchored=line.ends == "anchored")
        lengths = (1.0 + condition.expansion * condition.temperature_rise) * fitted.lengths[kept]
        changed = replace(
            fitted, plan=plan, droppers={names[i]: k for k, i in enumerate(kept)}, lengths=lengths,
            stations=fitted.stations[kept], arms={arm: i - count + len(kept) for arm, i in fitted.arms.items()},
        )  # fmt: skip
        pull = changed.rest.tie_force[: len(kept)]
    except EquilibriumError as error:
        raise EquilibriumError(f"overhead line {name}: {error}") from None
    return replace(changed, pull=pull, slack=tuple(n for n, F in zip(changed.droppers, pull, strict=True) if F <= 0.0))


def _arms(name: str, line: OverheadLine, form: Form, spots: list[Spot], lift: Array) -> tuple[WireTie, ...]:
    """Steady arms that pull the contact wire aside as its kinks in plan view demand, and up by `lift` in N."""
    tension, spans = line.contact_wire.tension, np.array(line.span_lengths)
    aside, yields = radial_forces(line), tension * (1.0 / spans[:-1] + 1.0 / spans[1:])
    local, low = clamped_at(form.mesh.strands, spots).local, form.heights(spots)
    found = []
    for i, spot in enumerate(spots):
        at, force = (x_of(line, spot.station), float(low[i])), (float(aside[i]), float(lift[i]))
        found.append(_arm(f"{name}.arm.{i + 1}", line, spot, at, force, (1.0 / float(yields[i]), float(local[i]))))
    return tuple(found)


def _arm(label: str, line: OverheadLine, spot: Spot, at: _Pair, force: _Pair, yields: _Pair) -> WireTie:
    """A steady arm, hinged at both ends, that pulls the wire aside and up by given forces in N.

    So it points along that force: it stands on the side to which it pulls, and rises by the ratio of the two. Its
    length there is that of the arm and its strain, so that only the place of its hinge on the mast is sought. The wire
    yields sideways like a string, T / left span + T / right span. In a plan without sideways motion that is in series
    with the arm, or else an inclined arm would prop the wire: the tie is that soft spring, under the same tension.

    Args:
        at: x and height of the wire there, m.
        yields: m/N, of the wire sideways, and beside its spline.
    """
    (aside, up), arms, (x, z) = force, line.steady_arms, at
    pull, owner = float(np.hypot(aside, up)), label.split(".")[0]
    if abs(aside) <= _NO_KINK * line.contact_wire.tension:
        raise EquilibriumError(
            f"overhead line {owner}: the wire has no kink at {label}, nothing gives the arm a direction; let stagger "
            "change there, or leave it out (arms then hold the wire level)"
        )
    if abs(up) > _STEEPEST * abs(aside):
        raise EquilibriumError(
            f"overhead line {owner}: the wire's kink pulls {label} with {abs(aside):.4g} N only, and the arm would "
            f"have to stand steeply to hold the wire up with {up:.4g} N; give more stagger there, write free: "
            "true, or leave stagger out (arms then hold the wire level)"
        )
    give = arms.length / arms.axial_stiffness
    reach, stiffness = arms.length + pull * give, 1.0 / (give + yields[0])
    ground = x, reach * aside / pull, z + reach * up / pull
    return WireTie(label, spot, ground, stiffness, reach - pull * (1.0 / stiffness + yields[1]), stiffness)


def _three(value: float | tuple[float, ...] | None, otherwise: float) -> tuple[float, float, float]:
    if value is None:
        return (otherwise,) * 3
    if isinstance(value, tuple):
        x, y, z = value if len(value) == 3 else (value[0], value[0], value[1])
        return x, y, z
    return (value,) * 3
