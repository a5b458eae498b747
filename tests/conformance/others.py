"""Another sensible value for every optional key that has none by rule.

By rule a number that is given becomes larger, a choice each of the other choices, and a truth value the other. What
stands here goes before that: a value, `Each` of several values, a `Patch` of keys that go together, or a function of
the value as understood and the block as written that gives one of these.
"""

from __future__ import annotations

from typing import Any

from .bases import EARLIER, HILLS, NET, OUTLINE, PATH, TAUT, UNTIL, shaken
from .structures import Tree


class Each(tuple[Any, ...]):
    """Several other values, every one to be felt."""


class Patch(dict[str, Any]):
    """Keys that go together; None takes a key out."""


def _grown(key: str, block: Tree, **more: Any) -> Tree:
    """A block of named blocks with one more key in each of them."""
    return {name: {**inner, **more} for name, inner in block.get(key, {}).items()}


def _lines(_: Any, block: Tree) -> Tree:
    return {**block.get("lines", {}), "beside": {**TAUT, "start": [0.0, 9.0], "end": [20.0, 9.0]}}


def _nets(_: Any, block: Tree) -> Tree:
    return _grown("nets", block, mass=0.4) or {"beside": {**NET, "corner": [0.0, 9.0, 0.0]}}


def _loads(_: Any, block: Tree) -> Any:
    return {} if block.get("loads") else {"load": {"kind": "force", "on": "rope", "force": [0.0, -100.0],
                                                   "travel": {"speed": 10.0, "from": 5.0}}}  # fmt: skip


def _length(value: float | None, _: Tree) -> Patch:
    return Patch(length=1.002 * value if value else 20.05, tension=None)


def _law(value: Any, block: Tree) -> Any:
    law = {"kind": "tension_only" if value.kind in ("inextensible", "second_piola_kirchhoff", "polynomial", "table",
                                                   "webbing")
           else "second_piola_kirchhoff"}  # fmt: skip
    return Patch(law=law, axial_stiffness=block.get("axial_stiffness", 2e6))


def _place(value: Any, _: Tree) -> list[float]:
    """A point or vector a little elsewhere."""
    return [*value[:-1], value[-1] + 0.1]


def _outline(value: Any, block: Tree) -> Patch:
    if value is not None:
        return Patch(boundary=[*value[:2], [3.5, 3.0, 0.0], value[3]])
    return Patch(corner=None, sides=None, cells=None, **OUTLINE, **({"mesh": 0.5} if block["kind"] == "net" else {}))


def _bodies(_: Any, block: Tree) -> Tree:
    return {name: {**body, "mass": 1.1 * body["mass"]} for name, body in block["bodies"].items()}


def _springs(_: Any, block: Tree) -> Tree:
    return {name: {**spring, "stiffness": 1.1 * spring["stiffness"]} for name, spring in block["springs"].items()}


def _support(value: Any, _: Tree) -> Tree:
    fixed = {"kind": "fixed"}
    return fixed if value.kind != "fixed" else {"kind": "elastic", "stiffness": "200 kN/m"}


def _tension(value: Any, _: Tree) -> Any:
    return Patch(tension=1.1 * value if value else "9 kN", length=None)


def _sheet_tension(value: Any, _: Tree) -> Any:
    return Patch(tension=1.1 * value if value else 150.0, slack=None)


def _scheme(value: str, _: Tree) -> Each:
    schemes = ("sequential", "parallel", "iterated")
    plain = Patch(tolerance=None, iterations=None)
    return Each(Patch(plain, scheme=scheme) for scheme in schemes if scheme != value)


OTHER: dict[str, Any] = {
    "Scenario.title": "another",
    "Scenario.gravity": Each((5.0, 0.0)),
    "Scenario.lines": _lines,
    "Scenario.overhead_lines": lambda _, block: {
        **block.get("overhead_lines", {}), "other": {"spans": {"count": 3, "length": 20.0}, "start": [0.0, 50.0]}},
    "Scenario.joints": lambda _, block: _grown("joints", block, mass=4.0) or {"ring": {"mass": 3.0}},
    "Scenario.nets": _nets,
    "Scenario.wind": lambda value, _: {"direction": [1.0, 0.0], "speed": 10.0 if value is None else 5.0},
    "Scenario.loads": _loads,
    "Scenario.run": lambda value, _: {"kind": "dynamic", "until": 0.05} if value.kind != "dynamic" else {
        "kind": "equilibrium"},
    # Lines and their supports.
    "Line.length": _length,
    "Line.tension": _tension,
    "Line.axial_stiffness": lambda value, _: Patch(axial_stiffness=1.25 * value if value else 2e6),
    "Line.law": _law,
    "Line.axial_damping": lambda value, _: 2.0 * value or 100.0,
    "Line.bending_stiffness": lambda value, _: Patch(bending_stiffness=2.0 * value or 2e4, axial_damping=None),
    "Line.foundation": lambda value, _: Patch(foundation=2.0 * value or 1e4, axial_damping=None),
    "Line.retardation": lambda value, _: 2.0 * value or 1e-3,
    "Line.damping": lambda value, _: Patch(damping={"ratio": 0.05, "at": [3.0, 20.0] if value else [3.0]}, drag=None),
    "Damping.at": [3.0],
    "Train.train": lambda value, _: (
        "Shinkansen S300" if value else Patch(train="ICE 3", vehicles=None, order=None)
    ),
    "Train.vehicles": lambda _, block: _grown("vehicles", block, length=1.4) or None,
    "Train.order": lambda value, _: [*value, value[0]] if value else None,
    "TrainVehicle.bodies": _bodies,
    "TrainVehicle.springs": _springs,
    "Axles.train": lambda value, _: (
        "HSLM-A5" if value else Patch(train="HSLM-A5", forces=None, at=None, coaches=None)
    ),
    "Axles.forces": lambda value, block: [3e3] * len(block["at"]) if "at" in block else None,
    "Axles.at": lambda value, block: [0.0, *(1.5 + i for i in range(len(value) - 1))] if value else None,
    "Axles.coaches": lambda value, block: {"count": 3, "length": 3.0} if block.get("at") else None,
    "*.drag": lambda value, _: 2.0 * value or 5.0,
    "Line.start_support": _support,
    "Line.end_support": _support,
    "Line.supports": lambda _, block: _grown("supports", block, at=7.0) or {"pier": {"at": 9.0, "kind": "fixed"}},
    "InnerElastic.damping": lambda value, _: 2.0 * value or 1e3,
    "*.position": lambda value, block: _place(value, block) if value else [block["at"], 0.05],
    "Line.sheaves": lambda _, block: _grown("sheaves", block, friction=0.3) or {"wheel": {"at": [12.0, 0.5]}},
    "Line.saddles": lambda _, block: _grown("saddles", block, radius=2.0) or None,
    "Saddle.radius": lambda value, _: 0.7 * value,
    "Saddle.friction": lambda value, _: 2.0 * value or 0.2,
    "Saddle.support": {"kind": "elastic", "stiffness": "200 kN/m"},
    "Line.segments": lambda _, block: _grown("segments", block, mass=3e3) or (
        {"part": {"from": 5.0, "to": 9.0, "mass": 2.0 * float(block["mass"])}}),
    "Line.cut": lambda value, _: {"at": 0.5 * value.at, "time": value.time} if value else None,
    "Cut.at": lambda value, _: 0.8 * value,
    "Line.hysteresis": lambda value, _: Patch(hysteresis=None) if value else None,
    "Hysteresis.ratio": lambda value, _: 0.9 if value else None,
    "Hysteresis.unloading": lambda value, _: [0.9 * tension for tension in value] if value else None,
    "Webbing.stretch": lambda value, _: 1.1 * value if value else None,
    "Webbing.name": lambda value, _: "pinkTube" if value else None,
    "Cut.time": lambda value, _: 0.5 * value,
    "Cut.strength": 1.0,
    "Line.strength": "1e9 N",
    "Brake.force": lambda value, block: 2.0 * value if value else 60.0,
    "Brake.rate": lambda value, _: 2.0 * value if value else 20.0,
    "Brake.stiffness": lambda value, _: 2.0 * value if value else 500.0,
    "Segment.mass": lambda value, _: 2.0 * value if value else 2.6e3,
    "Segment.bending_stiffness": lambda value, block: 2.0 * value if value else None,
    "Segment.damage": lambda value, block: None if block.get("bending_stiffness") else 0.5,
    "Segment.foundation": lambda value, _: 2.0 * value if value else 1e6,
    "Line.profile": lambda value, _: Patch(profile=None) if value else None,
    "Profile.file": Patch(file=HILLS, spectrum=None, wavelengths=None),
    "Profile.spectrum": Each(("ISO 8608 D", "FRA 6", "German low")),
    "Profile.wavelengths": [0.4, 20.0],
    "Scenario.hangers": lambda _, block: _grown("hangers", block, mass=1.0) or None,
    "Scenario.tracks": lambda _, block: _grown("tracks", block, pads={"stiffness": "40 MN/m"}) or None,
    "Track.over": lambda value, _: Patch(over=None) if value else None,
    "Track.pads": {"stiffness": "40 MN/m"},
    "Track.sleepers": {"spacing": 1.2},
    "Track.ballast": {"mass": 300.0},
    "Track.on_bridge": {"mass": 300.0},
    "Track.subgrade": {"stiffness": "40 MN/m"},
    "Hangers.count": 3,
    "Hangers.at": Patch(at=[5.0, 9.0], count=None),
    "Hangers.camber": 0.1,
    "Line.wind_drag": lambda value, _: 2.0 * value or 0.02,
    "Elastic.damping": lambda value, _: 2.0 * value or 1e3,
    "Elastic.mass": lambda value, _: 2.0 * value or 5.0,
    "Elastic.displacement": lambda value, _: Each((shaken(0.05), [0.0, 0.05])),
    "Guided.stiffness": lambda value, _: 2.0 * value or 1e4,
    "Guided.damping": lambda value, _: 2.0 * value or 1e3,
    "Guided.force": lambda value, _: 1.1 * value or 1e3,
    "Guided.mass": lambda value, _: 2.0 * value or 5.0,
    "Joined.at": lambda value, _: value - 1.0 if isinstance(value, float) else 3.0,
    "Joint.mass": lambda value, _: 2.0 * value or 3.0,
    "Joint.force": _place,
    "Sheave.friction": lambda value, _: 2.0 * value or 0.1,
    "Sheave.to": lambda value, _: Patch(to=None) if value else "ring",
    # Overhead lines.
    "OverheadLine.start": _place,
    "OverheadLine.contact_wire": {"mass": 1.5},
    "OverheadLine.messenger_wire": {"mass": 1.5},
    "OverheadLine.droppers": {"per_span": 4},
    "OverheadLine.pre_sag": 0.02,
    "OverheadLine.heights": lambda value, _: [0.31, 0.12, 0, 0] if value and value[0] else [0, 0, 0.12, 0.31],
    "OverheadLine.radius": Patch(radius=800.0, steady_arms={"stagger": [0.2] * 4}),
    "OverheadLine.overlap": lambda value, _: Patch(overlap=None) if value else None,
    "OverheadLine.steady_arms": {"mass": 1.0},
    "OverheadLine.messenger_supports": {"stiffness": 1e6},
    "OverheadLine.stitch_wire": lambda value, _: {"length": 16.0 if value is None else 9.0},
    "OverheadLine.analysed_spans": Each(([1, 2],)),
    "OverheadLine.condition": {"missing_droppers": [[2, 1]]},
    "Condition.missing_droppers": lambda *_: [[2, 1]],
    "Condition.wear": 0.2,
    "Condition.temperature_rise": -20.0,
    "Condition.expansion": Patch(expansion=3e-5, temperature_rise=20.0),
    "OverheadWire.bending_stiffness": lambda value, _: 2.0 * value or 50.0,
    "OverheadWire.retardation": lambda value, _: 2.0 * value or 1e-4,
    "Droppers.at": Patch(per_span=None, at=[3.0, 9.0, 17.0]),
    "Droppers.per_span": 4,
    "Droppers.lengths": lambda value, _: [1.19, 1.17, 1.19],
    "Droppers.pushes": 5e4,
    "Droppers.damping": 100.0,
    "Droppers.mass": Patch(mass=0.5, mass_per_length=None),
    "Droppers.mass_per_length": Patch(mass=None, mass_per_length=0.2),
    "Droppers.contact_clamp": 0.2,
    "Droppers.messenger_clamp": 0.2,
    "Guided.winch": lambda value, _: {"speed_limit": 1e-3} if value is None else None,
    "Winch.speed_limit": 1e-3,
    "Winch.dead_band": 500.0,
    "Droppers.strength": lambda value, _: 20.0 if value is None else None,
    "Droppers.cut": lambda value, _: {"droppers": [[2, 2]], "time": 0.05} if value is None else None,
    "DropperCut.droppers": lambda *_: [[1, 3]],
    "DropperCut.time": 0.05,
    "SteadyArms.mass": Patch(mass=2.0, mass_per_length=None),
    "SteadyArms.mass_per_length": lambda value, _: Patch(mass=None, mass_per_length=2.0 * value if value else 1.0),
    "SteadyArms.stagger": 0.1,
    "MessengerSupports.stiffness": lambda value, _: 2e6,
    "MessengerSupports.damping": lambda value, _: 500.0,
    "MessengerSupports.along": Each(("swings", "held")),
    "StitchWire.length": 9.0,
    "StitchWire.clamp": 0.2,
    # Nets and membranes.
    "Sheet.corner": lambda value, _: Patch(corner=_place(value, _)) if value else Patch(
        boundary=None, spacing=None, corner=NET["corner"], sides=NET["sides"]),
    "Sheet.sides": lambda value, _: Patch(sides=[[4.4, 0.0, 0.0], [0.0, 3.0, 0.0]]) if value else Patch(
        boundary=None, spacing=None, corner=NET["corner"], sides=NET["sides"]),
    "Sheet.cells": [7, 6],
    "Sheet.boundary": _outline,
    "Sheet.spacing": lambda value, _: 0.7,
    "Sheet.edge": lambda value, _: {"kind": "soft", "stiffness": 4e4} if value.kind == "clamped" else {
        "kind": "clamped"},
    "Net.mesh": lambda value, _: 0.4,
    "Net.tension": _sheet_tension,
    "Membrane.tension": _sheet_tension,
    "Sheet.slack": Patch(slack=0.98, tension=None),
    "Net.slack": Patch(slack=0.98, tension=None),
    "Membrane.slack": Patch(slack=0.98, tension=None),
    "SoftEdge.damping": lambda value, _: 2.0 * value or 50.0,
    "CableEdge.tension": lambda value, _: 2e3,
    # Loads.
    "*.from": lambda value, _: 0.3 if value == 0.0 else 0.9 * value,
    "FreeTravel.margin": lambda value, _: 2.0 * value if value else 1.5,
    "*.margin": lambda value, _: 2.0 * value if value else 14.0,
    "*.path": lambda value, _: [[0.5, 1.0], [3.5, 2.0]] if value else PATH,
    "*.air_drag": lambda value, _: 2.0 * value or 1.0,
    "*.viscous": lambda value, _: 2.0 * value or 5.0,
    "*.rolling": lambda value, _: 2.0 * value or 0.05,
    "*.friction": lambda value, _: 2.0 * value if value else 0.2,
    "MovingForce.friction": lambda value, _: 2.0 * value if value else 1e-4,
    "*.lift_off": lambda value, block: Patch(lift_off=not value, side=None, contact_stiffness=None) if (
        block.get("kind") == "oscillator") else Patch(lift_off=not value),
    "*.contact_stiffness": lambda value, _: 2.0 * value if value else 2e6,
    "MovingMass.force": lambda value, _: [0.0, -100.0],
    "Trolley.force": lambda value, _: [10.0, -50.0],
    "FreeTravel.speed": lambda value, _: 1.1 * value or 1.0,
    "FreeTravel.drive": lambda value, _: 40.0,
    "FreeTravel.driver": {"speed": 22.0, "force": 50.0},
    "FreeTravel.brake": {"force": 50.0, "within": 18.0},
    "Oscillator.damping": lambda value, _: 2.0 * value,
    "Oscillator.wheel_mass": lambda value, _: 1.25 * value or 5.0,
    "Trolley.also_on": lambda value, _: [] if value else None,
    "Payload.damping": lambda value, _: 2.0 * value or 100.0,
    "Payload.swing": "15 deg",
    "Payload.at": Patch(at=[0.5, -2.1], swing=None),
    "Payload.hoist": lambda value, _: 2.0 * value or 0.5,
    "Carriage.wheel_mass": 1.0,
    "Carriage.cabin": lambda value, _: Patch(cabin=None) if value else {"mass": 20.0, "hanger": 2.0},
    "Carriage.haul": lambda value, _: Patch(haul=None) if value else {
        "to": "end", "speed": 1.0, "axial_stiffness": 1e5},
    "Cabin.inertia": lambda value, _: 2.0 * value,
    "Cabin.damping": lambda value, _: 2.0 * value,
    "Cabin.swing": "10 deg",
    "Haul.speed": lambda value, _: 3.0 if value else Patch(speed=2.0, over_to=None),
    "Haul.over_to": lambda value, _: Patch(speed=1.0, over_to=None) if value else "nobody",
    "Haul.axial_damping": lambda value, _: 2.0 * value or 500.0,
    "Haul.mass": 1.0,
    "Haul.beyond": 5.0,
    "Haul.sags": lambda value, _: False if value else None,
    "Haul.counter": lambda value, _: Patch(counter=None, sheave=None) if value else {"tension": 2e3},
    "Haul.elements": 2,
    "Haul.sheave": lambda value, _: {"friction": 0.01, "wrap": 1.0} if value else None,
    "CounterRope.axial_stiffness": 1e3,
    "Vehicle.bodies": _bodies,
    "Vehicle.springs": _springs,
    "RigidBody.inertia": lambda value, _: 1.5 * value or 10.0,
    "RigidBody.at": 0.2,
    "Wheel.at": lambda value, _: 1.25 * value,
    "Spring.at": lambda value, _: 0.5,
    "Matrices.damping": [[50.0, -50.0], [-50.0, 50.0]],
    "Matrices.weight": [300.0, 80.0],
    "MatrixWheel.at": 0.3,
    "Vehicle.gravity": 5.0,
    "Footsteps.phase": 0.3,
    "Footsteps.balance": Patch(balance={}, lateral=None),
    "Crowd.mass": {"mean": 20.0, "deviation": 1.0},
    "Crowd.frequency": {"mean": 2.1, "deviation": 0.1},
    "Crowd.step_length": {"mean": 0.6, "deviation": 0.01},
    "Crowd.model": Each(("bachmann", "young")),
    "Crowd.lateral": Each(("bachmann", "setra")),
    "Crowd.balance": Patch(balance={}, lateral=None),
    "Crowd.rate": 40.0,
    "Crowd.spread": "even",
    "Crowd.towards": "start",
    "Crowd.at_end": "leave",
    "Footsteps.model": Each(("bachmann", "young")),
    "Footsteps.lateral": Each(("bachmann", "setra")),
    "Harmonic.phase": "40 deg",
    "Walker.leg_damping": lambda value, _: 2.0 * value or 100.0,
    "Walker.foot_mass": lambda value, _: 2.0 * value or 1.0,
    "Walker.balance": lambda value, _: {} if value is None else {"width": 0.03},
    "Stepper.options": lambda value, _: {**value, "force": 300.0},
    "Exchange.scheme": _scheme,
    "Exchange.order": lambda value, _: Each(order for order in (0, 1, 2) if order != value),
    "Exchange.stiffness": 1e4,
    "Exchange.damping": lambda value, _: 2.0 * value or 50.0,
    "Exchange.tolerance": 1e-3,
    "Exchange.iterations": 2,
    "Exchange.warn": 1e-9,
    "*.exchange": lambda value, _: {"damping": 100.0},
    "FmuContact.at": 0.5,
    "FmuContact.force_along": lambda value, _: "contact1.force",
    "FmuContact.height": Patch(height=None),
    "FmuContact.velocity": Patch(velocity=None),
    "FmuContact.place": "contact1.height",
    "Fmu.parameters": {"mass": 1.0},
    "Fmu.start_values": {"contact1.velocity": 0.5},
    "Pantograph.model": lambda value, _: "simple-ac" if value else Patch(
        model="en50318-2002", masses=None, stiffness=None, damping=None),
    "Pantograph.masses": [14.0, 8.0],
    "Pantograph.stiffness": [60.0, 4000.0],
    "Pantograph.damping": [80.0, 20.0],
    "Pantograph.static_force": 90.0,
    "Pantograph.aerodynamic": 0.02,
    "Pantograph.aerodynamic_on": Each(("head", "frame")),
    "Pantograph.mean_force": Patch(mean_force=100.0, static_force=None, aerodynamic=None),
    "Pantograph.contact_damping": 20.0,
    "Pantograph.head": lambda value, _: Patch(head=None) if value else {"spacing": 2.0},
    "PantographHead.strips": Patch(strips=1, spacing=None, pitch=None),
    "PantographHead.pitch": lambda value, _: Patch(pitch=None) if value else {"inertia": 0.3, "spring_spacing": 0.5},
    "PantographHead.roll": lambda value, _: Patch(roll=None) if value else {"inertia": 1.0, "spring_spacing": 0.9},
    "Pantograph.irregularity": lambda value, _: Patch(irregularity=None) if value else HILLS,
    # Runs.
    "*.every": lambda value, _: 0.75 * value if value else 0.5 * UNTIL,
    "*.modes": lambda value, _: value + 3 if value else 15,
    "Dynamic.step": 1e-4,
    "Dynamic.accuracy": Each((1e-7, 1e-20, 1e3)),
    "Dynamic.start": lambda value, _: {"kind": "mode", "amplitude": 0.02} if value.kind == "rest" else {"kind": "rest"},
    "Dynamic.sample": 5e-4,
    "Dynamic.window": lambda value, _: 6.0,
    "Dynamic.axial_inertia": 4.0,
    "Start.file": lambda value, _: EARLIER if value is None else "another.nc",
    "Start.time": 0.05,
    "Start.number": 2,
    "Start.amplitude": lambda value, _: 0.03,
    "Start.direction": [0.0, 1.0, 0.2],
    "Start.line": lambda value, _: "rope",
    "Quasistatic.turn": lambda value, _: "1 deg",
}  # fmt: skip
"""By `Class.key` as written in scenarios, of the class or one that it comes from; `*.key`: of any class."""
