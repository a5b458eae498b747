"""Worker processes as the server sees them: leased to pages, stopped when these close, ended when they hang."""

from __future__ import annotations

import asyncio
import multiprocessing
import pickle
import threading
from collections import deque
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from ropewalk.errors import RopewalkError
from ropewalk.studio.settings import Settings
from ropewalk.studio.worker import Kind, main

Message = str | bytes
Forward = Callable[[Message], Awaitable[None]]

PATIENCE = 0.7  # s that a worker may take to acknowledge a stop; it does not while it compiles or sets up a run
LONG_PATIENCE = 30.0  # s that it may take to complete its result, or the case of a sweep
_FAREWELL = 0.4  # s, that all workers have when the server ends
_CONTEXT = multiprocessing.get_context("spawn")


class WorkerEnded(RopewalkError):
    """A worker ended before it had answered."""


@dataclass
class _Question:
    answer: asyncio.Future[Message]
    forward: Forward | None


class Process:
    """A worker process, and the threads that write to it and read from it."""

    def __init__(self, settings: Settings) -> None:
        self._loop = asyncio.get_running_loop()
        self._pipe, theirs = _CONTEXT.Pipe()
        self._process = _CONTEXT.Process(target=main, args=(theirs, settings))  # no daemon: these begin no sweeps
        self._process.start()
        theirs.close()
        self._ended, self._is_stopping = "", False
        self._open, self._writer = deque[_Question](), ThreadPoolExecutor(1)  # sent one by one, answered in that order
        threading.Thread(target=self._read, daemon=True).start()

    @property
    def is_alive(self) -> bool:
        """Whether it can be asked."""
        return not self._ended and self._process.is_alive()

    async def ask(self, asked: dict[str, Any], forward: Forward | None = None, within: float | None = None) -> Message:
        """Ask, and wait for the answer.

        Args:
            asked: what to do, with its number on the page as `id`.
            forward: takes messages that come before the last one; as long as it has not done so, no more are read.
            within: s; a worker that has not answered then is ended.

        Raises:
            WorkerEnded: it has ended, or did not answer in time.
        """
        question = _Question(self._loop.create_future(), forward)
        self._put(asked)
        self._open.append(question)  # before anything is awaited: a stop may follow at once
        try:
            return await asyncio.wait_for(asyncio.shield(question.answer), within)
        except TimeoutError:
            self.kill("the computation took too long and was ended")
            raise WorkerEnded(f"no answer within {within:g} s; the computation was ended") from None

    async def stop(self, patience: float = PATIENCE) -> None:
        """Stop the computation; end the process if it does not acknowledge that within `patience`, s."""
        if self._ended or not self._open:
            return
        self._is_stopping = False
        self._put({"do": "stop"})
        _, late = await asyncio.wait([question.answer for question in self._open], timeout=patience)
        if late and self._is_stopping:
            _, late = await asyncio.wait(late, timeout=LONG_PATIENCE)
        if late:
            self.kill("stopped")

    async def abandon(self) -> None:
        """Stop what it does for a page that has gone."""
        for question in self._open:
            question.forward = None
        await self.stop(LONG_PATIENCE)

    def kill(self, why: str = "the studio has ended") -> None:
        """End it at once; a result that it writes stays readable.

        Args:
            why: answer to the questions that are still open.
        """
        self._ended = why
        self._process.kill()

    def _put(self, asked: dict[str, Any]) -> None:
        if self._ended:
            raise WorkerEnded(self._ended)
        self._writer.submit(self._pipe.send_bytes, pickle.dumps(asked))

    def _read(self) -> None:
        with suppress(EOFError, OSError, RuntimeError):  # the last one: the loop has ended
            while not self._ended:
                asyncio.run_coroutine_threadsafe(self._take(*self._pipe.recv()), self._loop).result()
        with suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._fail)

    async def _take(self, kind: Kind, message: Message) -> None:
        """Pass a message on to whoever asked the question that is answered now."""
        self._is_stopping |= kind == "stopped"
        if kind == "answer":
            self._open.popleft().answer.set_result(message)
        elif (forward := self._open[0].forward) is not None:
            with suppress(Exception):
                await forward(message)

    def _fail(self) -> None:
        self._ended = self._ended or "the computing process has ended, possibly for lack of memory"
        while self._open:
            answer = self._open.popleft().answer
            answer.set_exception(WorkerEnded(self._ended))
            answer.exception()  # it may be that nobody waits any more


class Pool:
    """Worker processes: one for checks, which all pages share, and one for each page that computes.

    Args:
        settings: of the workers, and how many pages may compute.
    """

    def __init__(self, settings: Settings) -> None:
        self.settings, self._leased = settings, list[Process]()
        self._idle: Process | None = None
        self._checker: Process | None = None
        self._checking = asyncio.Lock()

    def start(self) -> None:
        """Begin with the one that the first page needs; a second one would take the same time from it."""
        self._idle = Process(self.settings)

    async def check(self, asked: dict[str, Any], within: float) -> Message:
        """Let the worker of all pages answer.

        Raises:
            WorkerEnded: it took too long, or too much memory.
        """
        async with self._checking:
            if self._checker is None or not self._checker.is_alive:
                self._checker = Process(self.settings)
            return await self._checker.ask(asked, within=within)

    def lease(self) -> Process:
        """A worker for a page.

        Raises:
            RopewalkError: there are too many.
        """
        self._leased = [one for one in self._leased if one.is_alive]
        if len(self._leased) >= self.settings.most:
            raise RopewalkError(f"{self.settings.most} pages are computing; close one of them")
        found, self._idle = self._idle, None
        if found is None or not found.is_alive:
            found = Process(self.settings)
        self._leased.append(found)
        return found

    async def give_back(self, process: Process) -> None:
        """Take a worker back from a page that has gone."""
        await process.abandon()
        if process in self._leased:
            self._leased.remove(process)
        if process.is_alive and self._idle is None:
            self._idle = process
        else:
            process.kill()

    async def close(self) -> None:
        """Stop all, in time for what they write."""
        with suppress(TimeoutError):
            await asyncio.wait_for(asyncio.gather(*(one.abandon() for one in self._everyone())), _FAREWELL)
        self.kill()

    def kill(self) -> None:
        """End all at once."""
        for one in self._everyone():
            one.kill()

    def _everyone(self) -> list[Process]:
        return [one for one in (*self._leased, self._idle, self._checker) if one is not None]
