"""Who may speak to the studio: pages that it has served itself, on this machine, that know the token."""

from __future__ import annotations

import secrets
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

HEADERS = {
    "Content-Security-Policy": "default-src 'self'; connect-src 'self' ws://127.0.0.1:* ws://localhost:*; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}


_NO_TOKEN = "open the address that `ropewalk studio` has printed: it ends in a token"


class Guard:
    """An application behind a token, which is the first part of every path.

    The host must be this machine's own: a name of somebody's that leads here (DNS rebinding) is refused. The origin, if
    the browser tells one, must be the page's own, and a WebSocket must tell one: other pages cannot open it.

    Args:
        app: what is guarded.
        token: the secret in the address.
        port: on which it listens; 0: any.
    """

    def __init__(self, app: App, token: str, port: int = 0) -> None:
        self._app, self._token, self.port = app, token, port

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request through, or refuse it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        path = str(scope["path"])
        first, _, rest = path.removeprefix("/").partition("/")
        if not self._is_ours(headers, needs_origin=scope["type"] == "websocket"):
            await _refuse(scope, receive, send, 403, "this page is served to this machine only")
        elif not secrets.compare_digest(first.encode(), self._token.encode()):
            await _refuse(scope, receive, send, 403, _NO_TOKEN)
        else:
            inner = {**scope, "path": f"/{rest}", "raw_path": f"/{rest}".encode()}
            await self._app(inner, receive, _with_headers(send))

    def _is_ours(self, headers: dict[str, str], *, needs_origin: bool) -> bool:
        hosts = [f"127.0.0.1:{self.port}", f"localhost:{self.port}"]
        host, origin = headers.get("host", ""), headers.get("origin")
        if host not in hosts:
            return False
        return not needs_origin if origin is None else origin == f"http://{host}"


def _with_headers(send: Send) -> Send:
    async def sent(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            given = [(name.encode(), value.encode()) for name, value in HEADERS.items()]
            message = {**message, "headers": [*message.get("headers", []), *given]}
        await send(message)

    return sent


async def _refuse(scope: Scope, receive: Receive, send: Send, status: int, why: str) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008, "reason": why[:120]})
        return
    headers = [(b"content-type", b"text/plain; charset=utf-8")]
    await _with_headers(send)({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": why.encode()})
