"""What a solver hands over: the layout of a result, once, and a frame for every output instant."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.checkpoint import Tree

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

ENERGY_FORMS = (
    "kinetic",  # of the lines and of what moves with their ends
    "elastic",  # stored in the lines and in the springs of their supports
    "gravitational",  # of the lines and of what their supports carry, zero at z = 0; and of constant forces there
    "line_damping",  # dissipated in lines, by Kelvin-Voigt and drag damping, and in supports, since the start
    "load_work",  # done by the given forces since the start
    "hold_work",  # done by the hold forces since the start
    "contact_dissipation",  # lost at the contacts since the start; negative: a motor is hidden there
    "support_work",  # done by supports that move as prescribed since the start
    "load_kinetic",  # of the loads
    "load_potential",  # of the loads: of their weights, zero at z = 0, and stored in their springs
    "load_damping",  # dissipated in dampers of the loads and by drag of the air, since the start
    "friction",  # lost to friction and brakes along the lines, since the start
    "hysteresis",  # lost in lines whose unloading gives back less than loading has taken, since the start
    "drive_work",  # done by drives and drivers since the start
    "imbalance",  # what the audit misses: zero for an exact solution
)

OFF_LINE, IN_AIR, STICKS, MOVES = 0.0, 1.0, 2.0, 3.0
CONTACT_STATES = ("off_line", "in_air", "at_rest_on_line", "moves_along_line")


@dataclass(frozen=True)
class Layout:
    """Names and coordinates that stay the same over all frames of a run."""

    axes: tuple[str, ...]  # ("x", "z") or ("x", "y", "z")
    node_line: tuple[str, ...]  # line of each node
    node_xi: Array  # material coordinate of each node, m
    link_line: tuple[str, ...]
    link_xi: Array  # material coordinate of the middle of each link, m
    contact_load: tuple[str, ...]  # load of each contact
    support: tuple[str, ...]  # "rope.start", "rope.end", ...
    body: tuple[str, ...] = ()  # bodies of loads beside their contacts
    tie: tuple[str, ...] = ()  # droppers and other ties
    tie_station: tuple[float, ...] = ()  # m along the line that carries them, of each
    watched: tuple[str, ...] = ()  # points of lines whose height is sampled
    watched_station: tuple[float, ...] = ()  # m
    sample: tuple[float, ...] = ()  # s, offsets of samples from the output instant: before it, or zero
    external: tuple[str, ...] = ()  # loads that are external models
    compared: tuple[str, ...] = ()  # load of each contact, where they are compared with those on a coarser mesh
    hauled: tuple[str, ...] = ()  # carriages that ropes haul
    sheave: tuple[str, ...] = ()  # sheaves over which lines run: "rope.wheel"
    cell: tuple[tuple[int, int, int], ...] = ()  # nodes of each triangle of nets and membranes
    cell_net: tuple[str, ...] = ()  # net of each triangle
    path: str = "time"  # leading dimension: "time" (s) or "load_path" (m)
    weight: float = float("nan")  # N, what the supports carry at rest without loads; NaN: they are not alone in it


@dataclass(frozen=True)
class Frame:
    """The state at one output instant; contact entries are NaN while a load is off the line."""

    path: float  # time in s, or load path in m
    position: Array  # (node, axis) m
    velocity: Array  # (node, axis) m/s
    tension: Array  # (link,) N
    strain: Array  # (link,)
    contact_position: Array  # (contact, axis) m
    contact_force: Array  # (contact, axis) N, on the line, hold force included
    hold_force: Array  # (contact, axis) N
    contact_xi: Array  # (contact,) m
    contact_speed: Array  # (contact,) m/s as measured
    contact_tension: Array  # (contact, 2) N, behind (towards the start of the line) and ahead
    contact_friction: Array  # (contact,) friction coefficient that these tensions need at least
    contact_state: Array  # (contact,) OFF_LINE, IN_AIR, STICKS or MOVES
    contact_in_air: Array  # (contact,) s, time in the air so far
    friction_power: Array  # (contact,) W, lost to friction along the line
    body_position: Array  # (body, axis) m
    body_velocity: Array  # (body, axis) m/s
    reaction: Array  # (support, axis) N, of the support on the line
    energy: Array  # (form,) J, in the order of ENERGY_FORMS
    # What only some runs have: None stands for an array without entries.
    tie_force: Array | None = None  # (tie,) N
    sampled_station: Array | None = None  # (sample, contact) m
    sampled_force: Array | None = None  # (sample, contact) N, upwards on the line
    sampled_height: Array | None = None  # (sample, contact) m
    sampled_tie_force: Array | None = None  # (sample, tie) N
    sampled_uplift: Array | None = None  # (sample, watched) m
    haul_tension: Array | None = None  # (hauled, rope_end) N
    haul_slip: Array | None = None  # (hauled,) m
    sheave_station: Array | None = None  # (sheave,) m, of their lines
    cell_tension: Array | None = None  # (cell, direction) N/m
    contact_change: Array | None = None  # (compared, axis) m, from the mesh with half the elements to this one
    exchange_work: Array | None = None  # (foreign,) J, that has gone through the interface
    exchange_residual: Array | None = None  # (foreign,) J, that the exchange has made
    exchange_peak: Array | None = None  # (foreign,) J, the most of it in one interval since the last frame


class Contacts:
    """What a frame tells of contacts, to be filled in: at first they are off the line.

    Args:
        sizes: (contact, axis); of several frames with their number in front.
    """

    def __init__(self, *sizes: int) -> None:
        one = sizes[:-1]
        self.position, self.force, self.hold = (np.full(sizes, np.nan) for _ in range(3))
        self.xi, self.speed, self.friction = (np.full(one, np.nan) for _ in range(3))
        self.tension, self.state = np.full((*one, 2), np.nan), np.full(one, OFF_LINE)
        self.in_air, self.power = np.zeros(one), np.zeros(one)

    def leave(self, left: NDArray[np.bool_]) -> None:
        """Put contacts (contact,) of one frame off the line."""
        for values in (self.position, self.force, self.hold, self.xi, self.speed, self.friction, self.tension):
            values[left] = np.nan
        self.state[left] = OFF_LINE

    def fields(self) -> dict[str, Array]:
        """The same by the names of `Frame`."""
        return {
            "contact_position": self.position, "contact_force": self.force, "hold_force": self.hold,
            "contact_xi": self.xi, "contact_speed": self.speed, "contact_tension": self.tension,
            "contact_friction": self.friction, "contact_state": self.state, "contact_in_air": self.in_air,
            "friction_power": self.power,
        }  # fmt: skip


def uniform(names: Sequence[str], links: Integers, h: Array) -> dict[str, Any]:
    """Names and coordinates of nodes and links of lines that are divided evenly, by the names of `Layout`.

    Args:
        links: (line,) their numbers.
        h: (line,) m, their lengths.
    """
    return {
        "node_line": tuple(name for name, n in zip(names, links, strict=True) for _ in range(int(n) + 1)),
        "node_xi": np.concatenate([np.arange(n + 1) * each for n, each in zip(links, h, strict=True)]),
        "link_line": tuple(name for name, n in zip(names, links, strict=True) for _ in range(int(n))),
        "link_xi": np.concatenate([(np.arange(n) + 0.5) * each for n, each in zip(links, h, strict=True)]),
    }


@dataclass(frozen=True)
class Doubt:
    """A reason not to trust a run that went through."""

    what: str  # what is wrong, with its numbers
    cause: str  # what most likely made it so
    key: str  # of the scenario that is to blame, as "lines.rope.elements"; empty where there is none
    remedy: str  # what to do, beginning with a verb

    def __str__(self) -> str:
        key = f" ({self.key})" if self.key else ""
        return f"{self.what}; likely cause: {self.cause}{key}; {self.remedy}"

    @staticmethod
    def key_in(text: str) -> str:
        """The key that a doubt is to blame on, from the text that results keep of it; empty where there is none."""
        found = _BLAMED.search(text)
        return found[1] if found else ""


_BLAMED = re.compile(r"; likely cause: .*\(([a-z_]+(?:\.[^()]+)?)\); ")


SPLINE = "fourth order"
"""What bending is of where that is right of a spline through the nodes, see `system/elements/cables.py`."""

MEAN = "mean of links"
"""What second differences of deflections are of where these are right at nodes, see `wires/bending.py`."""


@dataclass
class RunInfo:
    """How a run went: filled in while it runs, written as attributes at the end."""

    outcome: str = "running"  # "completed", "doubtful", "interrupted", "diverged", "travel ended", ...
    advice: str = ""
    method: str = ""
    reason: str = ""  # why that method
    step: float = float("nan")  # largest time step, s
    steps: int = 0
    cpu_seconds: float = float("nan")
    wall_seconds: float = float("nan")
    compile_seconds: float = 0.0  # of the wall time
    warnings: list[str] = field(default_factory=list)  # legitimate, but one should know
    audit: str = ""  # why no energy audit is kept, if that is so
    doubts: list[Doubt] = field(default_factory=list)  # reasons not to trust the run
    mesh: dict[str, str | float] = field(default_factory=dict)  # attributes that tell of its error, if asked for
    window: dict[str, float] = field(default_factory=dict)  # attributes that tell of its width and its error
    on_splines: bool = False  # whether contacts act on splines, each with a kink of its own
    curvature: str = ""  # of bending: `SPLINE`, `MEAN`, or by second differences
    static: dict[str, dict[str, float]] = field(default_factory=dict)  # largest static values of lines, if asked for

    def doubt(self, what: str, cause: str, key: str, remedy: str) -> None:
        """Note a reason not to trust the run, once."""
        if (found := Doubt(what, cause, key, remedy)) not in self.doubts:
            self.doubts.append(found)

    def get_state(self) -> Tree:
        """What has been noted so far, but for the outcome and the time taken."""
        doubts = [asdict(doubt) for doubt in self.doubts]
        kept = {key: getattr(self, key) for key in ("method", "reason", "step", "steps", "audit", "window")}
        return {**kept, "warnings": list(self.warnings), "doubts": doubts}

    def set_state(self, tree: Tree) -> None:
        """Go on from there, whatever has been noted meanwhile."""
        for key in ("method", "reason", "step", "steps", "audit", "window"):
            setattr(self, key, tree[key])
        self.warnings[:] = tree["warnings"]
        self.doubts[:] = [Doubt(**doubt) for doubt in tree["doubts"]]

    def conclude(self) -> None:
        """Name the outcome of a run that nothing has stopped."""
        if self.outcome == "running":
            self.outcome = "doubtful" if self.doubts else "completed"
