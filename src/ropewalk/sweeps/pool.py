"""Tasks computed one after another, or side by side in processes of their own that may die."""

from __future__ import annotations

import ctypes
import multiprocessing
import os
import signal
import sys
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from itertools import islice
from typing import Any, TypeVar

from ropewalk.errors import RopewalkError
from ropewalk.interrupts import deferred

DIED = (
    "the process that computed it died: killed from outside, out of memory, or a crash of compiled code; "
    "--retry computes it again"
)
TRIES = 2
"""How often a task is computed alone before it counts as what kills its process."""
BEGINNINGS = 3
"""How often processes may die before they compute anything: from a script without its guard they always do."""
# One thread for each process: the tasks themselves fill the cores, and sums come out the same on any number of them.
_THREADS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

_PARENT_DEATH_SIGNAL = 1  # of prctl

CHUNK, BRIEF = 16, 0.1
"""The most tasks that are sent together, and the seconds that these may take: to send some costs a millisecond."""

Task = TypeVar("Task")
Answer = TypeVar("Answer")


def cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def each(
    tasks: Iterable[Task], compute: Callable[[Task], Answer], processes: int, lost: Answer
) -> Generator[tuple[Task, Answer], None, None]:
    """Compute tasks in any order; close the iterator to stop.

    Args:
        tasks: asked for one after the other, when a process is free.
        compute: must go into another process (pickle), unless there are none.
        processes: of one thread each, so that no answer depends on how many there are; 0: this one, as it is.
        lost: the answer of a task whose process dies, even when nothing else is under way.

    Raises:
        RopewalkError: processes die before they compute anything.
    """
    return _side_by_side(iter(tasks), compute, processes, lost) if processes else ((at, compute(at)) for at in tasks)


def _side_by_side(
    ahead: Iterator[Task], compute: Callable[[Task], Answer], processes: int, lost: Answer
) -> Generator[tuple[Task, Answer], None, None]:
    """Tasks in several processes.

    A process that dies breaks its pool, and nobody knows which task was its last. Those that were under way are
    computed once more, each alone in a pool: there it is known. Something else may have killed it; it gets TRIES.
    Tasks that take milliseconds are sent some at a time.
    """
    suspects = deque[tuple[Task, int]]()  # and how often each has died alone
    together = 1
    waiting = list(islice(ahead, together))
    while waiting or suspects:
        alone = bool(suspects)
        size = 1 if alone else processes
        with _pool(size) as pool:
            running: dict[Future[tuple[list[Answer], float]], tuple[list[Task], int]] = {}
            broken = False
            while running or not broken:
                while not broken and len(running) < size and (suspects if alone else waiting):
                    tasks, died = ([suspects[0][0]], suspects[0][1]) if alone else (waiting, 0)
                    try:
                        running[_submit(pool, _computed, compute, tasks)] = tasks, died
                    except BrokenProcessPool:  # it has died since the last look
                        broken = True
                    else:
                        if alone:
                            suspects.popleft()
                        else:
                            waiting = list(islice(ahead, together))
                if not running:
                    break
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    tasks, died = running.pop(future)
                    if not isinstance(future.exception(), BrokenProcessPool):
                        answers, seconds = future.result()
                        together = max(1, min(CHUNK, int(BRIEF * len(tasks) / max(seconds, 1e-9))))
                        yield from zip(tasks, answers, strict=True)
                        continue
                    broken = True
                    if alone and died + 1 == TRIES:
                        yield tasks[0], lost
                    else:
                        suspects.extend((task, died + alone) for task in tasks)


def _computed(compute: Callable[[Task], Answer], tasks: list[Task]) -> tuple[list[Answer], float]:
    """Answers of some tasks, and the seconds that they took."""
    began = time.perf_counter()
    return [compute(task) for task in tasks], time.perf_counter() - began


@contextmanager
def _pool(size: int) -> Iterator[ProcessPoolExecutor]:
    """A pool whose processes have one thread each, and end with it, whatever they are doing."""
    for chance in range(BEGINNINGS):
        before = {process.pid for process in multiprocessing.active_children()}
        with _environment(dict.fromkeys(_THREADS, "1")):
            context = multiprocessing.get_context("spawn")
            with deferred():
                pool = ProcessPoolExecutor(size, mp_context=context, initializer=_begin)
            try:
                try:
                    _submit(pool, os.getpid).result()
                except BrokenProcessPool:
                    if chance + 1 < BEGINNINGS:  # it may have been killed
                        continue
                    raise RopewalkError(
                        "the processes that are to compute die as soon as they begin; a script must call this under  "
                        'if __name__ == "__main__":  , as for all processes in Python'
                    ) from None
                yield pool
                pool.shutdown()
                return
            finally:
                mine = [process for process in multiprocessing.active_children() if process.pid not in before]
                pool.shutdown(wait=False, cancel_futures=True)
                for process in mine:
                    process.terminate()
                for process in mine:
                    process.join()


def _submit(pool: ProcessPoolExecutor, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
    """Hand in a task; a process that this starts never sees the Ctrl-C that is meant for us."""
    with deferred():  # or what it reads first is not there
        if not hasattr(signal, "pthread_sigmask"):
            return pool.submit(function, *arguments)
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return pool.submit(function, *arguments)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _begin() -> None:
    """Make a new process ready: quiet, and gone when its parent is."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.simplefilter("ignore")
    parent = multiprocessing.parent_process()
    if parent is not None:
        _die_with(parent.pid or 0)
        threading.Thread(target=_leave_with, args=(parent,), daemon=True).start()


def _die_with(parent: int) -> None:
    """Have the kernel end this process with its parent, where it can: a thread waits for what holds the interpreter."""
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, signal.SIGKILL, 0, 0, 0)
        if os.getppid() != parent:
            os._exit(1)


def _leave_with(parent: Any) -> None:
    parent.join()
    os._exit(1)


@contextmanager
def _environment(settings: dict[str, str]) -> Iterator[None]:
    before = {name: os.environ.get(name) for name in settings}
    os.environ.update(settings)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
