"""A scenario in, a result or a spectrum out."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.capabilities import (
    SUPERPOSED,
    SYSTEM,
    WIRES,
    check_spectrum,
    engine_of,
    is_system_linearised,
)
from ropewalk.checkpoint import Tree
from ropewalk.errors import Problem, RopewalkError, ScenarioError
from ropewalk.importing import lightly
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.compiled import compiling, is_kept
from ropewalk.model.capabilities import refusal
from ropewalk.model.consistency import LARGEST_IN_MEMORY, too_large
from ropewalk.model.crowd import Crowd
from ropewalk.model.load import GivenForces, assembled
from ropewalk.model.magnitudes import check_steps, not_computable
from ropewalk.model.mesh import is_asked_for
from ropewalk.model.people import with_people
from ropewalk.model.run import Dynamic, Equilibrium, Linear, Quasistatic, every_of
from ropewalk.model.scenario import Scenario
from ropewalk.model.train import Train
from ropewalk.results.files import open_result
from ropewalk.results.frame import SPLINE, Frame, Layout, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.running import Known, MotionEngine, Run, StaticEngine, TimeHistory, followed
from ropewalk.solve.load_schedule import horizon
from ropewalk.start_positions import located

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.results.recorder import Recorder
    from ropewalk.results.spectrum import Spectrum


Seen = Callable[[Layout, Frames, RunInfo], None]
"""What looks at a run while it continues."""


def simulate(
    scenario: Scenario, *, file: Path | None = None, overwrite: bool = False,
    progress: Callable[[float], None] | None = None, seen: Seen | None = None,
    begun: Callable[[Run, RunInfo], None] | None = None, opened: Callable[[Path], xr.Dataset] = open_result,
) -> xr.Dataset:  # fmt: skip
    """Run a scenario.

    Args:
        scenario: structure, loads and analysis.
        file: NetCDF file to write while running; None keeps the result in memory. One that is there is replaced with
            the first frame, if it holds a result of the same scenario, as it is or as it was.
        overwrite: whether the result of another scenario is replaced, too.
        progress: called with the part that is done, 0 to 1.
        seen: called with the layout, with frames as they come and with how the run goes, to look at it meanwhile.
        begun: called with a run that is ready to begin and with its estimated steps and time; not with those of several
            meshes.
        opened: what opens the file at the end.

    Returns:
        The result; its attributes hold the outcome, advice, the method and why it was chosen. A run that breaks
        down or is interrupted returns what it has.

    Raises:
        ScenarioError: the run would replace the result that it starts from.
        RopewalkError: the scenario has no rest shape to start from, or the file cannot be written.
    """
    from ropewalk.results.files import check_own, check_target
    from ropewalk.results.recorder import Recorder

    if file is not None:
        check_target(file)  # before anything is computed
        _keep_apart(scenario, file)
        if not overwrite:
            check_own(file, scenario)
    else:
        _keep_small(scenario)
    watch = Clock()

    def recorded(asked: Scenario, run: Run, run_info: RunInfo) -> xr.Dataset:
        with Recorder(run.layout, asked, run_info, file, run=run, opened=opened) as recorder:
            return record(run, recorder, run_info, watch, progress, seen)

    if is_asked_for(scenario.parts):
        from ropewalk.meshes import choosing  # lazy: most runs are on one mesh

        return choosing.result_of(scenario, run_of, recorded)
    run_info = RunInfo()
    if scenario.outputs.impact:
        from ropewalk.impact import static_part  # lazy: most runs do not ask for it

        run_info.static = static_part(scenario, simulate)
    run = run_of(scenario, run_info)
    if begun is not None:
        begun(run, run_info)
    return recorded(scenario, run, run_info)


class Clock:
    """How long a run takes, on the wall, of the processor, and to compile, what it took before it was taken up again
    included."""

    def __init__(self, wall: float = 0.0, cpu: float = 0.0, compiled: float = 0.0) -> None:
        self._wall, self._cpu = clock.perf_counter() - wall, clock.process_time() - cpu
        self._compiled = compiling.seconds - compiled
        self._due = 0.0

    def is_due(self) -> bool:
        """Whether a tenth of a second has gone by since it was so: to ask for the processor's time may cost more."""
        now = clock.perf_counter()
        due = now >= self._due
        if due:
            self._due = now + 0.1
        return due

    def note(self, run_info: RunInfo) -> None:
        """Write down the seconds so far."""
        run_info.wall_seconds, run_info.cpu_seconds = (
            clock.perf_counter() - self._wall,
            clock.process_time() - self._cpu,
        )
        run_info.compile_seconds = compiling.seconds - self._compiled


def record(
    run: Run, recorder: Recorder, run_info: RunInfo, watch: Clock, progress: Callable[[float], None] | None,
    seen: Seen | None = None,
) -> xr.Dataset:  # fmt: skip
    """Let a run go to its end, and record all that is still to come of it."""
    try:
        for frames in run.blocks():
            recorder.extend(frames)
            if watch.is_due():
                watch.note(run_info)
            if seen is not None:
                seen(run.layout, frames, run_info)
            if progress is not None:
                progress(min(recorder.frames / run.total, 1.0))
    except KeyboardInterrupt:
        if not recorder.frames:
            raise
        run_info.outcome, run_info.advice = "interrupted", "the result holds everything up to the interruption"
    watch.note(run_info)
    if isinstance(run, TimeHistory) and run.total > 1:  # steps end at output instants
        run_info.step = min(run_info.step, float(np.diff(run.engine.times).max()))
    return recorder.close()


def _keep_apart(scenario: Scenario, file: Path) -> None:
    """Refuse to write into the result that a motion starts from."""
    run = scenario.run
    if not (isinstance(run, Dynamic) and run.start.file and file.exists()):
        return
    if Path(run.start.file).exists() and file.samefile(run.start.file):
        remedy = "write the new result to another file, or start from a copy"
        raise ScenarioError([Problem("run.start.file", "is also the output file", str(file), remedy)])


def _keep_small(scenario: Scenario) -> None:
    """Refuse to keep more in memory than fits."""
    for found in too_large(scenario.parts, LARGEST_IN_MEMORY, "write to a file (file=...), "):
        raise refusal(found)


def must_compile(scenario: Scenario) -> str:
    """How long compiling takes that has to be done first, in words; empty if the kernels of the run are there.

    The kernel of a motion is compiled once more for bodies, its last argument.
    """
    if not isinstance(scenario.run, Dynamic):
        return ""
    engine = engine_of(scenario)
    if engine is SYSTEM:
        from ropewalk.system.dynamics.intervals import advance as of_system

        return "" if is_kept(of_system) else "about half a minute"
    if engine is WIRES:
        from ropewalk.wires import large, small

        kernel = large.advance if scenario.run.geometry == "nonlinear" else small.advance
        return "" if is_kept(kernel) else "about a quarter of a minute"
    from ropewalk.solve.stops import advance

    bodied = any(not isinstance(load, GivenForces) for load in scenario.loads.values())
    if is_kept(advance, lambda kinds: hasattr(kinds[-1], "types") == bodied):
        return ""
    return "about a minute" if bodied else "about half a minute"


def iterate(scenario: Scenario, run_info: RunInfo) -> tuple[Layout, Iterator[Frame], int]:
    """The frames of a run, one after the other, with their layout and their number; `account` is filled in."""
    run = run_of(scenario, run_info)
    return run.layout, (frame for frames in run.blocks() for frame in frames), run.total


@lightly()
def run_of(scenario: Scenario, run_info: RunInfo, times: Array | None = None, past: Tree | None = None) -> Run:
    """A scenario ready to run.

    Args:
        scenario: structure, loads and analysis.
        run_info: filled in.
        times: of a motion, its output instants in s (default: those that it asks for).
        past: what such a run has given as its state, to go on from there.

    Raises:
        RopewalkError: it cannot be computed, or needs more memory than there is.
    """
    try:
        return _ready(scenario, run_info, times, past)
    except (ArithmeticError, ValueError) as error:
        refused = not_computable(scenario.model_dump(exclude_unset=True), error)
        if isinstance(error, ScenarioError) or refused is None:
            raise
        raise refused from error
    except MemoryError as error:
        remedy = "lower elements, or check lengths and counts for wrong units"
        raise RopewalkError(f"the run needs more memory than there is ({error}); {remedy}") from error


def _ready(scenario: Scenario, run_info: RunInfo, times: Array | None, past: Tree | None) -> Run:
    run_info.warnings += sample_warnings(scenario)
    scenario = _formed(scenario)
    run = scenario.run
    run_info.on_splines = engine_of(scenario) in (SYSTEM, SUPERPOSED)
    if scenario.has_bending_stiffness and run_info.on_splines:
        run_info.curvature = SPLINE
    if isinstance(run, Dynamic):
        times = output_times(run) if times is None else times
        motion = _motion(scenario, run, run_info, times, past)
        check_steps(float(times[-1]), run_info.step)
        return TimeHistory(motion, run_info, past)
    if isinstance(run, Linear):
        return _linear(scenario, run, run_info)
    still = _still(scenario, run_info)
    if isinstance(run, Quasistatic):
        return Known.one_by_one(still.layout, followed(still.slowly(run.positions, run.turn), run_info), run.positions)
    assert isinstance(run, Equilibrium)
    return Known.one_by_one(still.layout, iter([still.loaded()]), 1)


def _formed(scenario: Scenario) -> Scenario:
    """Return a scenario with hangers as lines, crowds as people, trains as vehicles, and starts along lines."""
    if any(isinstance(load, Crowd | Train) for load in scenario.loads.values()):
        loads = assembled(scenario.loads, scenario.run)
        loads = with_people(loads, scenario.lines, scenario.overhead_lines, scenario.nets)
        scenario = scenario.model_copy(update={"loads": loads})
    if scenario.hangers:
        from ropewalk.system.equilibrium.form_finding import formed  # lazy: most runs do not need it

        scenario = formed(scenario)
    return located(scenario, _at_rest)


def sample_warnings(scenario: Scenario) -> list[str]:
    """Return warnings about irregularities and profiles from files; refuse samples that lie off their lines."""
    irregular = (getattr(load, "irregularity", None) for load in scenario.loads.values())
    if not any(irregular) and not any(line.profile for line in scenario.lines.values()):
        return []
    from ropewalk.overhead.irregularity import check_samples  # lazy: most runs have no such file

    return check_samples(scenario)


def _at_rest(scenario: Scenario) -> tuple[Layout, Frame]:
    """Return the equilibrium of a scenario."""
    layout, frames, _ = iterate(scenario, RunInfo())
    return layout, next(frames)


def _motion(scenario: Scenario, run: Dynamic, run_info: RunInfo, times: Array, past: Tree | None) -> MotionEngine:
    """A motion, by the engine that its lines ask for."""
    engine = engine_of(scenario)
    if engine is SYSTEM:
        from ropewalk.system.dynamics.moving import SystemMotion  # lazy: most runs do not need their kernels

        return SystemMotion(scenario, run_info, times, past=past is not None)
    if engine is WIRES:
        from ropewalk.wires.frames import Wires  # lazy: as above
        from ropewalk.wiring import task_of

        return Wires(task_of(scenario), times, run_info, run.sample, run.step)
    from ropewalk.chains.moving import Chain  # lazy: as above

    return Chain(scenario, run_info, times, past and past["engine"])


def _still(scenario: Scenario, run_info: RunInfo) -> StaticEngine:
    """Rest and quasi-static motion, by the engine that the lines ask for."""
    until = horizon(scenario) if isinstance(scenario.run, Quasistatic) and not scenario.nets else 0.0
    engine = engine_of(scenario)
    if engine is SYSTEM:
        from ropewalk.system.equilibrium.rest_under_forces import (  # lazy: most runs do not need it
            RestUnderForces,
            is_split,
        )
        from ropewalk.system.equilibrium.still import SystemStatics

        return (RestUnderForces if is_split(scenario) else SystemStatics)(scenario, run_info, until)
    if engine is WIRES:
        from ropewalk.wires import still as wires  # lazy: as above
        from ropewalk.wiring import task_of

        return wires.WireStatics(task_of(scenario), run_info)
    from ropewalk.chains import still as chains  # lazy: as above

    return chains.ChainStatics(scenario, run_info, until)


def _linear(scenario: Scenario, run: Linear, run_info: RunInfo) -> Run:
    """The linear theory: of plain lines in closed forms, of all else by superposition of modes."""
    times = output_times(run)
    if engine_of(scenario) is SUPERPOSED:
        from ropewalk.system.small_motion.superposed import Superposed  # lazy: most runs do not need it

        superposed = Superposed(scenario, run, times, run_info)
        return Known.one_by_one(superposed.layout, superposed.frames(), times.size)
    from ropewalk.chains.frames import layout_of
    from ropewalk.linear.frames import frames  # lazy: the closed forms take a while to import
    from ropewalk.solve.start import setting_of

    setting = setting_of(scenario, run.until)
    run_info.method, run_info.reason = "linear theory", "requested: superposition of small deflections about the chord"
    run_info.audit = "the linear theory superposes deflections and keeps no energies"
    return Known(layout_of(setting), frames(setting, scenario, times, run_info), times.size)


def output_times(run: Dynamic | Linear) -> Array:
    """Instants of output: every `every` from 0, and `until`."""
    every = every_of(run)
    count = int(np.floor(run.until / every * (1.0 + 1e-12)))
    times: Array = every * np.arange(count + 1.0)
    if run.until - times[-1] > 1e-9 * every:
        times = np.append(times, run.until)
    else:
        times[-1] = run.until
    return times


def _with_loads(scenario: Scenario) -> bool:
    """Whether rest, where a spectrum is asked for, is with the loads at their start."""
    return not isinstance(scenario.run, Dynamic) or scenario.run.start.with_loads


def _check_instant(scenario: Scenario, at: float) -> Dynamic:
    """Give the run that has an instant.

    Raises:
        ScenarioError: it lies outside of the run, or that knows no time.
    """
    run = scenario.run
    if not isinstance(run, Dynamic):
        wrong, remedy = f"a run of kind {run.kind} has no time axis", "leave the time out"
        raise ScenarioError([Problem("at", wrong, f"{at:g} s", remedy)])
    if not 0.0 <= at <= run.until:
        remedy = f"give a time from 0 s to run.until, {run.until:g} s"
        raise ScenarioError([Problem("at", "the time lies outside the run", f"{at:g} s", remedy)])
    return run


def spectrum_of(scenario: Scenario, *, at: float | None = None, how_many: int | None = None) -> Spectrum:
    """Find the spectrum of a scenario.

    Args:
        scenario: the scenario.
        at: instant of its dynamic run in s, loads in their places. None: at rest, without the loads for a dynamic run
            (unless it starts with them), with the loads at their start for a run without time.
        how_many: as for `spectrum`.

    Raises:
        EquilibriumError: there is no rest shape, or it is not determined without the loads.
        ScenarioError: the instant lies outside the run, the run knows no time, or a load has no equations of motion.
        RopewalkError: the run does not come to the instant.
    """
    check_spectrum(scenario, with_loads=at is not None or _with_loads(scenario), at_rest=at is None)
    scenario = _formed(scenario)
    run, with_loads = scenario.run, _with_loads(scenario)
    if is_system_linearised(scenario):  # about the rest of nonlinear geometry
        scenario = scenario.model_copy(update={"run": run.model_copy(update={"geometry": "nonlinear"})})
    if at is not None:
        run = _check_instant(scenario, at)
    on_system = bool(scenario.overhead_lines) and engine_of(scenario) is SYSTEM
    parts = scenario.parts
    own = parts.has_inextensible, parts.has_segments, parts.has_cut, parts.has_winch
    if on_system or scenario.is_network or any(own):
        from ropewalk.system.small_motion import spectrum as system  # lazy: a run does not need the eigenvalue solvers

        if at is not None:
            return system.spectrum_at(scenario, at, how_many)
        return system.spectrum(scenario, how_many, with_loads=with_loads)
    if scenario.has_bending_stiffness:
        from ropewalk.wires import spectrum as wires  # lazy: as above
        from ropewalk.wiring import task_of

        task = task_of(scenario)
        if isinstance(run, Dynamic) and at is not None:
            return wires.spectrum_at(task, at, sample=run.sample, step=run.step, how_many=how_many)
        return (wires.spectrum_with_loads if with_loads and task.prescribed_motions else wires.spectrum)(task, how_many)
    from ropewalk.chains import spectrum as chains  # lazy: as above

    return chains.spectrum_of(scenario, at, how_many, with_loads=with_loads)
