"""A structure that the core has checked: what can be computed of it."""

from __future__ import annotations

import ctypes
from threading import Thread
from time import perf_counter
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.engine.library import VARIANTS, library, variants
from ropewalk.engine.model import PARTS, Block, dimensions, fields
from ropewalk.errors import RopewalkError

Array = NDArray[np.float64]
Outcome = Literal["done", "stopped", "diverged", "ended"]
CALL = 0.03
"""Time of a call of the core, s: after it signals are noticed."""


class Advance(NamedTuple):
    """Steps that were taken, and how they ended."""

    steps: int
    outcome: Outcome


class Potentials(NamedTuple):
    """Potential energies of a structure, J."""

    elastic: float
    """Of all elements; contacts with the potential of the forces that are given there."""
    weight: float


class SheaveForces(NamedTuple):
    """Of each sheave: tensions before and behind it, N, angle of the turn, and the most that friction bears, N."""

    before: Array
    behind: Array
    angle: Array
    most: Array


class ContactForces(NamedTuple):
    """Contacts at a state."""

    force: Array
    """(axis, contact) of the load on its run, N."""
    point: Array
    """(axis, contact) where it acts, m; zero where a contact is off its run."""
    driving: Array
    """(contact,) force that moves a contact along its run: change of all energy with its place, N."""


class TangentMatrices(NamedTuple):
    """Forces (axis, node) and their derivatives (axis * nodes + node, the same) at a state."""

    forces: Array
    stiffness: sparse.csc_matrix
    damping: sparse.csc_matrix


class Bound:
    """Model and State that the core has checked, with a Workspace of their own."""

    def __init__(self, model: Block, state: Block) -> None:
        """Check every number and index once. From now on the Model and indices of the State cannot be changed.

        Raises:
            RopewalkError: naming the array and the entry that is wrong.
        """
        self.model, self.state, self.work = model, state, Block("WORK", model.sizes)
        self.stop = ctypes.c_int32(0)
        blocks = (model, state, self.work)
        self._bases = (ctypes.c_void_p * 3)(*(block.memory.ctypes.data for block in blocks))
        sizes = (ctypes.c_int64 * 3)(*(block.memory.size for block in blocks))
        finding = (ctypes.c_int64 * 3)()
        if library().rw_bind(self._bases, sizes, finding):
            raise RopewalkError(_message(model, state, *finding))
        for block in (model, self.work):
            block.freeze()
        state.freeze(indices=True)
        self._speed = 0.0  # steps per second

    def record(self, steps: int, dt: float, variant: str | None = None) -> tuple[Array, Array]:
        """Take steps, and return forces of collectors in N and heights of watched nodes in m before each.

        Args:
            steps: number of steps.
            dt: step, s.
            variant: instruction set; None: the best one of this processor.

        Raises:
            RopewalkError: the motion has ended before, or the structure records nothing.
        """
        if not self.model.sizes["SAMPLES"]:
            raise RopewalkError("this structure records nothing; give its Builder samples")
        forces, heights, work, taken, done = list[Array](), list[Array](), self.work, 0, ctypes.c_int64()
        while taken < steps:
            count = min(steps - taken, self.model.sizes["SAMPLES"])
            outcome = self._call(0, 1, count, dt, variant, done)
            if outcome:
                raise RopewalkError(f"the motion has {get_args(Outcome)[outcome]} after {taken + done.value} steps")
            forces.append(work.recorded_force[:, :count].copy())
            heights.append(work.recorded_height[:, :count].copy())
            taken += count
        return np.concatenate(forces, axis=1), np.concatenate(heights, axis=1)

    def advance(self, steps: int, dt: float, variant: str | None = None, threads: int = 1) -> Advance:
        """Take steps of Verlet's method. Neither their division into calls nor threads make a difference to any bit.

        Args:
            steps: number of steps.
            dt: step, s.
            variant: instruction set; None: the best one of this processor.
            threads: 1, or as many as the structure has parts; they wait for each other without rest, so each needs a
                processor of its own.

        Raises:
            RopewalkError: this processor has no such instruction set, or the structure not as many parts.
        """
        if threads not in (1, parts := self.model.sizes["PARTS"]):
            raise RopewalkError(f"threads: {threads} for {parts} parts; use one, or one for each part")
        done, taken = ctypes.c_int64(), 0
        while taken < steps:
            begin = perf_counter()
            count = min(steps - taken, max(16, int(CALL * self._speed)))
            counts = [done, *(ctypes.c_int64() for _ in range(1, threads))]
            calls = [(k, threads, count, dt, variant, each) for k, each in enumerate(counts)]
            others = [Thread(target=self._call, args=call) for call in calls[1:]]
            for each in others:
                each.start()
            outcome = self._call(*calls[0])
            for each in others:
                each.join()
            self._speed = done.value / max(perf_counter() - begin, 1e-9)
            taken += done.value
            if outcome:
                return Advance(taken, get_args(Outcome)[outcome])
        return Advance(taken, "done")

    def _call(self, thread: int, threads: int, steps: int, dt: float, variant: str | None, done: ctypes.c_int64) -> int:
        """Call the core for one of some threads; return the number of the outcome."""
        number, stop = VARIANTS.index(variant or variants()[-1]), ctypes.addressof(self.stop)
        outcome = library().rw_advance(number, self._bases, thread, threads, steps, dt, stop, ctypes.addressof(done))
        if outcome < 0:
            raise RopewalkError(f"the core has no variant {variant} for this processor; use {', '.join(variants())}")
        return int(outcome)

    def forces(self, velocities: Array | None = None) -> Array:
        """Return the forces (axis, node) at the positions of the State, N, weights included.

        Args:
            velocities: (axis, node) m/s; None: as if nothing moved.
        """
        rates, forces = self._rates(velocities), np.zeros(self.state.position.shape)
        library().rw_forces(self._bases, rates.ctypes.data, forces.ctypes.data)
        return forces

    def velocities(self) -> Array:
        """Return the velocities (axis, node) at the instant of the positions, m/s."""
        if self.model.inner_steps[0] > 1:
            raise RopewalkError("inner steps keep velocities at other instants than positions; leave them out")
        lag, v = self.state.lag[0], self.state.velocity
        rates = self.state.predicted if self.model.sizes["VISCOUS"] else v
        gains = self.model.mobility * self._joined(self.forces(rates))
        now: Array = v + lag * gains
        now[:, self.model.joint_copy] = now[:, self.model.joint_original]
        return now

    def potentials(self) -> Potentials:
        """Return the potential energies at the positions of the State."""
        found = np.zeros(2)
        library().rw_energies(self._bases, found.ctypes.data)
        return Potentials(*found.tolist())

    def sheaves(self) -> SheaveForces:
        """Return what ropes do at sheaves at the positions of the State."""
        found = np.zeros((4, self.model.sizes["SHEAVES"]))
        library().rw_sheaves(self._bases, found.ctypes.data)
        return SheaveForces(*found)

    def pass_nodes(self) -> int:
        """Let nodes that are close to a sheave pass it, as a step does; return how many did."""
        return int(library().rw_pass(self._bases))

    def contacts(self) -> ContactForces:
        """Return the forces of contacts at the positions of the State."""
        axes, count = self.model.sizes["AXES"], self.model.sizes["CONTACTS"]
        values = np.zeros((2 * axes + 1, count))
        library().rw_contacts(self._bases, values.ctypes.data)
        return ContactForces(values[:axes], values[axes : 2 * axes], values[2 * axes])

    def kinetic_energy(self) -> float:
        """Return the kinetic energy at the instant of the positions, J."""
        moves = self.model.mobility > 0.0
        return float(0.5 * np.sum(self.velocities()[moves] ** 2 / self.model.mobility[moves]))

    def linearise(self, velocities: Array | None = None) -> TangentMatrices:
        """Return forces, K = -df/dr and C = -df/dv at the positions of the State.

        Args:
            velocities: (axis, node) m/s; None: as if nothing moved.
        """
        rates, forces = self._rates(velocities), np.zeros(self.state.position.shape)
        count = library().rw_entries(self._bases)
        rows, columns = np.zeros((2, count), dtype=np.int64)
        K, C = np.zeros((2, count))
        arrays = (rates, forces, rows, columns, K, C)
        library().rw_linearise(self._bases, *(each.ctypes.data for each in arrays))
        matrices = (sparse.csc_matrix((each, (rows, columns)), shape=(forces.size, forces.size)) for each in (K, C))
        return TangentMatrices(forces, *matrices)

    def unknowns(self) -> sparse.csc_matrix:
        """Return what free coordinates move: (axis * nodes + node, coordinate), 1 where they are the same."""
        size = self.model.mobility.size
        original = np.arange(size).reshape(self.model.mobility.shape)
        original[:, self.model.joint_copy] = original[:, self.model.joint_original]
        free = np.flatnonzero(self.model.mobility)
        each = sparse.csc_matrix((np.ones(size), (np.arange(size), original.ravel())), shape=(size, size))
        return each[:, free]

    def _joined(self, forces: Array) -> Array:
        sums = forces.copy()
        for row, force in zip(sums, forces, strict=True):
            np.add.at(row, self.model.joint_original, force[self.model.joint_copy])
        return sums

    def _rates(self, velocities: Array | None) -> Array:
        if velocities is None:
            return np.zeros(self.state.position.shape)
        return np.ascontiguousarray(velocities, dtype=np.float64)


_FAULTS = {
    1: "this is no block of this core; lay it out with Block",
    2: "Model, State and Workspace are of different structures",
    3: "is {value}; it holds {values}",
    4: "is {kind} {value}; {kind}s are 0 to {last}",
    5: "is {value}; a run has at least one link, ends at node {last} at most and begins behind the one before it",
    6: "is {value}; a copy is no inner node of a run and no original, is named once, has no mobility, no weight, "
    "and the position and velocity of its original",
    7: "is node {value}, which is the first node of the spring, too",
    8: "is {value}; a band has at least one spring, its sides end at node {last} at most and have no node in common, "
    "and bands are in the order of their lowest nodes",
    9: "is {value}; the first part begins at run 0, others at ascending runs",
    10: "is {value}; a structure with dampers needs VISCOUS = NODES",
    11: "is {value}; nodes inside a taut run move along the last axis only, hold them along the others",
    12: "is {value}; a rope over a sheave is two runs that follow each other, with the same properties and nodes that "
    "are all the same, to which nothing else is attached; the sheave is at no copy, and its split is a node of its "
    "own, which moves along its first axis, between 0 and two links",
}
_ADMITTED = {
    "FINITE": "finite numbers", "NOT_NEGATIVE": "finite numbers that are not negative", "POSITIVE": "positive numbers",
    "FLAG": "0 or 1", "FEW": "whole numbers from 0 to 1000", "COUNT": "whole numbers that are not negative",
    "NODE": "nodes", "RUN": "runs", "OPTION": "nodes, or -1",
}  # fmt: skip


def _message(model: Block, state: Block, fault: int, number: int, entry: int) -> str:
    """Return the sentence for what rw_bind has found."""
    if fault == 1:
        return f"{PARTS[number]}: {_FAULTS[1]}"
    if fault == 2:
        return f"{list(dimensions())[number]}: {_FAULTS[2]}"
    field = fields()[number]
    array: NDArray[Any] = getattr(model if field.part == "MODEL" else state, field.name)
    place = ", ".join(map(str, np.unravel_index(entry, array.shape)))
    kind = "run" if field.values == "RUN" else "node"
    last = model.sizes[f"{kind.upper()}S"] - 1
    return f"{field.name}[{place}] " + _FAULTS[fault].format(
        value=array.flat[entry], values=_ADMITTED[field.values], kind=kind, last=last
    )
