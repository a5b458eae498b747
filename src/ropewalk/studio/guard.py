"""Who may speak to the studio: pages that it has served itself, on this machine, that know the token."""

from __future__ import annotations

import secrets

from starlette.datastructures import Headers
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send

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
"""Headers of every answer, which the server adds."""
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

    def __init__(self, app: ASGIApp, token: str, port: int = 0) -> None:
        self._app, self._token, self.port = app, token, port

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request through, or refuse it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        first, _, rest = str(scope["path"]).removeprefix("/").partition("/")
        if not self._is_ours(Headers(scope=scope), needs_origin=scope["type"] == "websocket"):
            await PlainTextResponse("this page is served to this machine only", 403)(scope, receive, send)
        elif not secrets.compare_digest(first.encode(), self._token.encode()):
            await PlainTextResponse(_NO_TOKEN, 403)(scope, receive, send)
        else:
            await self._app({**scope, "path": f"/{rest}", "raw_path": f"/{rest}".encode()}, receive, send)

    def _is_ours(self, headers: Headers, *, needs_origin: bool) -> bool:
        host, origin = headers.get("host", ""), headers.get("origin")
        if host not in (f"127.0.0.1:{self.port}", f"localhost:{self.port}"):
            return False
        return not needs_origin if origin is None else origin == f"http://{host}"
