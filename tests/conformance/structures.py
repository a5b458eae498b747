"""Structures of the matrix: small, quickly computed, with numbers in which a right engine closes its audit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

Tree = dict[str, Any]

DOWN = 9.81


@dataclass(frozen=True)
class Structure:
    """What loads travel on, and loads that suit it: their weight bends it well within reason, below its wave speed."""

    name: str
    label: str
    parts: Tree  # of the scenario, without loads and run
    on: str = "rope"
    length: float = 20.0  # m, along which loads travel
    start: float = 5.0  # m, where they begin
    mass: float = 50.0  # kg, of a load
    speed: float = 20.0  # m/s, of a load
    until: float = 0.24  # s
    run: Mapping[str, Any] = field(default_factory=dict)  # more keys of a dynamic run
    twin: str = ""  # structure of which it is the same thing, said in other words
    family: str = "rope"  # rope, stiff, overhead, joined, surface

    @property
    def is_surface(self) -> bool:
        """Whether loads need a path."""
        return self.family == "surface"

    def line(self) -> Tree:
        """The line that loads travel on."""
        found: Tree = self.parts["lines"][self.on]
        return found

    def with_line(self, **changes: Any) -> Tree:
        """The parts with keys of that line changed; None takes a key out."""
        line = {k: v for k, v in {**self.line(), **changes}.items() if v is not None}
        return {**self.parts, "lines": {**self.parts["lines"], self.on: line}}


TAUT: Tree = {
    "start": [0.0, 0.0], "end": [20.0, 0.0], "tension": "10 kN", "mass": 1.0, "axial_stiffness": "1 MN", "elements": 80,
}  # fmt: skip
"""Waves run at 100 m/s; a load of 50 kg bends it by a quarter of a metre."""

SLACK: Tree = {
    "start": [0.0, 0.0], "end": [19.0, 0.0], "length": 20.0, "mass": 1.0, "axial_stiffness": "1 MN",
    "axial_damping": "200 N*s", "elements": 200,
}  # fmt: skip
"""Hangs through by 2.7 m; waves run at 13 m/s; with 100 links the audit of a force misses up to 9 %, with 200 two."""

BEAM: Tree = {
    "start": [0.0, 0.0], "end": [20.0, 0.0], "length": 20.0, "mass": 2000.0, "bending_stiffness": "2 GN*m^2",
    "axial_stiffness": "10 GN", "elements": 24,
}  # fmt: skip
"""A bridge of 3.9 Hz."""

BED: Tree = {**BEAM, "mass": 600.0, "bending_stiffness": "10 MN*m^2", "axial_stiffness": "1 GN", "elements": 40,
             "foundation": "5 MN/m^2"}  # fmt: skip
"""A track on soft ground: the slowest free wave runs at 153 m/s."""

RAIL: Tree = {
    "start": [0.0, 0.0], "end": [20.0, 0.0], "length": 20.0, "mass": 120.0, "bending_stiffness": "13 MN*m^2",
    "axial_stiffness": "300 MN", "elements": 40,
}  # fmt: skip
DECK: Tree = {
    **BEAM, "start": [5.0, -1.0], "end": [15.0, -1.0], "length": 10.0, "bending_stiffness": "300 MN*m^2",
    "axial_stiffness": "1 GN", "elements": 10,
}  # fmt: skip
TRACK: Tree = {"rail": "rope", "over": ["deck"], "sleepers": {"spacing": 0.8}}
"""Sleepers on the ground, on a bridge of 10 m, and on the ground."""

OVERHEAD: Tree = {
    "spans": {"count": 3, "length": 40.0}, "droppers": {"per_span": 4}, "element": 1.0, "analysed_spans": [2, 2],
    "contact_wire": {"drag": 0.05}, "messenger_wire": {"drag": 0.05},
}  # fmt: skip

_CURVE: Tree = {"radius": 2000.0, "steady_arms": {"stagger": [0.2] * 4}}
_STITCHED: Tree = {**_CURVE, "stitch_wire": {"length": 18.0}}
OVERLAP: Tree = {
    "section": {**OVERHEAD, **_CURVE, "heights": [0.0, 0.0, 0.02, 0.4], "overlap": "next"},
    "next": {**OVERHEAD, **_CURVE, "heights": [0.4, 0.02, 0.0, 0.0], "start": [40.0, 0.0]},
}
"""Both contact wires are beside each other from 40 to 120 m, and cross at 80 m."""

_FAILING: Tree = {"cut": {"droppers": [[2, 2]], "time": 0.1}, "strength": "400 N"}
"""One is cut at 60 m, between where loads begin and where they come to; others tear beside heavy ones."""

_STEPS: Tree = {
    "haunch": {"from": 0.0, "to": 5.0, "bending_stiffness": "4 GN*m^2", "mass": 2500.0},
    "damage": {"from": 12.0, "to": 13.0, "damage": "30 %"},
}
STIFF: Tree = {**TAUT, "bending_stiffness": "10 kN*m^2"}
"""Bending counts over a metre at a support, two elements."""

SLACK_STIFF: Tree = {k: v for k, v in SLACK.items() if k != "axial_damping"} | {"bending_stiffness": 100.0, "drag": 0.5}

NET: Tree = {
    "kind": "net", "corner": [0.0, 0.0, 0.0], "sides": [[4.0, 0.0, 0.0], [0.0, 3.0, 0.0]], "cells": [12, 9],
    "axial_stiffness": 1e4, "mass": 0.05, "tension": 100.0,
}  # fmt: skip
MEMBRANE: Tree = {**{k: v for k, v in NET.items() if k != "axial_stiffness"}, "kind": "membrane", "stiffness": 1e5,
                  "mass": 0.3, "tension": 500.0}  # fmt: skip
AWNING: Tree = {
    "kind": "membrane", "boundary": [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 3.0, 0.0], [0.0, 3.0, 0.0]],
    "spacing": 0.4, "stiffness": 1e5, "mass": 0.3, "tension": 500.0,
    "edge": {"kind": "cable", "axial_stiffness": "2 MN", "mass": 0.5, "tension": "3 kN"},
}  # fmt: skip


def rope(line: Tree, **more: Any) -> Tree:
    """A scenario of one line."""
    return {"lines": {"rope": line}, **more}


def taut(**changes: Any) -> Tree:
    return {k: v for k, v in {**TAUT, **changes}.items() if v is not None}


def slack(**changes: Any) -> Tree:
    return {k: v for k, v in {**SLACK, **changes}.items() if v is not None}


_STILL = {"direction": [1.0, 0.0], "speed": 0.0}
_BESIDE: Tree = {**STIFF, "start": [0.0, 20.0], "end": [20.0, 20.0]}
_SLOW = {"mass": 5.0, "speed": 3.0, "until": 0.4}
_HEAVY = {"mass": 2000.0, "speed": 20.0, "until": 0.24, "family": "stiff"}
_PIERS: Tree = {
    "pier": {"at": 10.0, "kind": "guided", "along": [1.0, 0.0]},
    "bearing": {"at": 15.0, "kind": "elastic", "stiffness": [0.0, "100 MN/m"], "damping": "10 kN*s/m"},
}
"""One stands fast; the other one yields by a tenth of what the span does."""
_CABLE = {"family": "stiff"}
_SPANS = {
    "on": "section", "length": 120.0, "start": 50.0, "speed": 30.0, "mass": 10.0, "until": 0.4, "family": "overhead",
}  # fmt: skip
_SHEET = {"on": "net", "length": 3.0, "start": 0.5, "mass": 2.0, "speed": 3.0, "until": 0.2, "family": "surface"}
_LINEARISED = {"geometry": "linearised"}

STRUCTURES: tuple[Structure, ...] = (
    Structure("string", "taut string", rope(TAUT)),
    Structure("damped", "taut string, damped", rope(taut(axial_damping="500 N*s", drag=0.5))),
    Structure("slack", "slack rope", rope(SLACK), **_SLOW),
    Structure("undamped", "slack rope without damping", rope(slack(axial_damping=None)), **_SLOW),
    Structure("inclined", "inclined rope", rope(taut(end=[18.0, 8.0]))),
    Structure("spatial", "rope in 3-D", rope(taut(start=[0.0, 0.0, 0.0], end=[18.0, 6.0, 5.0]))),
    Structure("tension_only", "slack rope that only pulls", rope(slack(law={"kind": "tension_only"})), **_SLOW),
    Structure("piola", "string with the paper's law", rope(taut(law={"kind": "second_piola_kirchhoff"}))),
    Structure(
        "polynomial", "string with a polynomial law",
        rope(taut(law={"kind": "polynomial", "coefficients": [1e6, 5e6]}, axial_stiffness=None)),
    ),
    Structure(
        "tabulated", "string with a tabulated law",
        rope(taut(law={"kind": "table", "strain": [0, 0.02, 0.05], "tension": [0, 15e3, 60e3]}, axial_stiffness=None)),
    ),
    Structure("cut", "slack rope that is cut", rope(slack(cut={"at": 15.0, "time": 0.2})), **_SLOW),
    Structure(
        "hysteresis", "slack webbing with hysteresis",
        rope(slack(law={"kind": "webbing", "stretch": 0.04}, axial_stiffness=None, axial_damping=None,
                   hysteresis={"ratio": 0.8, "stiffness": "250 kN"})), **_SLOW,
    ),
    Structure(
        "inextensible", "inextensible rope",
        rope(slack(law={"kind": "inextensible"}, axial_stiffness=None, axial_damping=None)), **_SLOW,
    ),
    Structure("stiff", "stiff cable, taut", rope(STIFF), **_CABLE),
    Structure("stiff-linearised", "stiff cable, taut, linearised", rope(STIFF), run=_LINEARISED, **_CABLE),
    Structure("slack-stiff", "stiff cable, slack", rope(SLACK_STIFF), **_SLOW, **_CABLE),
    Structure("slack-stiff-linearised", "stiff cable, slack, linearised", rope(SLACK_STIFF), run=_LINEARISED, **_SLOW,
              **_CABLE),
    Structure("inclined-stiff", "stiff cable, inclined", rope({**STIFF, "end": [18.0, 8.0]}), **_CABLE),
    Structure("beam", "beam", rope(BEAM), **_HEAVY),
    Structure("beam-linearised", "beam, linearised", rope(BEAM), run=_LINEARISED, **_HEAVY),
    Structure("beam-damped", "beam, damped, linearised", rope({**BEAM, "drag": 0.6}), run=_LINEARISED, **_HEAVY),
    Structure("piers", "beam on piers", rope({**BEAM, "supports": _PIERS}), **_HEAVY),
    Structure("stepped", "beam in segments", rope({**BEAM, "elements": 40, "segments": _STEPS}), **_HEAVY),
    Structure(
        "rough", "beam with a rough surface",
        rope({**BEAM, "profile": {"spectrum": "ISO 8608 A", "seed": 1, "wavelengths": [2.0, 20.0]}}), **_HEAVY,
    ),
    Structure("bed", "line on a bed", rope(BED), **_HEAVY),
    Structure("bed-linearised", "line on a bed, linearised", rope(BED), run=_LINEARISED, **_HEAVY),
    Structure("track", "track over a bridge", {"lines": {"rope": RAIL, "deck": DECK}, "tracks": {"track": TRACK}},
              run=_LINEARISED, **_HEAVY),
    Structure("overhead", "overhead line", {"overhead_lines": {"section": OVERHEAD}}, **_SPANS),
    Structure("overhead-linearised", "overhead line, linearised", {"overhead_lines": {"section": OVERHEAD}},
              run=_LINEARISED, **_SPANS),
    Structure(
        "staggered", "overhead line, staggered",
        {"overhead_lines": {"section": {**OVERHEAD, "steady_arms": {"stagger": "200 mm"}}}}, **_SPANS,
    ),
    Structure(
        "failing", "overhead line with droppers that fail",
        {"overhead_lines": {"section": {**OVERHEAD, "droppers": {**OVERHEAD["droppers"], **_FAILING}}}}, **_SPANS,
    ),
    Structure(
        "stitched", "overhead line with stitch wires on a curve",
        {"overhead_lines": {"section": {**OVERHEAD, **_STITCHED}}},
        **_SPANS,
    ),
    Structure(
        "overlap", "overhead lines that overlap on a curve, linearised", {"overhead_lines": OVERLAP}, run=_LINEARISED,
        **_SPANS,
    ),
    Structure(
        "joined", "rope hung from another",
        {"lines": {
            "rope": TAUT,
            "hanger": {"start": [10.0, 4.0], "end": [10.0, 0.0], "length": 4.05,
                       "end_support": {"kind": "joined", "to": "rope", "at": 9.9},
                       "mass": 0.5, "axial_stiffness": "500 kN", "elements": 8},
        }}, family="joined",
    ),
    Structure(
        "hung", "rope on a row of hangers",
        {"hangers": {"hanger": {"from": "cable", "to": "rope", "count": 3, "mass": 0.5, "axial_stiffness": "500 kN"}},
         "lines": {
             "cable": {**TAUT, "start": [0.0, 4.0], "end": [20.0, 4.0], "tension": "20 kN"},
             "rope": TAUT,
        }}, family="joined",
    ),
    Structure(
        "ring", "ropes joined at a ring",
        {"joints": {"ring": {"mass": 3.0}}, "lines": {
            "rope": taut(end=[12.0, 0.0], end_support={"kind": "joined", "to": "ring"}, tension=None, length=11.9,
                         elements=48),
            "right": taut(start=[12.0, 0.0], start_support={"kind": "joined", "to": "ring"}, tension=None, length=7.95,
                          elements=32),
        }}, length=11.9, start=2.0, family="joined",
    ),
    Structure(
        "sheave", "rope over a sheave",
        rope(taut(sheaves={"tower": {"at": [12.0, 1.0], "friction": 0.05}}, tension=None, length=19.9)), length=19.9,
        start=2.0, family="joined",
    ),
    Structure(
        "saddle", "rope over a saddle that holds it",
        rope(taut(supports={"saddle": {"at": 16.83, "kind": "fixed", "position": [17.0, 0.1]}})), family="joined",
    ),
    Structure(
        "shoe", "rope over a saddle on which it slips",
        rope(taut(saddles={"tower": {"at": [12.0, 0.5], "radius": 2.0, "friction": 0.1}}, tension=None, length=19.95)),
        length=19.9, start=2.0, family="joined",
    ),
    Structure(
        "wind", "rope in wind", rope(slack(wind_drag=0.02), wind={"direction": [1.0, 0.0], "speed": 15.0}), **_SLOW,
        family="joined",
    ),
    Structure(
        "gale", "string in wind from the side",
        rope(taut(wind_drag=0.02), wind={"direction": [0.0, 1.0, 0.0], "speed": 20.0}), family="joined",
    ),
    Structure(
        "two-ropes", "two track ropes that yield differently",
        {"lines": {"rope": TAUT, "second": {**TAUT, "axial_stiffness": "500 kN"}}}, family="joined",
    ),
    Structure("net", "net", {"nets": {"net": NET}}, **_SHEET),
    Structure("membrane", "membrane", {"nets": {"net": MEMBRANE}}, **_SHEET),
    Structure("awning", "membrane with an edge cable", {"nets": {"net": AWNING}}, **_SHEET),
    # The same things in other words: what a line without any bending, a wind of nothing or a neighbour far away adds
    # to a rope is nothing, but another engine computes it.
    Structure("string+ei", "taut string, EI = 1e-9", rope(taut(bending_stiffness=1e-9)), twin="string", **_CABLE),
    Structure("string+wind", "taut string, wind of 0 m/s", rope(taut(wind_drag=0.01), wind=_STILL), twin="string",
              family="joined"),
    Structure("string+beside", "taut string, a stiff line elsewhere", {"lines": {"rope": TAUT, "beside": _BESIDE}},
              twin="string", **_CABLE),
    Structure("damped+beside", "damped string, a stiff line elsewhere",
              {"lines": {"rope": taut(axial_damping="500 N*s", drag=0.5), "beside": _BESIDE}}, twin="damped", **_CABLE),
    Structure("slack+ei", "slack rope, EI = 1e-9", rope(slack(axial_damping=None, bending_stiffness=1e-9)),
              twin="undamped", **_SLOW, **_CABLE),
    Structure("slack+wind", "slack rope, wind of 0 m/s", rope(slack(axial_damping=None, wind_drag=0.01), wind=_STILL),
              twin="undamped", **_SLOW, family="joined"),
    Structure("slack+beside", "slack rope, a stiff line elsewhere",
              {"lines": {"rope": slack(axial_damping=None), "beside": _BESIDE}}, twin="undamped", **_SLOW, **_CABLE),
)  # fmt: skip

BY_NAME = {structure.name: structure for structure in STRUCTURES}
