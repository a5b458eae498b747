"""A studio that really serves, and a page that speaks to it as the browser would."""

from __future__ import annotations

import http.client
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

ROPE = """\
title: A slack rope  # stays
lines:
  rope:
    start: [0 m, 0 m]
    end: [19.5 m, 0 m]
    length: 20 m
    mass: 1 kg/m
    axial_stiffness: 100 kN
    axial_damping: 50 N*s
    elements: 50
loads:
  walker:
    kind: force
    on: rope
    force: [0 N, -800 N]
    travel: {speed: 10 m/s, measured: slip, from: 0 m}
run:
  kind: dynamic
  until: UNTIL s
  every: 10 ms
"""
SHORT = ROPE.replace("UNTIL", "0.3")
LONG = ROPE.replace("10 m/s, measured: slip, from: 0 m", "0 m/s, from: 5.1 m").replace("UNTIL", "3000")


class Server:
    """A studio in a process of its own."""

    def __init__(self, folder: Path, *options: str, token: str = "") -> None:
        environment = {**os.environ, "ROPEWALK_STUDIO_TOKEN": token}
        command = [sys.executable, "-m", "ropewalk", "studio", "--no-browser", *options]
        self.process = subprocess.Popen(command, cwd=folder, env=environment, stderr=subprocess.PIPE, text=True)
        assert self.process.stderr is not None
        said = self.process.stderr.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)/([\w-]+)/", said)
        assert found, said + self.process.stderr.read()
        self.address, self.port, self.token = found[0], int(found[1]), found[2]

    def end(self, number: int = signal.SIGTERM) -> None:
        self.process.send_signal(number)
        self.process.wait(60.0)  # a worker that has just begun is waited for
        assert self.process.stderr is not None
        self.process.stderr.close()


@contextmanager
def serving(folder: Path, *options: str, token: str = "") -> Iterator[Server]:
    server = Server(folder, *options, token=token)
    try:
        yield server
    finally:
        if server.process.poll() is None:
            server.end()


def got(server: Server, path: str, **headers: str) -> tuple[int, bytes]:
    """The status and the body of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=60.0)
    connection.putrequest("GET", path, skip_host="Host" in headers)
    for name, value in headers.items():
        connection.putheader(name, value)
    connection.endheaders()
    answer = connection.getresponse()
    found = answer.status, answer.read()
    connection.close()
    return found


def unpacked(data: bytes) -> tuple[dict[str, Any], dict[str, Any]]:
    """A header and its arrays, as the page reads them."""
    size = int.from_bytes(data[:4], "little")
    head, at, arrays = json.loads(data[4 : 4 + size]), 4 + size, {}
    for name, shape in head["arrays"]:
        count = int(np.prod(shape))
        arrays[name] = np.frombuffer(data, "<f4", count, at).reshape(shape)
        at += 4 * count
    assert at == len(data)
    return head, arrays


class Page:
    """What a page asks, one thing after the other."""

    def __init__(self, server: Server, origin: str | None = "") -> None:
        from websockets.sync.client import connect

        home = f"http://127.0.0.1:{server.port}" if origin == "" else origin
        self.socket = connect(
            f"ws://127.0.0.1:{server.port}/{server.token}/socket", origin=home, max_size=None, proxy=None, legacy=True
        )
        self._number = 0

    def send(self, do: str, **given: Any) -> int:
        self._number += 1
        self.socket.send(json.dumps({"id": self._number, "do": do, **given}))
        return self._number

    def messages(self, number: int, timeout: float = 120.0) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
        """What comes for a question, the answer last."""
        while True:
            data = self.socket.recv(timeout)
            head, arrays = (json.loads(data), {}) if isinstance(data, str) else unpacked(data)
            if head["id"] == number:
                yield head, arrays
                if head.get("event", "ended") == "ended":
                    return

    def ask(self, do: str, **given: Any) -> dict[str, Any]:
        return list(self.messages(self.send(do, **given)))[-1][0]
