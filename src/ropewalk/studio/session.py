"""Sessions: the worker of a page, which outlives a reload of that page while it computes."""

from __future__ import annotations

import asyncio
import secrets
from typing import Any

from ropewalk.errors import RopewalkError
from ropewalk.studio.pool import LONG_PATIENCE, PATIENCE, Forward, Message, Pool, Process

LONG = ("run", "release", "sweep", "models")  # computations that continue while their page is reloaded
GRACE = 10.0  # s for which a computation continues without its page
_HANDOVER = 10  # tenths of a second that a reloaded page waits until its old connection is closed


class Session:
    """The worker of one page and the computation that it has under way.

    Args:
        pool: of workers.
        known: sessions of all pages, by names that the pages keep over a reload; gets this one.
    """

    def __init__(self, pool: Pool, known: dict[str, Session]) -> None:
        self.name = secrets.token_urlsafe(9)
        self.under_way: dict[str, Any] | None = None
        """The question whose answer the page does not have yet, with the text that it is about."""
        self._pool, self._known = pool, known
        self._ending: asyncio.Task[None] | None = None  # while no page is attached
        self._process: Process | None = None
        self._stopping: asyncio.Task[None] | None = None
        self._answer: asyncio.Task[Message] | None = None  # to the question that is under way
        self._text = dict[str, Any]()
        self._sent, self._page = list[Message](), None  # type: tuple[list[Message], Forward | None]
        known[self.name] = self

    async def ask(self, asked: dict[str, Any], page: Forward) -> Message:
        """Return the answer of the worker.

        Args:
            asked: question, as the page sent it; `resume`: the one that is under way, from its first message on.
            page: takes the messages before the answer.

        Raises:
            RopewalkError: too many pages compute, the worker has ended, or nothing is under way.
        """
        if self._stopping is not None:
            await asyncio.shield(self._stopping)
        if asked["do"] != "resume":
            if self._process is None or not self._process.is_alive:
                self._process = self._pool.lease()
            self._text = {key: asked[key] for key in ("text", "name") if key in asked} or self._text
            if asked["do"] not in LONG or self._answer is not None:
                behind = 0.0 if self._answer is None else self._pool.settings.seconds  # of what is under way
                return await self._process.ask(asked, page, within=600.0 + behind)
            self._begin(self._process, asked)
        if (answer := self._answer) is None:
            raise RopewalkError("no computation is running")
        for message in self._sent:  # it may grow meanwhile
            await page(message)
        self._page = page
        try:
            return await asyncio.shield(answer)
        finally:
            if answer.done() and self._ending is None:
                self.under_way, self._answer, self._page, self._sent = None, None, None, []

    def _begin(self, process: Process, asked: dict[str, Any]) -> None:
        self.under_way = {**self._text, **asked}
        self._answer = asyncio.create_task(process.ask(asked, self._forward, within=self._pool.settings.seconds))
        self._answer.add_done_callback(lambda task: task.cancelled() or task.exception())  # may go unread

    async def _forward(self, message: Message) -> None:
        self._sent.append(message)
        if self._page is not None:
            await self._page(message)

    def stop(self) -> None:
        """Stop what is computed."""
        if self._process is not None and (self._stopping is None or self._stopping.done()):
            is_sweep = self.under_way is not None and self.under_way["do"] == "sweep"  # which listens between cases
            self._stopping = asyncio.create_task(self._process.stop(LONG_PATIENCE if is_sweep else PATIENCE))

    async def attach(self, name: str) -> Session:
        """Return the session that a page had before it was reloaded, to use instead of this one; this one if none."""
        for _ in range(_HANDOVER):
            session = self._known.get(name, self)
            if session._ending is not None:
                session._ending.cancel()
                session._ending = None
                self.leave()
                return session
            if session is self:
                break
            await asyncio.sleep(0.1)
        return self

    def leave(self) -> None:
        """Continue without a page for a while if something is computed, then give the worker back."""
        self._page = None
        self._ending = asyncio.create_task(self._end())

    async def _end(self) -> None:
        if self.under_way is not None:
            await asyncio.sleep(GRACE)
        del self._known[self.name]
        if self._process is not None:
            await self._pool.give_back(self._process)
