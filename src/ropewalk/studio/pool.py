"""Worker processes as the server sees them: leased to pages, stopped when these close, ended when they hang."""

from __future__ import annotations

import asyncio
import multiprocessing
import threading
from collections.abc import Awaitable, Callable
from contextlib import suppress
from typing import Any

from ropewalk.errors import RopewalkError
from ropewalk.studio.settings import Settings
from ropewalk.studio.worker import main

Message = str | bytes
Forward = Callable[[Message], Awaitable[None]]

PATIENCE = 0.7  # s that a worker may take to acknowledge a stop; it does not while it compiles or sets up a run
LONG_PATIENCE = 30.0  # s that it may take to complete its result, or the case of a sweep
_FAREWELL = 0.4  # s, that all workers have when the server ends
_CONTEXT = multiprocessing.get_context("spawn")


class WorkerEnded(RopewalkError):
    """A worker ended before it had answered."""


class Process:
    """A worker process, and the thread that reads from it."""

    def __init__(self, settings: Settings) -> None:
        self._loop = asyncio.get_running_loop()
        self._pipe, theirs = _CONTEXT.Pipe()
        self._process = _CONTEXT.Process(target=main, args=(theirs, settings))  # no daemon: these begin no sweeps
        self._process.start()
        theirs.close()
        self._number, self._sending = 0, threading.Lock()
        self._ended, self._acknowledged = "", asyncio.Event()
        self._waiting: dict[int, tuple[asyncio.Future[Message], Forward | None]] = {}
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def is_alive(self) -> bool:
        """Whether it can be asked."""
        return not self._ended and self._process.is_alive()

    @property
    def is_idle(self) -> bool:
        """Whether it has answered all."""
        return not self._waiting

    async def ask(self, asked: dict[str, Any], forward: Forward | None = None, within: float | None = None) -> Message:
        """Ask, and wait for the answer.

        Args:
            asked: what to do, with its number on the page as `id`.
            forward: takes messages that come before the last one; as long as it has not done so, no more are read.
            within: s; a worker that has not answered then is ended.

        Raises:
            WorkerEnded: it has ended, or did not answer in time.
        """
        self._number += 1
        number, future = self._number, self._loop.create_future()
        self._waiting[number] = future, forward
        try:
            try:
                await self._loop.run_in_executor(None, self._put, {**asked, "ticket": number})
            except (ValueError, TypeError, RecursionError):  # it cannot be sent: there will be no answer
                self._waiting.pop(number)
                raise
            return await asyncio.wait_for(asyncio.shield(future), within)
        except TimeoutError:
            self.kill("the computation took too long and was ended")
            raise WorkerEnded(f"no answer within {within:g} s; the computation was ended") from None
        except OSError:
            raise WorkerEnded("the computing process has ended") from None

    def tell(self, do: str) -> None:
        """Say something that has no answer."""
        with suppress(OSError):
            self._put({"id": 0, "ticket": 0, "do": do})

    async def stop(self, patience: float = PATIENCE) -> None:
        """Stop the computation; end the process if it does not acknowledge that within `patience`, s."""
        if self.is_idle:
            return
        self._acknowledged.clear()
        self.tell("stop")
        futures = [future for future, _ in self._waiting.values()]
        _, late = await asyncio.wait(futures, timeout=patience)
        if late and self._acknowledged.is_set():
            _, late = await asyncio.wait(late, timeout=LONG_PATIENCE)
        if late:
            self.kill("stopped")

    async def abandon(self) -> None:
        """Stop what it does for a page that has gone."""
        self._waiting = {number: (future, None) for number, (future, _) in self._waiting.items()}
        await self.stop(LONG_PATIENCE)
        self._waiting.clear()

    def kill(self, why: str = "the studio has ended") -> None:
        """End it at once; a result that it writes stays readable.

        Args:
            why: answer to the questions that are still open.
        """
        self._ended = why
        self._process.kill()

    def _put(self, asked: dict[str, Any]) -> None:
        with self._sending:
            self._pipe.send(asked)

    def _read(self) -> None:
        with suppress(EOFError, OSError, RuntimeError):  # the last one: the loop has ended
            while True:
                number, last, message = self._pipe.recv()
                forward = self._waiting.get(number, (None, None))[1]
                if number < 0:
                    self._loop.call_soon_threadsafe(self._acknowledged.set)
                elif last:
                    self._loop.call_soon_threadsafe(self._resolve, number, message)
                elif forward is not None:
                    with suppress(Exception):
                        asyncio.run_coroutine_threadsafe(_forwarded(forward, message), self._loop).result()
        with suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._fail)

    def _resolve(self, number: int, message: Message) -> None:
        future, _ = self._waiting.pop(number, (None, None))
        if future is not None and not future.done():
            future.set_result(message)

    def _fail(self) -> None:
        for future, _ in self._waiting.values():
            if not future.done():
                why = self._ended or "the computing process has ended, possibly for lack of memory"
                future.set_exception(WorkerEnded(why))
                future.exception()  # it may be that nobody waits any more


async def _forwarded(forward: Forward, message: Message) -> None:
    await forward(message)


class Pool:
    """Worker processes: one for checks, which all pages share, and one for each page that computes.

    Args:
        settings: of the workers, and how many pages may compute.
    """

    def __init__(self, settings: Settings) -> None:
        self._settings, self._idle, self._leased = settings, list[Process](), list[Process]()
        self._checker: Process | None = None
        self._checking = asyncio.Lock()

    def start(self) -> None:
        """Begin with the one that the first page needs; a second one would take the same time from it."""
        self._idle.append(Process(self._settings))

    async def check(self, asked: dict[str, Any], within: float) -> Message:
        """Let the worker of all pages answer.

        Raises:
            WorkerEnded: it took too long, or too much memory.
        """
        async with self._checking:
            if self._checker is None or not self._checker.is_alive:
                self._checker = Process(self._settings)
            return await self._checker.ask(asked, within=within)

    def lease(self) -> Process:
        """A worker for a page.

        Raises:
            RopewalkError: there are too many.
        """
        self._leased = [one for one in self._leased if one.is_alive]
        self._idle = [one for one in self._idle if one.is_alive]
        if not self._idle and len(self._leased) >= self._settings.most:
            raise RopewalkError(f"{self._settings.most} pages are computing; close one of them")
        found = self._idle.pop() if self._idle else Process(self._settings)
        self._leased.append(found)
        return found

    async def give_back(self, process: Process) -> None:
        """Take a worker back from a page that has gone."""
        await process.abandon()
        if process in self._leased:
            self._leased.remove(process)
        if process.is_alive and not self._idle:
            self._idle.append(process)
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
        return [*self._leased, *self._idle, *([self._checker] if self._checker else [])]
