"""Builder of structures: collects nodes, runs and springs, and lays out Model and State."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.engine.model import Block, fields
from ropewalk.errors import RopewalkError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RunProperties:
    """Properties of a run."""

    link_length: float
    line_mass: float
    axial_stiffness: float
    axial_damping: float = 0.0
    bending_stiffness: float = 0.0
    tension_only: bool = False
    curved: bool = True
    tension: float = 0.0
    taut: bool = False
    continues: bool = False
    """Whether contacts pass from its end to the run that is added next."""


@dataclass(frozen=True)
class ContactProperties:
    """How a body touches a run."""

    stiffness: float = np.inf
    """Of the contact itself, N/m; infinite: as stiff as the run lets it be."""
    leaves: Literal["above", "below"] | None = None
    """Side of the run to which the body can leave it: the contact only pushes."""
    slides: bool = False
    """Without friction, held across the run only; something else moves the body along."""


@dataclass(frozen=True)
class SpringProperties:
    """Properties of a spring between two nodes."""

    stiffness: float
    length: float
    damping: float = 0.0
    tension_only: bool = False


@dataclass(frozen=True)
class FreePlayProperties:
    """Properties of a spring with free play: without force at lengths from `shortest` to `shortest + width`."""

    stiffness: float
    shortest: float
    width: float


@dataclass
class Builder:
    """Collects the parts of a structure in space or in a vertical plane; the last axis is upwards.

    Args:
        axes: 2 or 3.
        gravity: m/s^2.
        watched: nodes whose heights are recorded.
        samples: steps that a call of the core records.
        inner_steps: steps of runs in a step of springs and loads.
    """

    axes: int = 2
    gravity: float = 9.81
    _points: list[Array] = field(default_factory=list)
    _masses: list[Array] = field(default_factory=list)
    _added: list[tuple[int, float]] = field(default_factory=list)
    _pushes: list[tuple[int, Array]] = field(default_factory=list)
    _fixed: dict[int, Array] = field(default_factory=dict)
    _runs: list[tuple[int, int, RunProperties]] = field(default_factory=list)
    _elements: dict[str, list[dict[str, Any]]] = field(default_factory=lambda: defaultdict(list))
    watched: list[int] = field(default_factory=list)
    samples: int = 0
    inner_steps: int = 1
    _contacts: list[dict[str, Any]] = field(default_factory=list)
    _joints: list[tuple[int, int]] = field(default_factory=list)
    _splits: list[tuple[float, float]] = field(default_factory=list)

    def add_node(self, point: ArrayLike, mass: float) -> int:
        """Add a node that is in no run, and return its number.

        Args:
            point: (axis,) m.
            mass: kg.
        """
        return self._add(np.reshape(np.asarray(point, dtype=float), (self.axes, 1)), np.array([mass]))

    def add_run(self, points: ArrayLike, run: RunProperties) -> tuple[int, int]:
        """Add a run with a node at each point; return the numbers of the first and the last one.

        Args:
            points: (axis, node) m.
            run: its properties.
        """
        at = np.array(points, dtype=float)
        masses = np.full(at.shape[1], run.line_mass * run.link_length)
        masses[[0, -1]] *= 0.5
        first = self._add(at, masses)
        self._runs.append((first, at.shape[1] - 1, run))
        return first, first + at.shape[1] - 1

    def _add(self, points: Array, masses: Array) -> int:
        first = sum(each.size for each in self._masses)
        self._points.append(points)
        self._masses.append(masses)
        return first

    def add_mass(self, node: int, mass: float) -> None:
        """Add a point mass, kg, at a node."""
        self._added.append((node, mass))

    def push(self, node: int, force: ArrayLike) -> None:
        """Add a constant force (axis,), N, on a node."""
        self._pushes.append((node, np.asarray(force, dtype=float)))

    def add_spring(self, begin: int, end: int, spring: SpringProperties) -> None:
        """Add a spring between two nodes."""
        self._elements["spring"].append({"begin": begin, "end": end} | asdict(spring))

    def add_sheave(self, node: int, friction: float = 0.0, split: float | None = None) -> None:
        """Let the last two runs be a rope over a sheave, two links longer than they are; it may go on over another one.

        Both have the same properties, and nothing else is added to them but at the other ends of the rope.

        Args:
            node: that the sheave is at; it bears the weight of a link.
            friction: coefficient.
            split: unstrained length from the first of them to the sheave, m; None: a link.
        """
        run = len(self._runs) - 1
        first, _, rope = self._runs[run]
        mass = rope.line_mass * rope.link_length
        for at, part in ((first - 1, 0.5), (first, 0.5), (node, 1.0)):
            self.add_mass(at, part * mass)
        self._splits.append((rope.link_length if split is None else split, mass))
        self._elements["sheave"].append({"run": run - 1, "node": node, "friction": friction})

    def _add_splits(self) -> None:
        """Add the nodes of splits behind all others, as runs of a rope follow each other."""
        for sheave, (split, mass) in zip(self._elements.get("sheave", ()), self._splits, strict=True):
            sheave["split"] = self.add_node([split] + [0.0] * (self.axes - 1), mass)
            self.fix(sheave["split"], axes=range(1, self.axes))

    def add_free_play(self, begin: int, end: int, play: FreePlayProperties) -> None:
        """Add a spring with free play between two nodes."""
        self._elements["play"].append({"begin": begin, "end": end} | asdict(play))

    def add_band(self, begin: int, end: int, springs: int, spring: SpringProperties) -> None:
        """Add equal springs from node `begin + k` to node `end + k`, such as the links between two threads of a net.

        Args:
            begin: first node on one side.
            end: first node on the other side.
            springs: number of springs; the two sides have no node in common.
            spring: properties of each.
        """
        bands = self._elements["band"]
        bands.append({"begin": begin, "end": end, "springs": springs} | asdict(spring))
        bands.sort(key=lambda band: min(band["begin"], band["end"]))  # the order of the runs that they reach first

    def add_collector(self, run: int, body: int, stiffness: float) -> None:
        """Let a node press on a run from below, where it is along the first axis.

        Args:
            run: number of the run, of straight or taut links, in the order they were added.
            body: the node.
            stiffness: of the contact, which does not pull, N/m.
        """
        self._elements["collector"].append({"run": run, "body": body, "stiffness": stiffness})

    def fix(self, *nodes: int, axes: Iterable[int] | None = None) -> None:
        """Prescribe velocities of nodes along some axes; None: all."""
        for node in nodes:
            fixed = self._fixed.setdefault(node, np.zeros(self.axes, dtype=bool))
            fixed[list(range(self.axes) if axes is None else axes)] = True

    def add_force(self, run: int, force: ArrayLike, place: float, speed: float) -> None:
        """Add a constant force that moves along a run at a prescribed speed; beyond the ends of the run it is nothing.

        Args:
            run: number of the run, in the order they were added.
            force: (axis,) N.
            place: unstrained length up to it at the beginning, m.
            speed: rate of that, m/s.
        """
        self._contacts.append({"run": run, "body": -1, "force": force, "place": place, "speed": speed})

    def add_contact(
        self, run: int, body: int, place: float, speed: float, contact: ContactProperties | None = None
    ) -> None:
        """Let a body touch a run at a place that moves with a prescribed speed.

        Args:
            run: number of the run, in the order they were added.
            body: node of the body; it is given its position here, and its velocity in the State.
            place: unstrained length up to it at the beginning, m.
            speed: rate of that, m/s.
            contact: its properties; None: clamped.
        """
        own = contact or ContactProperties()
        self._contacts.append({
            "run": run, "body": body, "place": place, "speed": speed, "compliance": 1.0 / own.stiffness,
            "unilateral": own.leaves is not None, "below": own.leaves == "below", "slides": own.slides,
        })  # fmt: skip

    def join(self, copy: int, original: int) -> None:
        """Make two nodes the same point."""
        self._joints.append((copy, original))

    def build(self, parts: int = 1, step: float = 0.0) -> tuple[Block, Block]:
        """Return Model and State; nothing moves.

        Args:
            parts: number of parts that threads may share, of about as many links each.
            step: of the motion, s. Contacts yield by what moves within it, so that they do not shorten the stable step.

        Raises:
            RopewalkError: a node that is not fixed has no mass.
        """
        self._add_splits()
        points, masses = np.concatenate(self._points, axis=1), np.concatenate(self._masses)
        damped = any(each.axial_damping for *_, each in self._runs)
        damped |= any(each.get("damping", 0.0) > 0.0 for rows in self._elements.values() for each in rows)
        sizes = {"AXES": self.axes, "NODES": masses.size, "VISCOUS": masses.size * damped, "RUNS": len(self._runs),
                 "JOINTS": len(self._joints), "CONTACTS": len(self._contacts),
                 "WATCHED": len(self.watched), "SAMPLES": self.samples, "PARTS": parts}  # fmt: skip
        sizes |= {f"{kind.upper()}S": len(rows) for kind, rows in self._elements.items()}
        model, state = Block("MODEL", sizes), Block("STATE", sizes)
        copies, originals = np.array(self._joints, dtype=np.int64).reshape(-1, 2).T
        for node, mass in self._added:
            masses[node] += mass
        np.add.at(masses, originals, masses[copies])
        masses[copies], points[:, copies] = 0.0, points[:, originals]
        moves = np.full(points.shape, True)
        moves[:, copies] = False
        for node, fixed in self._fixed.items():
            moves[fixed, node] = False
        if (massless := moves & (masses == 0.0)).any():
            raise RopewalkError(f"node {np.nonzero(massless)[1][0]} has no mass; give it one, or hold it")
        mobility = np.divide(1.0, masses, where=moves, out=np.zeros(points.shape))
        model.set(mobility=mobility, joint_copy=copies, joint_original=originals)
        model.set(watched=np.array(self.watched, dtype=np.int64), inner_steps=[self.inner_steps])
        ends = self._end_masses(masses.size)
        np.add.at(ends, originals, ends[copies])
        ends[copies] = 0.0
        model.weight[-1] = -self.gravity * (masses + ends)
        for node, force in self._pushes:
            model.weight[:, node] += force
        state.position[:] = points
        self._set_contacts(model, state, step)
        ends = np.cumsum([links for _, links, _ in self._runs])
        model.part_run[1:] = np.searchsorted(ends, np.arange(1, parts) / parts * ends[-1:]) if parts > 1 else ()
        runs = [{"run_first": first, "run_links": links} | asdict(run) for first, links, run in self._runs]
        names = {each.name for each in fields()}
        for name in runs[0] if runs else ():
            block = state if name in state.names() else model
            block.set(**{name if name in names else f"run_{name}": [row[name] for row in runs]})
        for kind, rows in self._elements.items():
            model.set(**{f"{kind}_{name}": [row[name] for row in rows] for name in rows[0]})
        model.weight[:, model.sheave_split] = 0.0
        model.sheave_weight[-1] = -self.gravity * model.line_mass[model.sheave_run]
        return model, state

    def _end_masses(self, nodes: int) -> Array:
        """Return what weighs more or less at nodes (node,) than their masses, kg.

        The second difference of a curved run is zero at its ends, which are hinged, but a load curves the line there.
        So a twelfth of the load on a link acts a link further in: by the forces of the links when nodes are on the
        exact line. Else lines hang right to the second order only, as do ropes over sheaves, whose nodes change places.
        """
        extra = np.zeros(nodes)
        passes = {row["run"] + k for row in self._elements.get("sheave", ()) for k in (0, 1)}
        for number, (first, links, run) in enumerate(self._runs):
            if number in passes:
                continue
            parts = (1.0 / 18.0, 1.0 / 72.0) if run.bending_stiffness else (1.0 / 6.0, -1.0 / 24.0)
            near, far = (
                part * run.line_mass * run.link_length * (run.curved and not run.taut and links > 1) for part in parts
            )
            for end, inwards in ((first, 1), (first + links, -1)):
                extra[end] -= near + far
                extra[end + inwards] += near
                extra[end + 2 * inwards * (links > 1)] += far
        return extra

    def _set_contacts(self, model: Block, state: Block, step: float) -> None:
        state.contact_bent[:] = -1.0
        for k, contact in enumerate(self._contacts):
            for name, value in contact.items():
                getattr(state if name in ("place", "speed") else model, f"contact_{name}")[..., k] = value
            if (body := contact["body"]) >= 0:
                run = self._runs[contact["run"]][2]
                mobility = 1.0 / (run.line_mass * run.link_length) + model.mobility[:, body].max()
                model.contact_compliance[k] += 0.5 * step**2 * mobility
