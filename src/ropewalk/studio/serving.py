"""The server put to work: a socket on 127.0.0.1, a token, and the address for the browser."""

from __future__ import annotations

import os
import re
import secrets
import socket
import webbrowser

import uvicorn

from ropewalk.cli.console import fail, say
from ropewalk.studio.guard import HEADERS
from ropewalk.studio.server import Studio
from ropewalk.studio.settings import Settings
from ropewalk.studio.share import PAGE

__all__ = ["Settings", "serve"]
TOKEN = "ROPEWALK_STUDIO_TOKEN"
"""Variable of the environment with the token, so that pages find a studio again that was started anew."""
_MOST_CONNECTIONS = 64
_LARGEST_MESSAGE = 2_000_000  # bytes, from a page


def serve(settings: Settings, port: int = 0, browser: bool = True) -> None:
    """Serve until Ctrl-C.

    Args:
        settings: what is opened.
        port: on 127.0.0.1; 0: any that is free.
        browser: whether to open the page.
    """
    token = os.environ.get(TOKEN, "") or secrets.token_urlsafe(24)
    if not re.fullmatch(r"[\w-]{16,200}", token):
        fail(f"{TOKEN}: write at least 16 random letters and digits, or leave it out")
    studio = Studio(settings, token)
    app = studio.app()
    listening = socket.socket()
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind(("127.0.0.1", port))
        listening.listen(128)  # whoever is quick waits until all is there
    except OSError as problem:
        fail(f"--port {port}: {problem.strerror}; leave it out to take a free one")
    app.port = int(listening.getsockname()[1])
    address = f"http://127.0.0.1:{app.port}/{studio.token}/"
    say(f"The studio is at  {address}\nIt serves the folder {studio.folder.path} to this machine only. Ctrl-C ends it.")
    if not (PAGE / "index.html").is_file():
        say("note: its page is not built yet; run  make studio  in the checkout, and open the address then")
    config = uvicorn.Config(
        app, log_level="error", headers=[*HEADERS.items()], server_header=False, limit_concurrency=_MOST_CONNECTIONS,
        ws_max_size=_LARGEST_MESSAGE, ws_per_message_deflate=False, ws_ping_interval=20.0, timeout_graceful_shutdown=1,
    )  # fmt: skip
    if browser:
        webbrowser.open(address)
    try:
        uvicorn.Server(config).run(sockets=[listening])
    finally:
        studio.pool.kill()  # however it ended: Python waits for them
