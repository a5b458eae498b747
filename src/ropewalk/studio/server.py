"""The server of the studio: files of the page, and a WebSocket for each page that is open."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

import ropewalk
from ropewalk.errors import RopewalkError
from ropewalk.scenario import json_schema
from ropewalk.studio.folder import Folder
from ropewalk.studio.guard import Guard
from ropewalk.studio.lesson import lessons
from ropewalk.studio.pool import Message, Pool
from ropewalk.studio.session import LONG, Session
from ropewalk.studio.settings import Settings
from ropewalk.studio.share import PAGE
from ropewalk.studio.templates import templates

CHECK_SECONDS = 20.0
_LARGEST_NUMBER = 2**53  # of a question, which a page counts
_MOST_PAGES = 24
_COMPUTED = (*LONG, "prepare", "pose", "result", "lesson", "case", "resume")  # by the worker of a page
_KINDS = {"page": "text/html", "report": "text/html", "png": "image/png", "svg": "image/svg+xml",
          "pdf": "application/pdf", "csv": "text/csv", "zip": "application/zip", "gif": "image/gif", "mp4": "video/mp4",
          "xlsx": "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"}  # fmt: skip


class Studio:
    """What the routes share.

    Args:
        settings: how it was opened.
        token: the secret in the address.
    """

    def __init__(self, settings: Settings, token: str) -> None:
        self.settings, self.token = settings, token
        self.folder = Folder(settings.folder, settings.disk)
        self.pool, self.sessions = Pool(settings), dict[str, Session]()
        self._pages = asyncio.Semaphore(_MOST_PAGES)

    def app(self) -> Guard:
        """The application, behind its token."""
        not_built = PlainTextResponse("the page of the studio is not built: make studio", 503)
        routes = [
            Route("/export", self._export), WebSocketRoute("/socket", self._socket),
            Mount("/", StaticFiles(directory=PAGE, html=True, check_dir=False)),
        ]  # fmt: skip
        handlers = {RuntimeError: lambda *_: not_built}  # of the folder of the page, where there is none
        return Guard(Starlette(routes=routes, lifespan=self._lifespan, exception_handlers=handlers), self.token)

    @asynccontextmanager
    async def _lifespan(self, _: Starlette) -> AsyncIterator[None]:
        self.pool.start()
        yield
        await self.pool.close()

    async def _export(self, request: Request) -> Response:
        """A result as a file: /export?name=NAME.nc&as=page|report|png|svg|pdf|csv|zip|xlsx|gif|mp4."""
        name, kind = request.query_params.get("name", ""), request.query_params.get("as", "")
        if kind not in _KINDS:
            return PlainTextResponse(f"as: write one of {', '.join(_KINDS)}", 400)
        try:
            asked = {"id": 0, "do": "export", "name": name, "as": kind}
            if kind in ("gif", "mp4"):  # what takes long must not keep checks waiting
                process = self.pool.lease()
                try:
                    found = await process.ask(asked, within=600.0)
                finally:
                    await self.pool.give_back(process)
            else:
                found = await self.pool.check(asked, within=120.0)
        except RopewalkError as error:
            return PlainTextResponse(str(error), 500)
        if isinstance(found, str):
            answer = json.loads(found)
            return PlainTextResponse(answer.get("error") or answer["problems"][0]["message"], 400)
        stem = "".join(sign if sign.isalnum() or sign in "-_." else "_" for sign in Path(name).stem)
        file = f"{stem}{'.html' if kind in ('page', 'report') else f'.{kind}'}"
        disposition = {"Content-Disposition": f'attachment; filename="{file}"'}
        return Response(found, media_type=_KINDS[kind], headers=disposition)

    async def _socket(self, socket: WebSocket) -> None:
        if self._pages.locked():
            await socket.close(1013, "too many pages are open")
            return
        async with self._pages:
            await socket.accept()
            await PageConnection(self, socket).serve()


class PageConnection:
    """A page that is open: its WebSocket and its session."""

    def __init__(self, studio: Studio, socket: WebSocket) -> None:
        self._studio, self._socket = studio, socket
        self._session = Session(studio.pool, studio.sessions)
        self._tasks = set[asyncio.Task[None]]()
        self._sending = asyncio.Lock()

    async def serve(self) -> None:
        """Answer until the page closes."""
        try:
            with suppress(WebSocketDisconnect, RuntimeError):
                await self._listen()
        finally:  # whatever a page has sent, its worker is free again
            for task in self._tasks:
                task.cancel()
            self._session.leave()

    async def _listen(self) -> None:
        """Take questions until the page closes or sends what is none."""
        while True:
            try:
                asked = json.loads(await self._socket.receive_text())
                number, do = asked["id"], asked["do"]
                if not (isinstance(number, int) and abs(number) < _LARGEST_NUMBER and isinstance(do, str)):
                    raise ValueError("no number, or nothing to do")
            except (ValueError, KeyError, TypeError, RecursionError, MemoryError):
                await self._socket.close(1003, "not understood")
                break
            if do == "stop":
                self._session.stop()
            elif len(self._tasks) < 16:
                task = asyncio.create_task(self._answer(number, do, asked))
                self._tasks.add(task)
                task.add_done_callback(self._tasks.discard)
                await asyncio.sleep(0.0)  # it is begun: a stop that follows is of it
            else:
                await self._send(json.dumps({"id": number, "error": "too many requests at once"}))

    async def _send(self, message: Message) -> None:
        async with self._sending:
            if isinstance(message, str):
                await self._socket.send_text(message)
            else:
                await self._socket.send_bytes(message)

    async def _answer(self, number: int, do: str, asked: dict[str, Any]) -> None:
        try:
            found = await self._found(do, asked)
        except Exception as error:  # whatever a malformed question leads to costs its answer, not the page
            kind = "" if isinstance(error, RopewalkError) else f"not understood: {type(error).__name__}: "
            found = json.dumps({"id": number, "error": f"{kind}{error}"})
        with suppress(WebSocketDisconnect, RuntimeError):
            await self._send(found)

    async def _found(self, do: str, asked: dict[str, Any]) -> Message:
        studio = self._studio
        if do in _COMPUTED:
            return await self._session.ask(asked, self._send)
        if do == "check":
            return await studio.pool.check(asked, within=CHECK_SECONDS)
        found = await asyncio.to_thread(self._answered, do, asked)
        if do == "hello":
            self._session = await self._session.attach(str(asked.get("page", "")))
            found |= {"page": self._session.name, "under_way": self._session.under_way}
        return json.dumps({"id": asked["id"], **found})

    def _answered(self, do: str, asked: dict[str, Any]) -> dict[str, Any]:
        studio = self._studio
        if do == "hello":
            return {
                "version": ropewalk.__version__, "file": studio.settings.file, "code": studio.settings.allow_code,
                **studio.folder.files(), "templates": templates(), "lesson": lessons(),
            }  # fmt: skip
        if do == "schema":
            return {"schema": json_schema()}
        if do == "files":
            return studio.folder.files()
        if do == "read":
            return studio.folder.read(str(asked["name"]))
        if do == "save":
            return studio.folder.save(str(asked["name"]), str(asked["text"]), str(asked.get("stamp") or ""))
        raise RopewalkError(f"{do}: unknown request")
