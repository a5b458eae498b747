"""A scenario in, a result or a spectrum out."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.errors import EquilibriumError, Problem, RopewalkError, ScenarioError
from ropewalk.foreign.turns import Turns, begun, closing
from ropewalk.mechanics.bodies import Bodies, are_weightless
from ropewalk.mechanics.chain import OFF, Array, State
from ropewalk.model.load import MovingForce
from ropewalk.model.run import Dynamic, Equilibrium, Linear, Quasistatic, every_of
from ropewalk.model.scenario import Scenario
from ropewalk.results.exchanges import exchanged, exchanging, foreign_in
from ropewalk.results.frame import ENERGY_FORMS, Account, Frame, Layout
from ropewalk.results.snapshot import Camera, layout_of, standing_frame
from ropewalk.solve.boarding import board
from ropewalk.solve.choice import Choice, choose, cut_by_damping
from ropewalk.solve.ends import ends_of, seat_ends
from ropewalk.solve.guides import Partner, guides_of
from ropewalk.solve.measure import shapes
from ropewalk.solve.modes_at_start import deflect
from ropewalk.solve.motion import STOPPED, Progress, move
from ropewalk.solve.quasistatic import Place, walk
from ropewalk.solve.remarks import Remarks, in_one_link, on_friction, on_parting, on_springing_up, who_met
from ropewalk.solve.splitting import END_OF_LINE, MET, RUNNING
from ropewalk.solve.start import Setting, setting_of, start_state
from ropewalk.solve.timetable import horizon
from ropewalk.solve.vehicle_statics import resting_forces

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.solve.spectrum import Spectrum

_SHORTENED = (
    "lines.{line}.axial_damping makes the step {times:.2g} times shorter than it is without: lower it, or write fewer "
    "elements"
)
_COMPRESSION = (
    "at t = {time:.4g} s line {line} is in compression without any damping: a chain cannot carry that, and "
    "disturbances of the size of rounding errors grow; use law {{kind: tension_only}} or a little axial_damping"
)

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
    from ropewalk.results.recorder import Recorder

    if file is not None:
        _keep_apart(scenario, file)
    account = Account()
    wall, cpu = clock.perf_counter(), clock.process_time()
    layout, frames, total = iterate(scenario, account)
    with Recorder(layout, scenario, account, file) as recorder:
        try:
            for count, frame in enumerate(frames, start=1):
                recorder.append(frame)
                if progress is not None:
                    progress(min(count / total, 1.0))
        except KeyboardInterrupt:
            if not recorder.frames:
                raise
            account.outcome, account.advice = "interrupted", "the result holds everything up to the interruption"
        account.wall_seconds, account.cpu_seconds = clock.perf_counter() - wall, clock.process_time() - cpu
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
    if scenario.is_web:
        from ropewalk.webs import motion

        return "about a minute" if _sizes(motion.advance) == [] else ""
    if scenario.is_stiff:
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
    if scenario.is_web:
        return _webbed(scenario, account)
    if scenario.is_stiff and not isinstance(scenario.run, Linear):
        return _wired(scenario, account)
    if isinstance(scenario.run, Dynamic):
        setting = setting_of(scenario, scenario.run.until)
        times = output_times(scenario.run)
        layout = replace(layout_of(setting), foreign=foreign_in(scenario))
        return layout, _motion(setting, scenario, times, account), times.size
    if isinstance(scenario.run, Linear):
        from ropewalk import linear  # lazy: the closed forms take a while to import

        setting = setting_of(scenario, scenario.run.until)
        _refuse_to_yield(setting, "run.kind: linear knows", "ask for kind: dynamic")
        times = output_times(scenario.run)
        account.method, account.reason = "linear theory", "as asked: superposition of small deflections about the chord"
        account.audit = "the linear theory superposes deflections and keeps no energies"
        return layout_of(setting), linear.frames(setting, scenario, times, account), times.size
    setting = setting_of(scenario, horizon(scenario) if isinstance(scenario.run, Quasistatic) else 0.0)
    layout = layout_of(setting, "load_path")
    account.method = "rest"
    account.reason = "least potential energy"
    if isinstance(scenario.run, Quasistatic):
        return layout, _slowly(account, _slow(setting, scenario, account)), scenario.run.positions
    assert isinstance(scenario.run, Equilibrium)
    return layout, _rest(setting, scenario, account), 1


def _webbed(scenario: Scenario, account: Account) -> tuple[Layout, Iterator[Frame], int]:
    """The frames of joined lines, nets and membranes."""
    from ropewalk.webs.frames import Run  # lazy: most runs do not need their kernels

    run = scenario.run
    if isinstance(run, Dynamic):
        times = output_times(run)
        found = Run(scenario, account, run.until)
        return found.layout, found.moving(times), times.size
    assert isinstance(run, Quasistatic | Equilibrium)
    slow = isinstance(run, Quasistatic)
    found = Run(scenario, account, horizon(scenario) if slow and not scenario.nets else 0.0, "load_path")
    if isinstance(run, Quasistatic):
        return found.layout, _slowly(account, found.slowly(run.positions, run.turn)), run.positions
    return found.layout, found.standing(), 1


def _wired(scenario: Scenario, account: Account) -> tuple[Layout, Iterator[Frame], int]:
    """The frames of stiff lines and overhead lines."""
    from ropewalk.wiring import task_of  # lazy: most runs do not need it

    run = scenario.run
    if not isinstance(run, Dynamic):
        from ropewalk.wires.still import Still

        still = Still(task_of(scenario), account)
        if isinstance(run, Quasistatic):
            return still.layout, _slowly(account, still.slowly(run.positions, run.turn)), run.positions
        return still.layout, still.standing(), 1
    from ropewalk.wires.frames import SAMPLE, Run  # lazy: as above

    times = output_times(run)
    sample = run.sample or max(SAMPLE, run.step or 0.0)
    found = Run(task_of(scenario), times, account, sample, run.step)
    return found.layout, found.frames(), times.size


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


def _course(
    setting: Setting, scenario: Scenario, state: State, bodies: Bodies | None
) -> tuple[Choice, list[Turns], Callable[[Array, Progress], Iterator[State]]]:
    """How a motion goes on from its first state: the method, what takes turns, and what gives the states later on."""
    run = scenario.run
    assert isinstance(run, Dynamic)
    strands, loads, supports = setting.strands, setting.loads, setting.supports
    moving = None if bodies is None or are_weightless(bodies) else bodies
    choice = choose(
        strands, loads, state, method=run.method, step=run.step, accuracy=run.accuracy,
        duration=run.until, supports=supports, bodies=moving, guided=bodies is not None,
    )  # fmt: skip
    guides = guides_of(setting, scenario, bodies)
    turns = [guide.turns for guide in guides if isinstance(guide, Partner)]
    with begun(turns):
        for guide in guides:
            guide.begin(state)

    def states(times: Array, progress: Progress) -> Iterator[State]:
        return move(strands, loads, state, choice, run.precision, times, progress, supports, moving, guides)

    return choice, turns, states


def _motion(setting: Setting, scenario: Scenario, times: Array, account: Account) -> Iterator[Frame]:
    state, bodies = initial_state(setting, scenario)
    choice, turns, states = _course(setting, scenario, state, bodies)
    account.method, account.reason, account.step = choice.method, choice.reason, choice.step
    account.warnings += in_one_link(setting)
    if (cut := cut_by_damping(setting.strands, state, choice)) is not None:
        account.warnings.append(_SHORTENED.format(line=setting.lines[cut[0]], times=cut[1]))
    camera, progress = Camera(setting, bodies), Progress()
    with exchanging(turns, account):
        yield exchanged(camera.take(state), turns, account)
        warned, parted, slipped = False, set[int](), set[int]()
        for current in states(times[1:], progress):
            account.steps = progress.steps
            if progress.status != RUNNING:
                if progress.status == MET:
                    progress.message = who_met(setting, current)
                account.outcome, advice = progress.told()
                account.advice = f"stopped at t = {current.t[0]:.6g} s: {advice}"
                if current.t[0] > 0.0 and progress.status in (END_OF_LINE, MET, STOPPED):
                    yield exchanged(camera.take(current), turns, account)
                return
            frame = exchanged(camera.take(current), turns, account)
            if not warned:
                warned = _warn_of_compression(setting, frame, account)
            account.warnings += on_friction(setting, frame.contact_friction, frame.path, slipped)
            if bodies is not None:
                moving = sum(
                    float(frame.energy[ENERGY_FORMS.index(form)]) for form in ("kinetic", "elastic", "load_kinetic")
                )
                account.warnings += on_parting(setting, bodies, moving, parted)
                for told in on_springing_up(setting, bodies, moving, parted):
                    account.doubt(*told)
            yield frame


def _warn_of_compression(setting: Setting, frame: Frame, account: Account) -> bool:
    begin = 0
    for s, name in enumerate(setting.lines):
        n = int(setting.strands.links[s])
        if setting.strands.damping[s] == 0.0 and frame.tension[begin : begin + n].min() < 0.0:
            account.warnings.append(_COMPRESSION.format(time=frame.path, line=name))
            return True
        begin += n
    return False


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
    setting = setting_of(scenario, scenario.run.until)
    state, bodies = initial_state(setting, scenario)
    if t > 0.0:
        progress = Progress()
        _, turns, states = _course(setting, scenario, state, bodies)
        with closing(turns):
            for _ in states(np.array([t]), progress):
                pass
        if progress.status != RUNNING:
            outcome, advice = progress.told()
            raise RopewalkError(f"the run did not come to t = {t:g} s ({outcome}): {advice}")
    return setting, state, bodies


def _refuse_to_yield(setting: Setting, who: str, otherwise: str) -> None:
    """Refuse supports that yield or move where they are not known, instead of passing over them.

    Raises:
        RopewalkError: there is such a support.
    """
    supports = setting.supports
    for number, free in enumerate(supports.free):
        if free.any() or supports.motion_count[number] > 1:
            name = f"lines: {setting.lines[number // 2]}: {('start', 'end')[number % 2]}_support"
            raise RopewalkError(f"{name}: {who} only fixed supports so far; write kind: fixed, or {otherwise}")


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
        ScenarioError: the instant lies outside the run, or the run knows no time.
        RopewalkError: the run does not come to the instant, or a load has no equations of motion.
    """
    if scenario.is_web:
        return _spectrum_of_web(scenario, at, how_many)
    if scenario.is_stiff:
        return _spectrum_of_wires(scenario, at, how_many)
    return _spectrum_of_ropes(scenario, at, how_many)


def _spectrum_of_ropes(scenario: Scenario, at: float | None, how_many: int | None) -> Spectrum:
    from ropewalk.solve.chain_equations import equations_of, hang_down, refuse_minds  # lazy: as above
    from ropewalk.solve.free_vibration import free_vibration
    from ropewalk.solve.spectrum import in_space, spectrum

    bodies: Bodies | None = None
    if at is not None:
        _check_instant(scenario, at)
        refuse_minds(scenario)
        setting, state, bodies = state_at(scenario, at)
    elif _with_loads(scenario):
        refuse_minds(scenario)
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
