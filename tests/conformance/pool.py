"""Workers that answer cases side by side; a case that kills its worker, or takes too long, has crashed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterable
from pathlib import Path
from queue import Empty, Queue

from .cases import Case
from .judging import CRASH
from .structures import Tree

PATIENCE = 600.0  # s for a case, compiling included


class Worker:
    """A process that answers one case after the other, started again where one of them has killed it."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._process: subprocess.Popen[str] | None = None

    def answer(self, case: Case) -> Tree:
        """The verdict on a case."""
        if self._process is None:
            self._begin()
        process = self._process
        assert process is not None
        assert process.stdin is not None
        assert process.stdout is not None
        late = threading.Event()

        def give_up() -> None:
            late.set()
            process.kill()

        timer = threading.Timer(PATIENCE, give_up)
        timer.start()
        try:
            question = {"scenario": case.scenario, "tool": case.tool, "options": case.options}
            process.stdin.write(json.dumps(question) + "\n")
            process.stdin.flush()
            text = process.stdout.readline()
        except BrokenPipeError:
            text = ""
        finally:
            timer.cancel()
        if text:
            found: Tree = json.loads(text)
            return found
        code = process.wait()
        self._process = None
        self._errors.seek(0)
        message = self._errors.read()[-300:].strip()
        note = f"no answer within {PATIENCE:g} s" if late.is_set() else f"the process died ({code}): {message}"
        return {"verdict": CRASH, "note": note, "numbers": {}, "trace": {}, "cpu": 0.0}

    def close(self) -> None:
        """Let the process go."""
        if self._process is not None and self._process.stdin is not None:
            self._process.stdin.close()
            self._process.wait()

    def _begin(self) -> None:
        self._errors = tempfile.TemporaryFile("w+", errors="replace")  # noqa: SIM115 - lives as long as the process
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1",
                       "MPLBACKEND": "Agg"}  # fmt: skip
        self._process = subprocess.Popen(
            [sys.executable, "-m", f"{__package__}.working", str(self._folder)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors, text=True, env=environment,
        )  # fmt: skip


def answers(cases: Iterable[Case], folder: Path, workers: int, message: Callable[[Case, Tree], None]) -> None:
    """Answer all cases; `message` is called with each as it is done, by one thread at a time."""
    queue: Queue[Case] = Queue()
    for case in cases:
        queue.put(case)
    lock = threading.Lock()

    def work() -> None:
        worker = Worker(folder)
        try:
            while True:
                try:
                    case = queue.get_nowait()
                except Empty:
                    return
                found = worker.answer(case)
                with lock:
                    message(case, found)
        finally:
            worker.close()

    threads = [threading.Thread(target=work, daemon=True) for _ in range(workers)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
