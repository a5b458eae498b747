"""A scenario in, a result or a spectrum out."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.capabilities import WEBS, WIRES, check_spectrum, engine_of
from ropewalk.chains import Chain
from ropewalk.checkpoint import Tree
from ropewalk.errors import EquilibriumError, Problem, RopewalkError, ScenarioError
from ropewalk.foreign.turns import closing
from ropewalk.mechanics.bodies import Bodies
from ropewalk.mechanics.chain import OFF, Array, State
from ropewalk.model.load import MovingForce
from ropewalk.model.run import Dynamic, Equilibrium, Linear, Quasistatic, every_of
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Account, Frame, Layout, Run
from ropewalk.results.snapshot import layout_of, standing_frame
from ropewalk.solve.boarding import board
from ropewalk.solve.ends import ends_of, seat_ends
from ropewalk.solve.measure import shapes
from ropewalk.solve.modes_at_start import deflect
from ropewalk.solve.quasistatic import Place, walk
from ropewalk.solve.remarks import Remarks
from ropewalk.solve.splitting import RUNNING
from ropewalk.solve.start import Setting, setting_of, start_state
from ropewalk.solve.timetable import horizon
from ropewalk.solve.vehicle_statics import resting_forces

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.results.recorder import Recorder
    from ropewalk.solve.spectrum import Spectrum

# Size of the compiled kernel of a motion in bytes from which on it is that with bodies.
BODIED_KERNEL = 2_000_000


def simulate(
    scenario: Scenario, *, file: Path | None = None, progress: Callable[[float], None] | None = None
) -> xr.Dataset:
    """Run a scenario.

    Args:
        scenario: what is there and what is asked.
        file: NetCDF file to write while running; None keeps the result in memory.
        progress: called with the part that is done, 0 to 1.

    Returns:
        The result; its attributes hold the outcome, advice, the method and why it was chosen. A run that breaks
        down or is interrupted returns what it has.

    Raises:
        ScenarioError: the run would replace the result that it starts from.
        RopewalkError: the scenario has no rest shape to start from, or the file cannot be written.
    """
    from ropewalk.results.files import check_target
    from ropewalk.results.recorder import Recorder

    if file is not None:
        check_target(file)  # before anything is computed
        _keep_apart(scenario, file)
    watch, account = Clock(), Account()
    run = run_of(scenario, account)
    with Recorder(run.layout, scenario, account, file, run=run) as recorder:
        return record(run, recorder, account, watch, progress)


class Clock:
    """How long a run takes, on the wall and of the processor, what it took before it was taken up again included."""

    def __init__(self, wall: float = 0.0, cpu: float = 0.0) -> None:
        self._wall, self._cpu = clock.perf_counter() - wall, clock.process_time() - cpu

    def read(self) -> tuple[float, float]:
        """Seconds so far, on the wall and of the processor."""
        return clock.perf_counter() - self._wall, clock.process_time() - self._cpu


def record(
    run: Run, recorder: Recorder, account: Account, watch: Clock, progress: Callable[[float], None] | None
) -> xr.Dataset:
    """Let a run go to its end, and record all that is still to come of it."""
    try:
        for frame in run.frames():
            recorder.append(frame)
            account.wall_seconds, account.cpu_seconds = watch.read()
            if progress is not None:
                progress(min(recorder.frames / run.total, 1.0))
    except KeyboardInterrupt:
        if not recorder.frames:
            raise
        account.outcome, account.advice = "interrupted", "the result holds everything up to the interruption"
    account.wall_seconds, account.cpu_seconds = watch.read()
    return recorder.close()


def _keep_apart(scenario: Scenario, file: Path) -> None:
    """Refuse to write into the result that a motion starts from."""
    run = scenario.run
    if isinstance(run, Dynamic) and run.start.file and Path(run.start.file).resolve() == file.resolve():
        remedy = "write the new result elsewhere (-o), or start from a copy"
        raise ScenarioError([Problem("run.start.file", "is the file that the result goes to", str(file), remedy)])


def must_compile(scenario: Scenario) -> str:
    """How long compiling takes that has to be done first, in words; empty if the kernels of the run are there.

    The kernel of a motion is compiled once more for bodies; its two kinds of machine code are told apart by their size,
    about 1 and 4 MB.
    """
    if not isinstance(scenario.run, Dynamic):
        return ""
    engine = engine_of(scenario)
    if engine is WEBS:
        from ropewalk.webs import motion

        return "about a minute" if _sizes(motion.advance) == [] else ""
    if engine is WIRES:
        from ropewalk.wires import large, small

        kernel = large.advance if scenario.run.geometry == "nonlinear" else small.advance
        return "about a quarter of a minute" if _sizes(kernel) == [] else ""
    from ropewalk.solve.splitting import advance

    bodied = any(not isinstance(load, MovingForce) for load in scenario.loads.values())
    sizes = _sizes(advance)
    if sizes is None or any((size > BODIED_KERNEL) == bodied for size in sizes):
        return ""
    return "about a minute" if bodied else "about half a minute"


def _sizes(kernel: Any) -> list[int] | None:
    """Sizes in bytes of the machine code of a kernel in its cache, None where nothing is known of that."""
    folder = getattr(getattr(kernel, "stats", None), "cache_path", None)
    if folder is None:
        return None
    module = kernel.py_func.__module__.rsplit(".", 1)[1]
    return [code.stat().st_size for code in Path(folder).glob(f"{module}.advance-*.nbc")]


def iterate(scenario: Scenario, account: Account) -> tuple[Layout, Iterator[Frame], int]:
    """The frames of a run, one after the other, with their layout and their number; `account` is filled in."""
    run = run_of(scenario, account)
    return run.layout, run.frames(), run.total


@dataclass(frozen=True)
class _Still:
    """Frames between which nothing is to be remembered."""

    layout: Layout
    given: Iterator[Frame]
    total: int

    def frames(self) -> Iterator[Frame]:
        """All of them."""
        return self.given

    def get_state(self) -> None:
        """Nothing."""


def run_of(scenario: Scenario, account: Account, times: Array | None = None, past: Tree | None = None) -> Run:
    """A scenario ready to run.

    Args:
        scenario: what is there and what is asked.
        account: filled in.
        times: of a motion, its output instants in s (default: those that it asks for).
        past: what such a run has given as its state, to go on from there.
    """
    run, engine = scenario.run, engine_of(scenario)
    if isinstance(run, Dynamic):
        return _moving(scenario, run, account, output_times(run) if times is None else times, past)
    if engine is WEBS:
        return _webbed(scenario, account)
    if engine is WIRES:
        return _wired(scenario, account)
    if isinstance(run, Linear):
        from ropewalk.linear.frames import frames  # lazy: the closed forms take a while to import

        setting = setting_of(scenario, run.until)
        times = output_times(run)
        account.method, account.reason = "linear theory", "as asked: superposition of small deflections about the chord"
        account.audit = "the linear theory superposes deflections and keeps no energies"
        return _Still(layout_of(setting), frames(setting, scenario, times, account), times.size)
    setting = setting_of(scenario, horizon(scenario) if isinstance(run, Quasistatic) else 0.0)
    layout = layout_of(setting, "load_path")
    account.method = "rest"
    account.reason = "least potential energy"
    if isinstance(run, Quasistatic):
        return _Still(layout, _slowly(account, _slow(setting, scenario, account)), run.positions)
    assert isinstance(run, Equilibrium)
    return _Still(layout, _rest(setting, scenario, account), 1)


def _moving(scenario: Scenario, run: Dynamic, account: Account, times: Array, past: Tree | None) -> Run:
    """A motion, by the engine that its lines ask for."""
    engine = engine_of(scenario)
    if engine is WEBS:
        from ropewalk.webs.moving import Motion as Web  # lazy: most runs do not need their kernels

        return Web(scenario, account, times, past)
    if engine is WIRES:
        from ropewalk.wires.frames import SAMPLE  # lazy: as above
        from ropewalk.wires.frames import Run as Wires
        from ropewalk.wiring import task_of

        return Wires(task_of(scenario), times, account, run.sample or max(SAMPLE, run.step or 0.0), run.step, past)
    return _chain(scenario, account, times, past)


def _webbed(scenario: Scenario, account: Account) -> Run:
    """Joined lines, nets and membranes at rest or in slow motion."""
    from ropewalk.webs.frames import Run as Web  # lazy: most runs do not need their kernels

    run = scenario.run
    slow = isinstance(run, Quasistatic)
    found = Web(scenario, account, horizon(scenario) if slow and not scenario.nets else 0.0, "load_path")
    if isinstance(run, Quasistatic):
        return _Still(found.layout, _slowly(account, found.slowly(run.positions, run.turn)), run.positions)
    return _Still(found.layout, found.standing(), 1)


def _wired(scenario: Scenario, account: Account) -> Run:
    """Stiff lines and overhead lines at rest or in slow motion."""
    from ropewalk.wires.still import Still  # lazy: most runs do not need it
    from ropewalk.wiring import task_of

    still, run = Still(task_of(scenario), account), scenario.run
    if isinstance(run, Quasistatic):
        return _Still(still.layout, _slowly(account, still.slowly(run.positions, run.turn)), run.positions)
    return _Still(still.layout, still.standing(), 1)


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


def initial_state(setting: Setting, scenario: Scenario) -> tuple[State, Bodies | None]:
    run = scenario.run
    assert isinstance(run, Dynamic)
    state = start_state(setting, run.start.with_loads, resting_forces(setting))
    if run.start.kind == "result":
        from ropewalk.results.resume import take_up

        take_up(setting, state, run.start)
        _check_ends(setting, state)
        seat_ends(setting.strands, setting.supports, state)
    elif run.start.kind == "mode":
        deflect(setting, state, run.start)
    return state, board(setting, state, run.start.with_loads)


def _check_ends(setting: Setting, state: State) -> None:
    """Refuse to take up a motion at supports that are prescribed to stand elsewhere: the line would be torn there."""
    ends = ends_of(setting.strands, setting.supports)
    for number, node in zip(ends.number, ends.node, strict=True) if ends is not None else ():
        s, side = divmod(int(number), 2)
        held = setting.held(s, float(state.t[0]))
        stuck = np.eye(len(setting.axes)) - held.free[side]
        away = float(np.linalg.norm(stuck @ (state.r[:, node] - held.place[side])))
        if away > 1e-9 * setting.strands.h[s] * setting.strands.links[s]:
            name = f"lines: {setting.lines[s]}: {('start', 'end')[side]}_support"
            raise RopewalkError(
                f"{name} stands {away:.3g} m elsewhere in the stored result; let its place and displacement begin there"
            )


def _chain(scenario: Scenario, account: Account, times: Array, past: Tree | None = None) -> Chain:
    """A motion of plain lines, in its first state."""
    run = scenario.run
    assert isinstance(run, Dynamic)
    setting = setting_of(scenario, run.until)
    state, bodies = initial_state(setting, scenario)
    return Chain(scenario, setting, state, bodies, account, times, past)


def _slowly(account: Account, frames: Iterator[Frame]) -> Iterator[Frame]:
    """Frames of slow motion; one that ends where there is no equilibrium keeps those before."""
    try:
        for frame in frames:
            account.steps += 1
            yield frame
    except RopewalkError as error:
        if account.steps == 0:
            raise
        account.outcome, account.advice = "no rest shape", str(error)


def _slow(setting: Setting, scenario: Scenario, account: Account) -> Iterator[Frame]:
    run, remarks = scenario.run, Remarks(setting, tuple(scenario.loads))
    assert isinstance(run, Quasistatic)
    for place in walk(setting, run.positions, run.turn):
        account.warnings += remarks.on(place)
        yield standing_frame(setting, place.stands, place.xi, place.path, place.given, place.t)


def _rest(setting: Setting, scenario: Scenario, account: Account) -> Iterator[Frame]:
    stands, given = shapes(setting, setting.xi, 0.0)
    account.warnings += Remarks(setting, tuple(scenario.loads)).on(
        Place(0.0, 0.0, setting.xi, np.zeros(setting.xi.size), stands, given)
    )
    yield standing_frame(setting, stands, setting.xi, 0.0, given)


def state_at(scenario: Scenario, t: float) -> tuple[Setting, State, Bodies | None]:
    """The model of a dynamic run, its state at time t in s, and all that has a mass.

    Raises:
        RopewalkError: the run does not come to the instant.
    """
    assert isinstance(scenario.run, Dynamic)
    if t <= 0.0:
        setting = setting_of(scenario, scenario.run.until)
        return setting, *initial_state(setting, scenario)
    chain = _chain(scenario, Account(), np.array([t]))
    with closing(chain.turns):
        chain.motion.to(t)
    if chain.progress.status != RUNNING:
        outcome, advice = chain.progress.told()
        raise RopewalkError(f"the run did not come to t = {t:g} s ({outcome}): {advice}")
    return chain.setting, chain.state, chain.bodies


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
        wrong, remedy = f"a run of kind {run.kind} has no instants", "leave the time out"
        raise ScenarioError([Problem("at", wrong, f"{at:g} s", remedy)])
    if not 0.0 <= at <= run.until:
        remedy = f"give a time from 0 s to run.until, {run.until:g} s"
        raise ScenarioError([Problem("at", "the time lies outside the run", f"{at:g} s", remedy)])
    return run


def _spectrum_of_web(scenario: Scenario, at: float | None, how_many: int | None) -> Spectrum:
    from ropewalk.webs import spectrum as of_webs  # lazy: a run does not need the eigenvalue solvers

    if at is not None:
        _check_instant(scenario, at)
        return of_webs.spectrum_at(scenario, at, how_many)
    if _with_loads(scenario) and scenario.loads:
        return of_webs.spectrum_with_loads(scenario, how_many)
    return of_webs.spectrum(scenario, how_many)


def _spectrum_of_wires(scenario: Scenario, at: float | None, how_many: int | None) -> Spectrum:
    from ropewalk.wires import spectrum as of_wires  # lazy: a run does not need the eigenvalue solvers
    from ropewalk.wires.frames import SAMPLE
    from ropewalk.wiring import task_of

    if at is not None:
        run = _check_instant(scenario, at)
        sample = run.sample or max(SAMPLE, run.step or 0.0)
        return of_wires.spectrum_at(task_of(scenario), at, sample=sample, step=run.step, how_many=how_many)
    task = task_of(scenario)
    if _with_loads(scenario) and task.journeys:
        return of_wires.spectrum_with_loads(task, how_many)
    return of_wires.spectrum(task, how_many)


def spectrum_of(scenario: Scenario, *, at: float | None = None, how_many: int | None = None) -> Spectrum:
    """Find the spectrum of a scenario.

    Args:
        scenario: what is there.
        at: instant of its dynamic run in s, loads in their places. None: at rest, without the loads for a dynamic run
            (unless it starts with them), with the loads at their start for a run without time.
        how_many: as for `spectrum`.

    Raises:
        EquilibriumError: there is no rest shape, or it is not determined without the loads.
        ScenarioError: the instant lies outside the run, the run knows no time, or a load has no equations of motion.
        RopewalkError: the run does not come to the instant.
    """
    if at is not None or _with_loads(scenario):
        check_spectrum(scenario)
    if scenario.is_web:
        return _spectrum_of_web(scenario, at, how_many)
    if scenario.is_stiff:
        return _spectrum_of_wires(scenario, at, how_many)
    return _spectrum_of_ropes(scenario, at, how_many)


def _spectrum_of_ropes(scenario: Scenario, at: float | None, how_many: int | None) -> Spectrum:
    from ropewalk.solve.chain_equations import equations_of, hang_down  # lazy: as above
    from ropewalk.solve.free_vibration import free_vibration
    from ropewalk.solve.spectrum import in_space, spectrum

    bodies: Bodies | None = None
    if at is not None:
        _check_instant(scenario, at)
        setting, state, bodies = state_at(scenario, at)
    elif _with_loads(scenario):
        setting = setting_of(scenario, 0.0)
        state = start_state(setting, True, resting_forces(setting))
        if setting.fleet is not None:
            bodies = board(setting, state, True)
            assert bodies is not None
            hang_down(setting, state, bodies)
    else:
        setting = setting_of(scenario, 0.0)
        rests = [rest for rest in setting.bare if rest is not None]
        if len(rests) < len(setting.bare):
            name = setting.lines[setting.bare.index(None)]
            raise EquilibriumError(
                f"line {name}: without loads its rest shape is not determined; ask for an instant of the run instead"
            )
        state = start_state(setting, False)
        state.rider[:] = OFF
        state.r[:] = np.concatenate([rest.position for rest in rests], axis=1)
        state.X[:] = np.concatenate([rest.X for rest in rests])
    if bodies is not None or setting.supports.free.any():
        return free_vibration(equations_of(scenario, setting, state, bodies), how_many)
    return spectrum(setting.strands, (in_space(state.r), state.X), how_many=how_many, names=setting.lines)
