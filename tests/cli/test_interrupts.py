"""Ctrl-C and SIGTERM are heard wherever a command is: in kernels, compilers and imports."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import typer

import ropewalk
from ropewalk.results import open_result

ROPE = """
lines:
  rope: {start: [0, 0], end: [100, 0], tension: 20 kN, mass: 1, axial_stiffness: 2 MN, elements: 40%s}
loads:
  one: {kind: %s, on: rope, travel: {speed: 1e-7, from: 20 m}}
run: {kind: dynamic, until: 0.1 s%s}
"""
JOINED = """
joints: {knot: {}}
lines:
  left: {start: [0, 0], end: [50, 0], end_support: {kind: joined, to: knot}, tension: 20 kN, mass: 1,
    axial_stiffness: 2 MN, elements: 200}
  right: {start: [50, 0], end: [100, 0], start_support: {kind: joined, to: knot}, tension: 20 kN, mass: 1,
    axial_stiffness: 2 MN, elements: 200}
loads:
  one: {kind: mass, mass: 50, on: left, travel: {speed: 1e-7, from: 20 m}}
run: {kind: dynamic, until: 0.1 s}
"""
EXAMPLES = Path(__file__).parents[2] / "examples"
FORCE, MASS = "force, force: [0, -500]", "mass, mass: 50"
RUNS = {
    "chain, force": ROPE % ("0", FORCE, ""),
    "chain, mass": ROPE % ("0", MASS, ""),
    "chain, implicit": ROPE % ("0, axial_damping: 50 kN*s", FORCE, ", method: implicit, step: 10 us"),
    "joined": JOINED,
    "beam": ROPE % ("0, bending_stiffness: 1 kN*m^2", MASS, ""),
    "beam, small motion": ROPE % ("0, bending_stiffness: 1 kN*m^2", MASS, ", geometry: linearised"),
    "sheaves": (EXAMPLES / "sheaves.yaml").read_text(encoding="utf-8"),
}
BRIEFLY = ("run.until=0.2 ms", "run.every=0.2 ms")
FOR_HOURS = ("--set", "run.until=2000 s", "--set", "run.every=2000 s")


def start(*words, folder, **variables):
    pipe = subprocess.PIPE
    return subprocess.Popen(
        [sys.executable, "-m", "ropewalk", *words], stdout=pipe, stderr=pipe, text=True, cwd=folder,
        env={**os.environ, **variables},
    )  # fmt: skip


def wait_for(file, process):
    """Until a file is there: what follows is the motion."""
    while not file.exists():
        assert process.poll() is None, process.communicate()
        time.sleep(0.05)
    time.sleep(0.5)  # so that the kernel is at work; sooner an interrupt is heard as well


LOOK_AHEAD = ("beam", "beam, small motion")  # their first frame waits for what comes after it


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_is_heard_in_the_kernels_of_every_engine(name, number, tmp_path):
    if number == signal.SIGTERM and name != "joined":
        pytest.skip("they are heard in one way")
    (tmp_path / "one.yaml").write_text(RUNS[name], encoding="utf-8")
    ropewalk.simulate(ropewalk.load(tmp_path / "one.yaml", BRIEFLY))  # compiles
    with start("run", "one.yaml", *FOR_HOURS, folder=tmp_path) as run:
        wait_for(tmp_path / (".one.nc.lock" if name in LOOK_AHEAD else "one.nc"), run)
        run.send_signal(number)
        _, stderr = run.communicate(timeout=100)  # on however busy a machine; the motion itself takes hours
    assert run.returncode == 130, stderr
    assert "Traceback" not in stderr
    assert "compiling" not in stderr
    if name in LOOK_AHEAD:
        assert stderr.splitlines()[-1] == "interrupted"  # what the run will take is told before
        return
    assert "interrupted; the computed part is kept in one.nc" in stderr
    with open_result(tmp_path / "one.nc") as result:
        assert (result.attrs["outcome"], result.sizes["time"]) == ("interrupted", 1)


def test_an_interrupt_is_heard_while_kernels_are_compiled(tmp_path):
    """Soon after the compiler begins with the first kernel, which takes it a second and more."""
    (tmp_path / "one.yaml").write_text(RUNS["chain, force"], encoding="utf-8")
    run = listening(
        """
from numba.core import event
from ropewalk.interrupts import note_compiling
class First(event.Listener):
    begun = False
    def on_start(self, _):
        if not self.begun:
            self.begun = True
            threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT)).start()
    def on_end(self, _): pass
event.register("numba:compile", First())
sys.argv = ["ropewalk", "run", "one.yaml"]
line.main()
""",
        tmp_path,
        NUMBA_CACHE_DIR=str(tmp_path / "cache"),
    )
    assert run.returncode == 130, run
    assert run.stderr.splitlines()[-1] == "interrupted while compiling"


@pytest.mark.parametrize("after", [0.01, 0.02, 0.05, 0.1, 0.2, 0.4])
def test_an_interrupt_is_heard_during_imports(after, tmp_path):
    (tmp_path / "one.yaml").write_text(RUNS["beam"], encoding="utf-8")
    run = listening(
        f"""
threading.Timer({after}, os.kill, (os.getpid(), signal.SIGINT)).start()
sys.argv = ["ropewalk", "check", "one.yaml"]
line.main()
""",
        tmp_path,
    )
    assert run.stderr == ("interrupted\n" if run.returncode else "")
    assert run.returncode in ((130,) if after < 0.1 else (130, 0))


def test_an_interrupt_is_heard_from_the_first_line_on(tmp_path):
    run = listening("line.listen = lambda: signal.raise_signal(signal.SIGINT)\nline.main()", tmp_path)
    assert (run.returncode, run.stdout, run.stderr) == (130, "", "interrupted\n")


def listening(program, folder, **variables):
    """What a program does that listens to signals."""
    head = "import os, signal, sys, threading, time\nimport ropewalk.__main__ as line\nline.listen()\n"
    return subprocess.run(
        [sys.executable, "-c", head + program], capture_output=True, text=True, cwd=folder, check=False,
        env={**os.environ, **variables},
    )  # fmt: skip


def test_a_module_is_imported_whole_before_an_interrupt_is_raised(tmp_path):
    (tmp_path / "one.py").write_text(
        "import signal\nsignal.raise_signal(signal.SIGINT)\nprint('whole')", encoding="utf-8"
    )
    run = listening(
        """
try:
    import one
    time.sleep(20.0)
except KeyboardInterrupt:
    print("heard")
""",
        tmp_path,
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, "whole\nheard\n", "")


def test_an_import_without_end_is_left(tmp_path):
    (tmp_path / "one.py").write_text(
        "import signal\nsignal.raise_signal(signal.SIGINT)\nimport time\ntime.sleep(20)", encoding="utf-8"
    )
    run = listening("import one", tmp_path)
    assert (run.returncode, run.stdout, run.stderr) == (130, "", "interrupted\n")


def test_an_interrupt_in_a_destructor_is_not_lost(tmp_path):
    run = listening(
        """
class Last:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)
        print("never")

try:
    Last()
    time.sleep(20.0)
except KeyboardInterrupt:
    print("heard")
""",
        tmp_path,
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, "heard\n", "")


def test_an_interrupt_that_others_swallow_ends_the_command(tmp_path):
    run = listening(
        """
import ropewalk.cli.app

def swallow():
    try:
        signal.raise_signal(signal.SIGINT)
    except KeyboardInterrupt:
        sys.exit(0)

ropewalk.cli.app.app = swallow
line.main()
""",
        tmp_path,
    )
    assert (run.returncode, run.stderr) == (130, "interrupted\n")


def test_an_interrupt_that_others_swallow_is_heard_between_portions(tmp_path):
    run = listening(
        """
from ropewalk.mechanics.portions import portions

try:
    signal.raise_signal(signal.SIGINT)
except KeyboardInterrupt:
    pass
try:
    for _ in portions(10, 10):
        print("never")
except KeyboardInterrupt:
    print("heard")
""",
        tmp_path,
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, "heard\n", "")


def test_an_interrupt_after_the_end_of_a_command_changes_nothing(tmp_path):
    run = listening(
        """
import gc
import ropewalk.cli.app

freeze = gc.freeze
gc.freeze = lambda: (freeze(), signal.raise_signal(signal.SIGINT))
ropewalk.cli.app.app = lambda: print("done")
line.main()
""",
        tmp_path,
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, "done\n", "")


def test_a_result_is_not_read_back_after_an_interrupt(tmp_path, monkeypatch):
    """A summary of pantographs imports xarray, which took 0.6 s; of 1500 frames of a net, 2 s after the signal."""
    from ropewalk.cli import console

    monkeypatch.setattr(console, "is_interrupted", lambda: True)
    with pytest.raises(typer.Exit) as end:
        console.open_unless_interrupted(tmp_path / "one.nc", tmp_path / "one.nc")
    assert end.value.exit_code == 130


def test_a_resumed_run_is_not_read_back_after_an_interrupt(tmp_path):
    (tmp_path / "one.yaml").write_text(RUNS["chain, force"], encoding="utf-8")
    ropewalk.simulate(ropewalk.load(tmp_path / "one.yaml", BRIEFLY), file=tmp_path / "one.nc")
    run = listening(
        """
import ropewalk.results.recorder as recorder
extend = recorder.Recorder.extend
def interrupted(*words):
    extend(*words)
    signal.raise_signal(signal.SIGINT)
recorder.Recorder.extend = interrupted
sys.argv = ["ropewalk", "resume", "one.nc", "--until", "0.4 ms"]
leave = os._exit
def leaving(code):
    print("xarray" in sys.modules, flush=True)
    leave(code)
os._exit = leaving
line.main()
""",
        tmp_path,
    )
    assert "interrupted; the computed part is kept in one.nc. `ropewalk show one.nc`" in run.stderr, run
    assert (run.returncode, run.stdout) == (130, "False\n")


def test_a_sweep_has_imported_what_its_table_needs_before_it_begins(tmp_path):
    """Interrupted in its first seconds it imported pint for its first dataset, which took 0.5 s."""
    pytest.importorskip("pint")
    (tmp_path / "one.yaml").write_text(RUNS["chain, force"], encoding="utf-8")
    run = listening(
        """
import ropewalk.sweeps.sweeping as sweeping
def finishing(*_):
    print("pint" in sys.modules)
    yield from ()
    raise KeyboardInterrupt
sweeping.finishing = finishing
sys.argv = ["ropewalk", "sweep", "one.yaml", "--over", "lines.rope.mass=1,2", "--quiet"]
line.main()
""",
        tmp_path,
    )
    assert run.stdout.splitlines()[:1] == ["True"], run


def test_other_faults_in_destructors_are_told(tmp_path):
    run = listening(
        """
class Last:
    def __del__(self):
        raise ValueError("bad luck")

Last()
""",
        tmp_path,
    )
    assert "ValueError: bad luck" in run.stderr


def test_kernels_that_come_from_the_cache_are_not_being_compiled(tmp_path):
    run = listening(
        """
from numba.core.compiler_lock import global_compiler_lock
import ropewalk.mechanics.compiled

try:
    with global_compiler_lock:
        signal.raise_signal(signal.SIGINT)
except KeyboardInterrupt:
    print("heard")
""",
        tmp_path,
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, "heard\n", "")


@pytest.mark.parametrize("times", [1, 4])
def test_an_interrupt_while_kernels_are_loaded_ends_the_command(times, tmp_path):
    """LLVM asks Python for the machine code of a module and ignores exceptions: it went on without, and crashed."""
    (tmp_path / "one.yaml").write_text(RUNS["chain, force"], encoding="utf-8")
    ropewalk.simulate(ropewalk.load(tmp_path / "one.yaml", BRIEFLY))  # compiles
    run = listening(
        f"""
from numba.core.codegen import JITCodeLibrary
hook, calls = JITCodeLibrary._object_getbuffer_hook.__func__, []
def interrupted(cls, module):
    calls.append(module)
    if len(calls) == {times}:
        signal.raise_signal(signal.SIGINT)
    return hook(cls, module)
JITCodeLibrary._object_getbuffer_hook = classmethod(interrupted)
sys.argv = ["ropewalk", "run", "one.yaml"]
line.main()
""",
        tmp_path,
    )
    assert (run.returncode, run.stderr.splitlines()[-1:]) == (130, ["interrupted"]), run


def test_an_exception_is_not_raised_where_llvm_drops_it(tmp_path):
    run = listening(
        """
exec(compile("def call(function): function()", "binding.py", "exec"), found := {"__name__": "llvmlite.binding.ffi"})
def swallow():
    signal.raise_signal(signal.SIGINT)
    print("whole")
try:
    found["call"](swallow)
    time.sleep(20.0)
except KeyboardInterrupt:
    print("heard")
""",
        tmp_path,
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, "whole\nheard\n", "")


def test_a_deferred_interrupt_is_raised_after_the_block_whatever_that_raises(tmp_path):
    run = listening(
        """
from ropewalk.interrupts import deferred
for fault in ("", "0 / 0"):
    try:
        with deferred(), deferred():
            signal.raise_signal(signal.SIGINT)
            print("whole")
            eval(fault or "0")
    except KeyboardInterrupt:
        print("heard")
""",
        tmp_path,
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, "whole\nheard\n" * 2, "")


@pytest.mark.parametrize("number", [1, 2])  # processes: the one that tidies up, and the first that computes
def test_processes_of_a_sweep_are_started_whole_before_an_interrupt_is_raised(number, tmp_path):
    """Interrupted within its start, a process printed a traceback, since what it reads first was not written."""
    run = listening(
        f"""
import multiprocessing.util as starts
from ropewalk.sweeps.pool import each
start, begun = starts.spawnv_passfds, []
def interrupted(*words):
    begun.append(start(*words))
    if len(begun) == {number}:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.1)  # any thread may take it
    return begun[-1]
starts.spawnv_passfds = interrupted
try:
    print(*each([-1], abs, 1, 0))
except KeyboardInterrupt:
    print("heard")
""",
        tmp_path,
    )
    assert (run.returncode, run.stdout, run.stderr) == (0, "heard\n", "")


def test_the_last_line_is_said_once(tmp_path):
    """The main thread and the one that watches beside the compiler may hear a signal at the same time."""
    run = listening(
        """
import ropewalk.interrupts as interrupts

write = os.write
os.write = lambda *what: (write(*what), time.sleep(0.1))
for _ in range(2):
    threading.Thread(target=interrupts._leave).start()
""",
        tmp_path,
    )
    assert (run.returncode, run.stderr) == (130, "interrupted\n")
