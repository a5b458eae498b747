"""Points computed one after another, or side by side in processes of their own that may die."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Any

from ropewalk.compare.points import Outcome, Place
from ropewalk.errors import RopewalkError

DIED = (
    "the process that computed it died: killed from outside, out of memory, or a crash of compiled code; "
    "--retry computes it again"
)
# One thread for each process: the points themselves fill the cores.
_THREADS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

Compute = Callable[[Place], Outcome]
Outcomes = Generator[tuple[Place, Outcome], None, None]


def cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def each(places: Iterable[Place], compute: Compute, workers: int) -> Outcomes:
    """Compute points in any order; close the iterator to stop.

    Args:
        places: the points.
        compute: must go into another process (pickle) where there are several workers.
        workers: processes; 1: this one.

    Raises:
        RopewalkError: processes die before they compute anything.
    """
    return _side_by_side(deque(places), compute, workers) if workers > 1 else ((at, compute(at)) for at in places)


def _side_by_side(waiting: deque[Place], compute: Compute, workers: int) -> Outcomes:
    """Points in several processes.

    A process that dies breaks its pool, and nobody knows which point was its last. Those that were under way are
    computed once more, each alone in a pool: there it is known.
    """
    suspects: deque[Place] = deque()
    while waiting or suspects:
        queue, size = (suspects, 1) if suspects else (waiting, workers)
        with _pool(size) as pool:
            running: dict[Future[Outcome], Place] = {}
            lost, broken = list[Place](), False
            while running or (queue and not broken):
                while queue and not broken and len(running) < size:
                    try:
                        running[_submit(pool, compute, queue[0])] = queue[0]
                        queue.popleft()
                    except BrokenProcessPool:  # it has died since the last look
                        broken = True
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    place = running.pop(future)
                    if isinstance(future.exception(), BrokenProcessPool):
                        lost.append(place)
                        broken = True
                    else:
                        yield place, future.result()
        if size == 1:
            yield from ((place, Outcome(reason=DIED)) for place in lost)
        else:
            suspects.extend(lost)


@contextmanager
def _pool(size: int) -> Iterator[ProcessPoolExecutor]:
    """A pool whose processes have one thread each, and end with it, whatever they are doing."""
    before = {process.pid for process in multiprocessing.active_children()}
    with _environment(dict.fromkeys(_THREADS, "1")):
        context = multiprocessing.get_context("spawn")
        pool = ProcessPoolExecutor(size, mp_context=context, initializer=_begin)
        try:
            try:
                _submit(pool, os.getpid).result()
            except BrokenProcessPool:
                raise RopewalkError(
                    "processes for the points die as soon as they begin; a script must call this under  "
                    'if __name__ == "__main__":  , and workers=1 (--workers 1) does without them'
                ) from None
            yield pool
            pool.shutdown()
        finally:
            mine = [process for process in multiprocessing.active_children() if process.pid not in before]
            pool.shutdown(wait=False, cancel_futures=True)
            for process in mine:
                process.terminate()
            for process in mine:
                process.join()


def _submit(pool: ProcessPoolExecutor, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
    """Hand in a task; a process that this starts never sees the Ctrl-C that is meant for us."""
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
        threading.Thread(target=_leave_with, args=(parent,), daemon=True).start()


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
