"""Recording: every case and the same with half the elements, into one file per shard; it resumes after an interruption.

A shard file is a sequence of records, each its length and a compressed pickle. A record that a kill cut short is
ignored and computed again.
"""

from __future__ import annotations

import contextlib
import importlib
import multiprocessing as mp
import os
import pickle
import struct
import sys
import time
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from conformance.keys import furnish

from .answering import answer
from .cases import ReferenceCase
from .changes import half
from .observing import Observation

PATIENCE = 3600.0  # s for a case, after which it counts as crashed
SELDOM = 100  # cases between two lines of progress


@dataclass
class Record:
    """A case with its observation on the mesh as written and on half the elements; None where that cannot be had."""

    name: str
    full: Observation
    half: Observation | None


def record(case: ReferenceCase, halved: bool = True) -> Record:
    """Answer a case, and with half its elements where its answer is a result."""
    full = answer(lambda: case.tree, case.tool, case.options)
    coarse = half(case.tree) if halved and (full.quantities or full.numbers) else None
    return Record(case.name, full, answer(lambda: coarse or {}, case.tool, case.options) if coarse else None)


class Worker:
    """A process that records one case after another; a case that kills it or takes too long has crashed."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._process: mp.process.BaseProcess | None = None
        self._pipe: Connection | None = None

    def record(self, case: ReferenceCase, halved: bool) -> Record:
        """Record a case in the process, which is started anew if it has ended."""
        if self._process is None or not self._process.is_alive():
            self._start()
        assert self._pipe is not None
        assert self._process is not None
        self._pipe.send((case, halved))
        try:
            if self._pipe.poll(PATIENCE):
                found: Record = self._pipe.recv()
                return found
            note = f"no answer within {PATIENCE:g} s"
        except EOFError:
            note = "the process died"
        self._process.kill()
        self._process.join()
        return Record(case.name, Observation("crashed", 1, note, cpu=PATIENCE), None)

    def close(self) -> None:
        """End the process."""
        if self._process is not None and self._process.is_alive():
            self._process.kill()
            self._process.join()

    def _start(self) -> None:
        self._pipe, other = mp.Pipe()
        self._process = mp.get_context("spawn").Process(target=_serve, args=(other, self._folder))
        self._process.start()
        other.close()


def _serve(pipe: Connection, folder: Path) -> None:
    os.chdir(folder)
    with contextlib.suppress(ImportError):
        importlib.import_module("pythonfmu")  # before FMUs that ropewalk wrote bring their own
    while True:
        try:
            case, halved = pipe.recv()
        except EOFError:
            return
        pipe.send(record(case, halved))


def records(cases: Sequence[ReferenceCase], folder: Path, halved: bool, workers: int = 1) -> Iterator[Record]:
    """Record cases in worker processes, in any order."""
    from concurrent.futures import ThreadPoolExecutor
    from queue import SimpleQueue

    furnish(folder)
    free: SimpleQueue[Worker] = SimpleQueue()
    every = [Worker(folder) for _ in range(workers)]
    for worker in every:
        free.put(worker)

    def one(case: ReferenceCase) -> Record:
        worker = free.get()
        try:
            return worker.record(case, halved)
        finally:
            free.put(worker)

    try:
        with ThreadPoolExecutor(workers) as pool:
            yield from pool.map(one, cases)
    finally:
        for worker in every:
            worker.close()


def record_shard(cases: Sequence[ReferenceCase], file: Path, folder: Path, workers: int = 1) -> None:
    """Record the cases that a shard file lacks, and append them to it."""
    file.parent.mkdir(parents=True, exist_ok=True)
    done = {found.name for found in read(file)}
    missing = [case for case in cases if case.name not in done]
    begin, count = time.monotonic(), 0
    with file.open("ab") as store:
        for found in records(missing, folder, halved=True, workers=workers):
            append(store, found)
            count += 1
            if count % SELDOM == 0 or count == len(missing):
                print(f"{file.name}: {count} of {len(missing)}, {time.monotonic() - begin:.0f} s", flush=True)


def append(store: object, found: Record) -> None:
    """Append a record to an open shard file."""
    for observation in (found.full, found.half):
        if observation is not None:
            observation.quantities = {k: np.asarray(v, dtype=np.float64) for k, v in observation.quantities.items()}
    data = zlib.compress(pickle.dumps(found), 6)
    store.write(struct.pack("<I", len(data)) + data)  # type: ignore[attr-defined]
    store.flush()  # type: ignore[attr-defined]


def read(file: Path) -> Iterator[Record]:
    """Return the complete records of a shard file; what a kill cut short is removed."""
    if not file.exists():
        return
    data, at = file.read_bytes(), 0
    while at + 4 <= len(data):
        (size,) = struct.unpack_from("<I", data, at)
        if at + 4 + size > len(data):
            break
        yield pickle.loads(zlib.decompress(data[at + 4 : at + 4 + size]))
        at += 4 + size
    if at < len(data):
        print(f"{file}: an incomplete record is removed", file=sys.stderr)
        with file.open("r+b") as store:
            store.truncate(at)
