"""The first answer of a process: of what others bring along, only what a run asks for is executed."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from ropewalk.importing import SELDOM_USED

LINE = "start: [0, 0], end: [9, 0], mass: 1, axial_stiffness: 100 kN, elements: 6"
FORCE = "kind: force, force: [0, -50], travel: {speed: 10, from: 2}"
RUN = "run: {kind: dynamic, until: 2 ms, every: 1 ms"
SCENARIOS = {
    "rope": f"lines: {{a: {{{LINE}, length: 10}}}}\nloads: {{l: {{{FORCE}, on: a}}}}\n{RUN}}}",
    "bridge": f"""
lines: {{a: {{{LINE}, length: 9, bending_stiffness: 1 MN*m^2}}}}
loads: {{l: {{{FORCE}, on: a}}}}
{RUN}, geometry: linearised}}""",
    "joined ropes": f"""
joints: {{knot: {{}}}}
lines:
  a: {{{LINE}, length: 10, end_support: {{kind: joined, to: knot}}}}
  b: {{start: [18, 0], end: [9, 0], mass: 1, axial_stiffness: 100 kN, elements: 6, length: 10,
    end_support: {{kind: joined, to: knot}}}}
loads: {{l: {{{FORCE}, on: a}}}}
{RUN}}}""",
    "net": f"""
nets: {{a: {{kind: net, corner: [0, 0, 0], sides: [[3, 0, 0], [0, 2, 0]], cells: [3, 2], axial_stiffness: 10 kN,
  mass: 0.2, tension: 100 N, drag: 0.5}}}}
loads: {{l: {{kind: force, on: a, force: [0, 0, -50], travel: {{speed: 1, path: [[0.5, 0.6], [2.5, 1.4]]}}}}}}
{RUN}}}""",
    "overhead line": f"""
overhead_lines:
  a:
    spans: {{count: 2, length: 20 m}}
    contact_wire: {{mass: 1.35, tension: 22 kN, bending_stiffness: 195}}
    messenger_wire: {{mass: 1.08, tension: 16 kN, bending_stiffness: 131}}
    droppers: {{at: [5 m, 10 m, 15 m], stiffness: 200 kN/m}}
    element: 1.25 m
loads: {{l: {{kind: pantograph, on: a, model: simple-ac, travel: {{speed: 30, from: 10 m}}}}}}
{RUN}, geometry: linearised}}""",
}
SPARED = {
    "dask", "pint", "matplotlib", "scipy.optimize", "scipy.interpolate", "scipy.signal", "scipy.fft", "scipy.stats",
    "netCDF4", "unittest", "ropewalk.theory", "ropewalk.linear.series", *SELDOM_USED,
}  # fmt: skip
ANSWER = """
import sys
from importlib.util import _LazyModule
import ropewalk
from ropewalk.scenario import loads
result = ropewalk.simulate(loads(sys.argv[1]))
assert result.attrs["outcome"] in ("completed", "doubtful"), result.attrs
executed = [name for name, module in sys.modules.items() if type(module) is not _LazyModule]
"""


def answer(scenario: str, more: str, **environment: str) -> list[str]:
    """What a process prints that runs a scenario and something more."""
    run = subprocess.run(
        [sys.executable, "-c", ANSWER + more, scenario], capture_output=True, text=True, timeout=600, check=False,
        env={**os.environ, **environment},
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    return run.stdout.split()


@pytest.mark.parametrize("structure", SCENARIOS)
def test_a_run_executes_no_module_that_it_does_not_ask_for(structure: str) -> None:
    """In plain Python, where nothing is compiled."""
    executed = answer(SCENARIOS[structure], "print(*executed)", NUMBA_DISABLE_JIT="1")
    assert "ropewalk.solve" in executed
    assert sorted(SPARED & set(executed)) == []
    heavy = {"scipy.sparse", "scipy.linalg"} & set(executed)
    assert heavy == (set() if structure == "rope" else {"scipy.sparse", "scipy.linalg"})


def test_kept_kernels_are_loaded_without_what_compiles_them() -> None:
    """Neither Numba's own functions nor its counting of references; and those that kernels call are not looked at."""
    answer(SCENARIOS["rope"], "")  # where they are not there
    more = """
from numba.core.runtime.nrt import rtsys
from ropewalk.mechanics import compiled, kernel_parts, moving_contact
assert compiled.compiling.kernels == 0
assert type(rtsys.library) is kernel_parts._Runtime and "_compiled" not in vars(rtsys.library)
kernels = [one for one in vars(moving_contact).values() if isinstance(one, compiled.Kernel)]
assert len(kernels) > 20
assert sum("dispatcher" in vars(one) for one in kernels) <= 2
print(*executed)
"""
    executed = answer(SCENARIOS["rope"], more)
    assert "numba.core.compiler" in executed
    assert sorted({"numba.np.arrayobj", "numba.cpython.unicode"} & set(executed)) == []


def test_declarations_are_prepared_for_those_that_a_scenario_has() -> None:
    more = """
from ropewalk.model import Crowd, Footsteps, Line, MovingForce, OverheadLine, Pantograph, Vehicle, Walker
print(*[one.__name__ for one in (Crowd, Footsteps, MovingForce, Pantograph, Vehicle, Walker)
        if one.__pydantic_complete__])
"""
    assert answer(SCENARIOS["rope"], more, NUMBA_DISABLE_JIT="1") == ["MovingForce"]


def test_what_is_put_off_is_there_when_asked_for() -> None:
    more = """
import numpy.testing, yaml
numpy.testing.assert_allclose(1.0, 1.0)
assert yaml.safe_load("[1, 2]") == [1, 2]
assert "numpy.testing" not in executed
import gc, sys
assert gc.get_freeze_count() == 0 and gc.get_threshold()[0] < 10_000
assert not [one for one in sys.meta_path if type(one).__name__ == "_Later"]
"""
    answer(SCENARIOS["rope"], more, NUMBA_DISABLE_JIT="1")


def test_objects_that_somebody_has_frozen_stay_so() -> None:
    code = "import gc; gc.freeze(); before = gc.get_freeze_count(); import ropewalk; ropewalk.Line; " \
           "assert gc.get_freeze_count() > 0.9 * before > 0"  # fmt: skip
    subprocess.run([sys.executable, "-c", code], check=True)
