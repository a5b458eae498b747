"""From a scenario with stiff lines or overhead lines to a task on wires."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.external.models import cosimulation_of
from ropewalk.mechanics.assembly import speed_table
from ropewalk.mechanics.loading import loading_of
from ropewalk.mechanics.pantograph_matrices import MASSES, rotations_of, row_of
from ropewalk.mechanics.travelled import Travelled
from ropewalk.model.beginning import UP
from ropewalk.model.division import links_of_line
from ropewalk.model.line import spatial
from ropewalk.model.load import AnyLoad, ExternalModel
from ropewalk.model.overhead import OverheadLine
from ropewalk.model.overlap import course_of
from ropewalk.model.pantograph import LEADING, Pantograph
from ropewalk.model.run import Dynamic, Quasistatic
from ropewalk.model.run import Start as Beginning
from ropewalk.model.scenario import Scenario
from ropewalk.overhead.in_space import at_full_stiffness, bow_of, in_space, near_rest
from ropewalk.overhead.irregularity import read_irregularity
from ropewalk.overhead.lateral import across, widest
from ropewalk.overhead.pantograph_loads import Above, expected_lift, moving_load_of, push_of, start_of
from ropewalk.overhead.plan_view import CONTACT
from ropewalk.overhead.section import Section, joined, section_of
from ropewalk.results.stored import stored_instant
from ropewalk.solve.load_schedule import horizon
from ropewalk.wires.beginning import in_mode
from ropewalk.wires.ends import holds_of, masses_of
from ropewalk.wires.equilibrium import movable
from ropewalk.wires.lines import displayed_of, prescribed_motion_of, wire_of
from ropewalk.wires.mesh import links_of
from ropewalk.wires.partners import WireExternalModel
from ropewalk.wires.partners import moving_load_of as external_moving_load
from ropewalk.wires.plan import Array, WirePlan, nothing
from ropewalk.wires.prescribed_motion import PrescribedMotion
from ropewalk.wires.task import Displayed, WireStart, WireTask, unstretched

_HEAVY = 500.0  # N: droppers bear about 100 N


def task_of(scenario: Scenario) -> WireTask:
    """What is to be computed.

    Raises:
        RopewalkError: an overhead line cannot rest as wanted, or a load cannot be used.
    """
    run = scenario.run
    until = run.until if isinstance(run, Dynamic) else horizon(scenario) if isinstance(run, Quasistatic) else 0.0
    sections = {name: section_of(name, line, scenario.gravity) for name, line in scenario.overhead_lines.items()}
    slow = not isinstance(run, Dynamic)
    nonlinear = isinstance(run, Dynamic) and run.geometry == "nonlinear"
    space = nonlinear and not scenario.lines and not all(section.view.is_straight for section in sections.values())
    near = tuple(near_rest(section) for section in sections.values()) if space else ()
    bow = None
    if space and any(section.view.turns.any() for section in sections.values()):
        bow = np.concatenate([bow_of(s, scenario.overhead_lines[s.name]) for s in sections.values()])
    laid = list(sections.values())
    if nonlinear or slow:
        laid = [at_full_stiffness(s, scenario.overhead_lines[s.name]) for s in laid]
    if space:
        laid = [in_space(s, scenario.overhead_lines[s.name]) for s in laid]
    plan, offsets = joined(laid) if sections else (WirePlan((), gravity=scenario.gravity), [])
    elements = [links_of(wire, section.element) for section in sections.values() for wire in section.plan.wires]
    first = len(plan.wires)
    for number, (name, line) in enumerate(scenario.lines.items(), start=first):
        wire = wire_of(name, line)
        restrained, mass = holds_of(line, wire, number, until), masses_of(line, wire, number)
        plan = replace(
            plan, wires=(*plan.wires, wire), holds=(*plan.holds, *restrained), masses=(*plan.masses, *mass)
        )  # fmt: skip
    elements += [links_of_line(line) for line in scenario.lines.values()]
    if nonlinear or slow:
        plan = unstretched(plan, elements)
    others = {name: load for name, load in scenario.loads.items() if not isinstance(load, Pantograph)}
    bearing = scenario.model_copy(update={"loads": others})
    loading = loading_of(bearing, until)
    numbers = dict(zip(sections, (offset + CONTACT for offset in offsets), strict=True))
    numbers |= {name: first + i for i, name in enumerate(scenario.lines)}
    prescribed_motions: list[PrescribedMotion] = []
    contacts: list[str] = []
    displayed: list[Displayed] = []
    external_models: list[WireExternalModel] = []
    for name, load in scenario.loads.items():
        number, on = len(prescribed_motions), numbers[load.on]
        if isinstance(load, Pantograph):
            course = course_of(scenario.overhead_lines, load.on)
            under = {
                key: _Under(sections[key], numbers[key], _above(name, load, key, scenario.overhead_lines, course[key]))
                for key in (load.on, *course)
            }
            prescribed_motions.append(_pantograph(name, load, list(under.values()), until, slow=slow))
            wires = [name if key == load.on else f"{name}.{key}" for key in under]
            contacts += [f"{wire}.{strip}" if strip else wire for wire in wires for strip in load.strips]
            displayed += _masses(name, load, number)
            continue
        if isinstance(load, ExternalModel):
            own = [wheel.name for wheel in loading.wheels if wheel.load == name]
            moving_load = external_moving_load(name, on, len(own), load.exchange.stiffness, load.exchange.damping)
            prescribed_motions.append(PrescribedMotion(moving_load, np.zeros_like))
            external_models.append(WireExternalModel(number, partial(cosimulation_of, name, load, until)))
            contacts += own
            continue
        prescribed_motion, system = prescribed_motion_of(loading, name, load, on, plan.wires[on])
        prescribed_motions.append(prescribed_motion)
        contacts += [wheel.name for wheel in loading.wheels if wheel.load == name]
        displayed += displayed_of(loading, system, number, plan.wires[on]) if system is not None else []
    more: dict[str, Any] = {}
    if isinstance(run, Dynamic):
        more = {
            "geometry": run.geometry, "inertia": run.axial_inertia,
            "window": run.window if run.window is not None else np.inf, "with_loads": run.start.with_loads,
        }  # fmt: skip
        if run.finds_window:
            longest = max(max(line.span_lengths) for line in scenario.overhead_lines.values())
            more |= {"window": longest, "accuracy": run.precision}
        groups = {
            name: range(offsets[i], offsets[i] + len(s.plan.wires)) for i, (name, s) in enumerate(sections.items())
        }
        groups |= {name: range(first + i, first + i + 1) for i, name in enumerate(scenario.lines)}
        if run.start.kind == "mode":
            more["beginning"] = partial(_in_mode, run.start, groups)
        elif run.start.kind == "result":
            more["beginning"] = partial(_as_stored, run.start, space, bow)
    if space:
        more |= {"space": True, "near": near, "bow": bow}
    diagnostics = tuple(remark for section in sections.values() for remark in _diagnostics(section))
    if isinstance(run, Dynamic) and not nonlinear:
        diagnostics += tuple(remark for name, line in scenario.overhead_lines.items() for remark in _unseen(name, line))
    return WireTask(
        plan, tuple(prescribed_motions), tuple(contacts), tuple(displayed), elements,
        external_models=tuple(external_models),
        diagnostics=diagnostics,
        **more,
    )  # fmt: skip


def _in_mode(start: Beginning, groups: Mapping[str, range], rest: WireStart) -> tuple[Array, Array]:
    """Positions and velocities of wires that are released in a mode, of each line or overhead line its own."""
    assert start.amplitude is not None
    position, way = rest.position.copy(), np.array(spatial(start.direction or UP))
    for name, wires in groups.items():
        if start.line in (None, name):
            moved = in_mode(rest, wires, start.number or 1, start.amplitude, way)
            for i in wires:
                position[:, rest.mesh.of(i)] = moved[:, rest.mesh.of(i)]
    return position, np.zeros_like(position)


def _as_stored(start: Beginning, space: bool, bow: Array | None, rest: WireStart) -> tuple[Array, Array]:
    """Positions and velocities of wires at a stored instant.

    Raises:
        RopewalkError: the file does not fit, or an end is held elsewhere.
    """
    axes = [0, 1, 2] if space else [0, 2]
    found = stored_instant(start, rest.mesh.nodes, len(axes))
    position, velocity = rest.position.copy(), np.zeros_like(rest.position)
    position[axes], velocity[axes] = found
    if bow is not None:
        position[1] -= bow
    restrained = ~movable(rest.mesh, space=True)
    away = float(np.abs(position - rest.position)[restrained].max(initial=0.0))
    if away > 1e-9 * max(wire.length for wire in rest.mesh.plan.wires):
        raise RopewalkError(
            f"{start.file}: an end stands {away:.3g} m elsewhere in the stored result; use the same lines"
        )
    return position, velocity


def _diagnostics(section: Section) -> Iterator[str]:
    """What is odd about an overhead line at rest."""
    if section.slack:
        count = len(section.slack)
        names = ", ".join(section.slack[:5]) + (", ..." if count > 5 else "")
        yield f"static slack of {count} of {section.lengths.size} droppers of {section.name} ({names}): check lengths"
    heaviest = float(section.pull.max(initial=0.0))
    if heaviest > _HEAVY:
        name = list(section.droppers)[int(section.pull.argmax())]
        yield f"static force of dropper {name} is {heaviest:.0f} N, unusually large: check lengths and pre_sag"


def _unseen(name: str, line: OverheadLine) -> Iterator[str]:
    """Keys of an overhead line without effect on its linearised motion."""
    if line.ends == "anchored" and line.condition is None:
        yield f"overhead_lines.{name}.ends: in linearised motion tensions are constant, whatever holds the ends"
    if line.messenger_supports.along == "held":
        yield f"overhead_lines.{name}.messenger_supports.along: in linearised motion nothing moves along the line"


@dataclass(frozen=True)
class _Under:
    """An overhead line that a pantograph is under."""

    section: Section
    wire: int  # number of its contact wire
    above: Above


def _above(name: str, load: Pantograph, key: str, lines: Mapping[str, OverheadLine], ahead: float) -> Above:
    """The contact wire of a line above a pantograph, which begins so many metres ahead of its own one."""
    rough = _rough(name, load, key)
    if "roll" not in rotations_of(load):
        return Above(ahead, rough)
    line, side = lines[key], _side(lines[key]) - _side(lines[load.on])

    def aside(stations: Array) -> Array:
        return across(line, stations) + side

    return Above(ahead, rough, aside, widest(line) + abs(side))


def _side(line: OverheadLine) -> float:
    return line.start[1] if len(line.start) == 3 else 0.0


def _pantograph(name: str, load: Pantograph, under: Sequence[_Under], until: float, *, slow: bool) -> PrescribedMotion:
    """The prescribed motion of a pantograph.

    Args:
        name: of the load.
        load: as declared.
        under: the lines that it is under, its own first.
        until: s, end of the run.
        slow: whether it presses with all of its force from the beginning.
    """
    section = under[0].section
    course, start = Travelled(*speed_table(load.travel.speed, until)), load.travel.start
    lift = 0.0
    if load.wanted_mean is not None:
        mean = push_of(load, section.level).wanted(course.speed(np.array([0.5 * until])))
        lift = expected_lift(section, float(mean[0]))
    push = push_of(load, section.level, lift)
    push = replace(push, ramp=0.0) if slow else push
    here = [each for each in under if 0.0 <= start - each.above.ahead <= each.section.length] or under[:1]
    firsts = [start_of(load, each.section.mesh(), each.section.rest, CONTACT, each.above) for each in here]
    first = min(firsts, key=lambda heights: float(heights[0]))  # of several wires it touches the lowest
    moving_load = moving_load_of(name, load, {each.wire: each.above for each in under})

    def pushed(times: Array) -> Array:
        return push(times, course.speed(times))

    return PrescribedMotion(moving_load, partial(course.at, start=start), pushed, first=first, settled=course.settled)


def _rough(name: str, load: Pantograph, line: str) -> Callable[[Array], Array]:
    """The irregularity that a pantograph feels on a line."""
    file = load.irregularities.get(line)
    if file is None:
        return nothing
    key = "irregularity" if isinstance(load.irregularity, str) else f"irregularity.{line}"
    return read_irregularity(Path(file), f"loads.{name}.{key}").at


def _masses(name: str, load: AnyLoad, prescribed_motion: int) -> list[Displayed]:
    """Its masses as bodies, above each other, and the ends of a head that pitches or rolls: at strips, over springs."""
    assert isinstance(load, Pantograph)
    count, rotations = len(load.parts.masses), rotations_of(load)
    size, back = count + len(rotations), -next(iter(load.strips.values()))
    found = [
        Displayed(f"{name}.{part}", prescribed_motion, np.eye(size)[i], 0.0, ahead=back)
        for i, part in enumerate(MASSES[count])
    ]
    if "pitch" in rotations:
        for wheel, (strip, place) in enumerate(load.strips.items()):
            row = row_of(load, ahead=place)
            found.append(Displayed(f"{name}.head.{strip or LEADING}", prescribed_motion, row, 0.0, wheel=wheel))
    if "roll" in rotations:
        half = 0.5 * rotations["roll"].spring_spacing
        for side, aside in (("left", half), ("right", -half)):
            row = row_of(load, aside=aside)
            found.append(Displayed(f"{name}.head.{side}", prescribed_motion, row, 0.0, ahead=back))
    return found
