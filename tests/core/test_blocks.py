"""Blocks of the core: views, checks of every number and index, and refusals that name array and entry."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from core_structures import STRUCTURES, bridge, net, rope, taut_lines
from ropewalk.engine.bound import Bound
from ropewalk.engine.library import library
from ropewalk.engine.model import Block, dimensions, fields
from ropewalk.errors import RopewalkError

SPOILT: list[tuple[str, Any, float, str]] = [
    ("mobility", (1, 7), -1.0, "mobility[1, 7] is -1.0; it holds finite numbers that are not negative"),
    ("weight", (0, 3), np.nan, "weight[0, 3] is nan; it holds finite numbers"),
    ("weight", (1, 50), np.inf, "weight[1, 50] is inf"),
    ("link_length", 1, 0.0, "link_length[1] is 0.0; it holds positive numbers"),
    ("axial_stiffness", 2, -np.inf, "axial_stiffness[2] is -inf"),
    ("run_taut", 2, 2, "run_taut[2] is 2; it holds 0 or 1"),
    ("run_tension", 0, -1.0, "run_tension[0] is -1.0"),
    ("axial_damping", 0, 1.0, "axial_damping[0] is 1.0; a structure with dampers needs VISCOUS = NODES"),
    ("run_first", 0, -1, "run_first[0] is node -1; nodes are 0 to 50"),
    ("run_first", 1, 51, "run_first[1] is node 51; nodes are 0 to 50"),
    ("run_first", 1, 24, "run_first[1] is 24; a run has at least one link"),
    ("run_links", 0, 0, "run_links[0] is 0; a run has at least one link, ends at node 50"),
    ("run_links", 2, 13, "run_links[2] is 13; a run has at least one link"),
    ("run_links", 2, 2**62, "run_links[2] is 4611686018427387904; it holds whole numbers"),
    ("run_curved", 0, 2, "run_curved[0] is 2; it holds 0 or 1"),
    ("inner_steps", 0, 1001, "inner_steps[0] is 1001; it holds whole numbers from 0 to 1000"),
    ("spring_begin", 6, 2**40, "spring_begin[6] is node 1099511627776; nodes are 0 to 50"),
    ("spring_end", 0, 3, "spring_end[0] is node 3, which is the first node of the spring, too"),
    ("spring_length", 3, 0.0, "spring_length[3] is 0.0; it holds positive numbers"),
    ("spring_damping", 3, 1.0, "spring_damping[3] is 1.0; a structure with dampers"),
    ("joint_copy", 0, 30, "joint_copy[0] is 30; a copy is no inner node of a run"),
    ("joint_original", 0, 38, "joint_original[0] is 38; a copy is no inner node of a run and no original"),
    ("joint_original", 0, 36, "joint_original[0] is 36; a copy"),
    ("mobility", (0, 38), 1.0, "mobility[0, 38] is 1.0; a copy"),
    ("weight", (1, 38), 1.0, "weight[1, 38] is 1.0; a copy"),
    ("position", (1, 38), 5.0, "position[1, 38] is 5.0; a copy"),
    ("velocity", (0, 38), 5.0, "velocity[0, 38] is 5.0; a copy"),
    ("position", (0, 50), np.nan, "position[0, 50] is nan; it holds finite numbers"),
    ("lag", 0, -1.0, "lag[0] is -1.0; it holds finite numbers that are not negative"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "entry", "value", "message"), SPOILT)
def test_spoilt_entry_is_refused_by_name(name: str, entry: Any, value: float, message: str) -> None:
    sound = bridge()
    model, state = sound.model.copy(), sound.state.copy()
    Bound(model.copy(), state.copy())
    getattr(model if name in {each.name for each in fields() if each.part == "MODEL"} else state, name)[entry] = value
    with pytest.raises(RopewalkError, match=re.escape(message)):
        Bound(model, state)


def test_nodes_inside_taut_runs_move_along_the_last_axis_only() -> None:
    for name, message in (("mobility", r"mobility\[1, 20\] is 0.5; nodes inside a taut run"), ("velocity", "velocity")):
        sound = taut_lines(3)
        model, state = sound.model.copy(), sound.state.copy()
        getattr(model if name == "mobility" else state, name)[1, 20] = 0.5
        with pytest.raises(RopewalkError, match=message):
            Bound(model, state)


@pytest.mark.parametrize(("name", "entry", "value", "message"), [
    ("band_springs", 1, 0, "band_springs[1] is 0; a band has at least one spring, its sides end at node 29"),
    ("band_springs", 3, 6, "band_springs[3] is 6; a band"), ("band_end", 2, 13, "band_springs[2] is 4; a band"),
    ("band_springs", 1, 7, "band_springs[1] is 7; a band"), ("band_begin", 3, 5, "band_begin[3] is 5; a band"),
    ("band_end", 3, 30, "band_end[3] is node 30; nodes are 0 to 29"),
    ("part_run", 0, 1, "part_run[0] is 1; the first part begins at run 0, others at ascending runs"),
    ("band_damping", 1, 2.0, "band_damping[1] is 2.0; a structure with dampers needs VISCOUS = NODES"),
])  # fmt: skip
def test_spoilt_band_is_refused_by_name(name: str, entry: int, value: float, message: str) -> None:
    sound = net()
    model = sound.model.copy()
    getattr(model, name)[entry] = value
    with pytest.raises(RopewalkError, match=re.escape(message)):
        Bound(model, sound.state)


def test_every_field_is_checked_for_numbers() -> None:
    kinds = [make() for make in STRUCTURES.values()]
    for field in fields():
        if field.part == "WORK":
            continue
        sound = next(each for each in kinds if all(each.model.sizes[name] for name in (field.rows, field.columns)))
        model, state = sound.model.copy(), sound.state.copy()
        view = getattr(model if field.part == "MODEL" else state, field.name)
        view.flat[view.size - 1] = np.nan if field.kind == "double" else -2
        with pytest.raises(RopewalkError, match=rf"^{field.name}\["):
            Bound(model, state)


def test_wrong_shape_and_kind_of_numbers_are_refused() -> None:
    model = bridge().model.copy()
    with pytest.raises(RopewalkError, match=r"mobility: shape \(51,\); the structure has \(2, 51\)"):
        model.set(mobility=np.ones(51))
    with pytest.raises(RopewalkError, match="joint_copy: numbers of the type float64; it holds int64"):
        model.set(joint_copy=np.ones(1))


@pytest.mark.parametrize("sizes", [{"AXES": 2}, {"AXES": 4, "NODES": 3}, {"AXES": 2, "NODES": 3, "VISCOUS": 2},
                                   {"AXES": 2, "NODES": -1}, {"AXES": 2, "NODES": 3, "RUNS": 2**40}])  # fmt: skip
def test_sizes_of_no_structure_are_refused(sizes: dict[str, int]) -> None:
    with pytest.raises(RopewalkError, match="a structure needs AXES = 2 or 3"):
        Block("MODEL", sizes)


def test_blocks_of_different_structures_or_parts_are_refused() -> None:
    a, b = rope(), rope(links=41)
    with pytest.raises(RopewalkError, match="NODES: Model, State and Workspace are of different structures"):
        Bound(a.model, b.state)
    with pytest.raises(RopewalkError, match="MODEL: this is no block of this core"):
        Bound(a.state, a.state)


@pytest.mark.parametrize("word", range(6))
def test_spoilt_header_is_refused(word: int) -> None:
    sound = rope()
    model = sound.model.copy()
    model.memory.view(np.int64)[word if word != 3 else 4] += 1  # 3: whether a Workspace is bound
    with pytest.raises(RopewalkError, match="no block of this core"):
        Bound(model, sound.state.copy())


def test_nothing_is_computed_with_blocks_that_are_not_bound() -> None:
    bound = rope()
    bound.work.memory.flags.writeable = True
    bound.work.memory.view(np.int64)[3] = 0
    assert library().rw_entries(bound._bases) == -1


def test_neither_a_bound_model_nor_indices_of_a_state_can_be_changed() -> None:
    bound = rope()
    bound.state.position[0, 1] = 2.0
    for array in (bound.model.mobility, bound.state.run_first):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 99


def test_rows_are_aligned_and_the_table_is_complete() -> None:
    block = bridge(3).state
    assert block.memory.ctypes.data % 64 == 0
    assert all(getattr(block, each.name).ctypes.data % 64 == 0 for each in fields() if each.part == "STATE")
    assert list(dimensions())[:3] == ["ONE", "AXES", "NODES"]
    assert all(each.meaning and each.rows in dimensions() and each.columns in dimensions() for each in fields())
