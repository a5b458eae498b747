"""Kernels of the system are compiled for plain structures and for all others, not for each set of what is there."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.system.elements.structure import Buffers, Structure
from ropewalk.system.elements.ties import Point, Tie, ties_of
from ropewalk.system.equilibrium.structures import structure_of

ROPE = {"start": (0, 0), "end": (20, 0), "length": 20.0, "mass": 2.0, "axial_stiffness": 1e6, "elements": 8}
BEAM = {**ROPE, "bending_stiffness": 1e4, "end_support": {"kind": "guided", "along": [1, 0]}}
NET = {
    "kind": "net", "corner": [0, 0, 2], "sides": [[2, 0, 0], [0, 2, 0]], "cells": [2, 2], "mesh": 0.1,
    "axial_stiffness": 1e4, "mass": 0.02, "tension": 40.0,
}  # fmt: skip
MORE: dict[str, dict[str, Any]] = {
    "saddles": {"lines": {"rope": {**ROPE, "saddles": {"tower": {"at": [10, 3], "radius": 2.0}}}}},
    "sheaves": {"lines": {"rope": {**ROPE, "length": 21.3, "sheaves": {"wheel": {"at": [8, 3]}}}}},
    "segments": {"lines": {"beam": {**BEAM, "segments": {"weak": {"from": 8.0, "to": 13.0, "mass": 1.0}}}}},
    "ties": {"lines": {"rope": ROPE}},
    "taut": {
        "lines": {"rope": {**{k: ROPE[k] for k in ROPE if k != "axial_stiffness"}, "length": 21.0,
                           "law": {"kind": "inextensible"}}}
    },
    "surfaces": {"nets": {"net": NET}},
}  # fmt: skip


def made(name: str) -> tuple[Structure, Buffers]:
    asked = Scenario.model_validate({"run": {"kind": "equilibrium"}, **MORE.get(name, {"lines": {"rope": ROPE}})})
    structure = structure_of(asked, 0.0).structure
    if name == "ties":  # which are those of overhead lines and tracks
        structure = structure._replace(ties=ties_of([Tie(Point(0, 8, 2.5, 3.0, 1e4, 0.0), np.array([7.5, 1.0]))], 2))
    return structure, Buffers.of(structure, structure.nodes.force.shape[0])


def kinds(structure: Structure, buffers: Buffers) -> Any:
    """What a kernel that is handed them is compiled for."""
    return numba.typeof((structure.for_kernels, buffers.for_kernels(structure)))


def test_there_are_two_kinds_of_structures_for_kernels() -> None:
    """Each has what it is named after, and all of them one type; plain ones are handed on as they are."""
    found = {}
    for name in MORE:
        structure, buffers = made(name)
        assert getattr(structure, name) is not None, name
        found[name] = kinds(structure, buffers)
    one = next(iter(found.values()))
    assert [name for name, kind in found.items() if kind != one] == []
    structure, buffers = made("nothing")
    assert structure.for_kernels is structure
    assert buffers.for_kernels(structure) is buffers
    assert kinds(structure, buffers) != one


@pytest.mark.parametrize("name", MORE)
def test_what_is_there_is_handed_on_itself(name: str) -> None:
    """So that what changes in motion changes in the structure; empty arrays are all that is added."""
    structure, buffers = made(name)
    handed, room = structure.for_kernels, buffers.for_kernels(structure)
    for group in ("surfaces", "sheaves", "ties", "saddles", "segments"):
        own = getattr(structure, group)
        if own is not None:
            assert getattr(handed, group) is own
        else:
            first = getattr(handed, group)[0]
            assert (first.area if group == "surfaces" else first).size == 0
    assert room.tight is buffers.tight if name == "taut" else room.tight is not None and room.tight.h.size == 0
