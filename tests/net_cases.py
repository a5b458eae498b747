"""Small nets and membranes for tests: laid out, at rest, and their small motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import linalg

from ropewalk.mechanics.chain import Array
from ropewalk.model import Scenario
from ropewalk.simulate import simulate
from ropewalk.system.assembling.membranes import MembraneMesh
from ropewalk.system.elements.structure import Structure
from ropewalk.system.equilibrium.rest import at_rest
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.equilibrium.structures import structure_of
from ropewalk.system.loads.loaded_structure import LoadedStructure

FLAT = {"corner": [0.0, 0.0, 0.0], "sides": [[4.0, 0.0, 0.0], [0.0, 3.0, 0.0]]}


def net(cells=None, **more):
    """A taut net of 4 m x 3 m."""
    return {"kind": "net", **FLAT, "cells": cells, "axial_stiffness": 1e4, "mass": 0.05, "tension": 100.0, **more}


def membrane(cells=None, **more):
    """A taut membrane of 4 m x 3 m."""
    return {"kind": "membrane", **FLAT, "cells": cells, "stiffness": 1e5, "mass": 0.3, "tension": 500.0, **more}


def load(path, kind="force", **more):
    """A load that stands at the beginning of its path on the net, or travels."""
    own = {"force": [0.0, 0.0, -1.0]} if kind == "force" else {}
    travel = {"speed": more.pop("speed", 0.0), "path": path, "at_end": "stay"}
    return {"kind": kind, "on": "net", **own, "travel": travel, **more}


def scenario(sheet, loads=None, run=None, gravity=0.0):
    """A net alone, without weight unless said."""
    run = run or {"kind": "dynamic", "until": 1.0}
    return Scenario.model_validate({"nets": {"net": sheet}, "loads": loads or {}, "run": run, "gravity": gravity})


def moved(sheet, loads, until, *, every=None, gravity=0.0, **run):
    """The result of a motion that has come to its end."""
    asked = {"kind": "dynamic", "until": until, "every": every or until / 20, **run}
    result = simulate(scenario(sheet, loads, asked, gravity))
    assert result.attrs["outcome"] == "completed", result.attrs["advice"]
    return result


def rested(sheet, loads=None, gravity=0.0, kind="equilibrium", **run):
    """The result of slow motion, or rest."""
    result = simulate(scenario(sheet, loads, {"kind": kind, **run}, gravity))
    assert result.attrs["outcome"] == "completed", result.attrs["advice"]
    return result


class Standing(NamedTuple):
    """A net at rest without loads."""

    structure: Structure
    membranes: tuple[MembraneMesh, ...]

    def potential(self, r: Array) -> SystemPotential:
        """Its potential energy about a shape (node, 3)."""
        return SystemPotential(self.structure, LoadedStructure(self.structure, r.T.copy()), 4.0)


def standing(sheet, gravity=0.0) -> tuple[Standing, Array]:
    """A net at rest without loads, and where its nodes are, (node, 3) m."""
    found = structure_of(scenario(sheet, gravity=gravity), 0.0)
    assert found.nets is not None
    structure, r = at_rest(found.structure, np.array([0.0, 0.0, -gravity]), found.near)
    return Standing(structure, found.nets.membranes), r.T.copy()


def small_deflection(laid: Standing, r: Array, force: Array) -> Array:
    """Deflection of all nodes (node, 3) by small forces (node, 3)."""
    potential = laid.potential(r)
    K = potential.stiffness(r.T.ravel())
    return np.asarray(potential.free @ linalg.spsolve(K, potential.free.T @ force.T.ravel())).reshape(3, -1).T


def order(errors) -> Array:
    """Observed orders of errors at sizes that are halved."""
    found = np.log2(np.asarray(errors[:-1]) / np.asarray(errors[1:]))
    print("errors", errors, "orders", found)
    return found
