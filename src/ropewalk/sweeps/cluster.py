"""Cases on a Dask cluster, sent in chunks; workers may come, go and die."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from itertools import islice
from typing import Any, TypeVar

from ropewalk.errors import RopewalkError

Task = TypeVar("Task")
Answer = TypeVar("Answer")
CHUNK = 8
"""The most cases that are sent together: sending costs milliseconds, what is lost with a worker is computed again."""
PATIENCE = 10.0
"""Seconds that a scheduler has to answer."""
AHEAD = 2
"""Chunks for each thread that are under way or wait at the scheduler."""


def each_on(
    cluster: Any, tasks: Iterable[Task], count: int, compute: Callable[[Task], Answer], lost: Answer
) -> Generator[tuple[Task, Answer], None, None]:
    """Compute tasks on a cluster in any order; close the iterator to stop.

    A chunk whose workers die again and again (Dask gives up after some) is sent case by case, and then alone, for
    others may have been to blame; what kills its workers then is lost.

    Args:
        cluster: address of a scheduler, as tcp://host:8786, or a client.
        tasks: asked for one after the other, as threads are free.
        count: of tasks, about.
        compute: a function that the workers can import.
        lost: the answer of a task that its workers do not survive.

    Raises:
        RopewalkError: dask.distributed is not installed, the scheduler cannot be reached, or goes away.
    """
    try:
        from distributed import Client
    except ImportError:
        raise RopewalkError(
            "dask.distributed is not installed: pip install 'ropewalk[cluster]', or leave the cluster out"
        ) from None
    if not isinstance(cluster, str):
        yield from _sent(cluster, iter(tasks), count, compute, lost)
        return
    try:
        client = Client(cluster, timeout=PATIENCE)
    except (OSError, ValueError, TimeoutError) as error:
        raise RopewalkError(f"the cluster at {cluster} cannot be reached ({error})") from None
    try:
        yield from _sent(client, iter(tasks), count, compute, lost)
    finally:
        client.close(timeout=2)


def _sent(
    client: Any, tasks: Iterator[Task], count: int, compute: Callable[[Task], Answer], lost: Answer
) -> Generator[tuple[Task, Answer], None, None]:
    from distributed import KilledWorker, wait
    from distributed.client import FutureCancelledError
    from distributed.comm.core import CommClosedError

    under_way: dict[Any, tuple[list[Task], bool]] = {}  # and whether nothing else is
    singles, suspects = list[Task](), list[Task]()
    try:
        while True:
            threads = max(1, sum(client.nthreads().values()))
            size = min(max(count // (4 * threads), 1), CHUNK)
            for _ in range(max(AHEAD * threads - len(under_way), 0)):
                chunk = [singles.pop()] if singles else list(islice(tasks, size))
                if alone := not chunk and not under_way and bool(suspects):
                    chunk = [suspects.pop()]
                if not chunk:
                    break
                under_way[client.submit(_chunk, compute, chunk, pure=False)] = chunk, alone
                if alone:
                    break
            if not under_way:
                return
            for future in wait(list(under_way), return_when="FIRST_COMPLETED").done:
                chunk, alone = under_way.pop(future)
                try:  # not its status: a worker that dies after the wait takes its answer with it, to be computed again
                    answers = future.result()
                except KilledWorker:
                    if alone:
                        yield chunk[0], lost
                    elif len(chunk) > 1:
                        singles += chunk
                    else:
                        suspects += chunk
                    continue
                yield from zip(chunk, answers, strict=True)
    except (CommClosedError, FutureCancelledError, OSError) as error:
        raise RopewalkError(
            f"the cluster is lost ({type(error).__name__}); with a store, the same call continues the sweep"
        ) from None
    finally:
        if under_way:
            client.cancel(list(under_way), force=True)


def _chunk(compute: Callable[[Task], Answer], tasks: list[Task]) -> list[Answer]:
    return [compute(task) for task in tasks]
