"""Sessions: the worker of a page, which outlives a reload of that page while it computes."""

from __future__ import annotations

import asyncio
import secrets
from typing import Any

from ropewalk.studio.pool import LONG_PATIENCE, PATIENCE, Forward, Message, Pool, Process

LONG = ("run", "release", "sweep", "models")  # computations that continue while their page is reloaded
GRACE = 10.0  # s for which a computation continues without its page
_HANDOVER = 10  # tenths of a second that a reloaded page waits until its old connection is closed


class Session:
    """The worker of one page and the computation that it has under way."""

    def __init__(self, pool: Pool, seconds: float) -> None:
        self.ending: asyncio.Task[None] | None = None  # while no page is attached
        self._pool, self._seconds = pool, seconds
        self._process: Process | None = None
        self._stopping: asyncio.Task[None] | None = None
        self._answer: asyncio.Task[Message] | None = None
        self._asked, self._text = dict[str, Any](), dict[str, Any]()
        self._sent, self._page = list[Message](), None  # type: tuple[list[Message], Forward | None]

    @property
    def under_way(self) -> dict[str, Any] | None:
        """The question whose answer the page does not have yet, with the text that it is about."""
        return None if self._answer is None else {**self._text, **self._asked}

    async def ask(self, asked: dict[str, Any], page: Forward) -> Message:
        """Return the answer of the worker.

        Args:
            asked: question, as the page sent it; `resume`: the one that is under way, from its first message on.
            page: takes the messages before the answer.

        Raises:
            RopewalkError: too many pages compute, or the worker has ended.
        """
        if self._stopping is not None:
            await asyncio.shield(self._stopping)
        if asked["do"] != "resume" or self._answer is None:
            if self._process is None or not self._process.is_alive:
                self._process = self._pool.lease()
            self._text = {key: asked[key] for key in ("text", "name") if key in asked} or self._text
            if asked["do"] not in LONG or self._answer is not None:
                return await self._process.ask(asked, page, within=600.0)
            self._asked = asked
            self._answer = asyncio.create_task(self._process.ask(asked, self._forward, within=self._seconds))
            self._answer.add_done_callback(lambda task: task.cancelled() or task.exception())  # may go unread
        for message in self._sent:  # it may grow meanwhile
            await page(message)
        self._page = page
        try:
            return await asyncio.shield(self._answer)
        finally:
            if self._answer.done() and self.ending is None:
                self._answer, self._page, self._sent = None, None, []

    async def _forward(self, message: Message) -> None:
        self._sent.append(message)
        if self._page is not None:
            await self._page(message)

    def stop(self) -> None:
        """Stop what is computed."""
        if self._process is not None and (self._stopping is None or self._stopping.done()):
            patience = LONG_PATIENCE if self._asked.get("do") == "sweep" else PATIENCE  # a sweep listens between cases
            self._stopping = asyncio.create_task(self._process.stop(patience))

    async def end(self) -> None:
        """Continue without a page for a while if something is computed, then give the worker back."""
        self._page = None
        if self._answer is not None:
            await asyncio.sleep(GRACE)
            self._answer.cancel()
        if self._process is not None:
            await self._pool.give_back(self._process)


class Sessions:
    """Sessions of all pages, by names that the pages keep over a reload.

    Args:
        pool: of workers.
        seconds: of the longest computation.
    """

    def __init__(self, pool: Pool, seconds: float) -> None:
        self._pool, self._seconds = pool, seconds
        self._waiting = dict[str, Session]()  # of pages that have closed
        self._attached = set[str]()

    async def attach(self, name: str) -> tuple[str, Session]:
        """Return the session of a page that was reloaded, or a new one with its name."""
        for _ in range(_HANDOVER):
            if name not in self._attached:
                break
            await asyncio.sleep(0.1)
        found = self._waiting.pop(name, None)
        if found is None or (found.ending is not None and found.ending.done()):
            name, found = secrets.token_urlsafe(9), Session(self._pool, self._seconds)
        if found.ending is not None:
            found.ending.cancel()
            found.ending = None
        self._attached.add(name)
        return name, found

    def detach(self, name: str, session: Session) -> None:
        """Keep the session of a page that has closed for a while if it computes; end it otherwise."""
        self._attached.discard(name)
        self._waiting[name] = session
        session.ending = asyncio.create_task(session.end())
        session.ending.add_done_callback(lambda task: task.cancelled() or self._waiting.pop(name, None))
