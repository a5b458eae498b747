"""A page that sends nonsense costs nobody a slot, a server that ends takes all its processes along, disks stay free."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import time
from pathlib import Path

import pytest

from studio_server import LONG, SHORT, Page, serving

pytest.importorskip("ropewalk.studio.serving")
MALFORMED = [
    '{"id": 1e400, "do": "check"}', '{"id": -1e400, "do": "prepare"}', '{"id": NaN, "do": "check"}',
    '{"id": 1e300, "do": "check"}', "[" * 100_000, '{"id": 5, "do": "check", "x": ' + "[" * 50_000 + "]" * 50_000 + "}",
    '{"do": "check"}', '{"id": 7}', '{"id": null, "do": "check"}', '{"id": [1], "do": "run"}', "[]", "7", '"x"', "",
    "{", "\x00", '{"id": {"a": 1}, "do": {"b": 2}}', b"\x00\xff", '{"id": ' + "9" * 5000 + ', "do": "check"}',
]  # fmt: skip
ODD = [  # well formed, and no sense in them
    {"do": "prepare"}, {"do": "pose"}, {"do": "pose", "pose": 7}, {"do": "run", "text": None}, {"do": "run", "text": 7},
    {"do": "result"}, {"do": "result", "name": "\x1b]0;x\x07"}, {"do": "case", "name": "x.nc", "row": 1e400},
    {"do": "sweep", "text": []}, {"do": "models", "text": "{" * 5000}, {"do": "__init__"}, {"do": "\x1b]0;pwned\x07"},
    {"do": "save", "name": 7, "text": 8}, {"do": "read", "name": None}, {"do": "new", "name": []}, {"do": ["check"]},
    {"do": "check", "text": {"a": 1}}, {"do": "release", "pose": {}}, {"do": "new"}, {"do": "check"},
]  # fmt: skip


def test_malformed_messages_cost_no_slot(tmp_path: Path) -> None:
    with serving(tmp_path, "--pages", "1", "--workers", "0") as server:
        for text in MALFORMED:
            page = Page(server)
            assert "error" not in page.ask("prepare", text=SHORT)  # it has the only slot
            page.socket.send(text)
            with pytest.raises(Exception, match=r"1003|1011|1009|close"):  # the server hangs up
                page.socket.recv(20.0)
            page.socket.close()
        with (page := Page(server)).socket:
            for asked in ODD:
                assert "id" in page.ask(str(asked["do"]), **{k: v for k, v in asked.items() if k != "do"}), asked
            assert "error" not in page.ask("prepare", text=SHORT)
        server.process.terminate()
        said = server.process.communicate(timeout=60.0)[1]
        assert said.replace("\n", "").isprintable()


def family(number: int) -> set[int]:
    """The descendants of a process."""
    found = set[int]()
    for task in Path(f"/proc/{number}/task").iterdir():
        for child in map(int, (task / "children").read_text().split()):
            found |= {child} | family(child)
    return found


def is_alive(number: int) -> bool:
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="descendants are found in /proc")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_server_that_ends_takes_the_workers_of_its_sweep_along(tmp_path: Path, number: int) -> None:
    over = "sweep: {over: {loads.walker.travel.from: [5.1 m, 5.2 m]}}\n"
    with (
        serving(tmp_path, "--workers", "2") as server,
        contextlib.closing(server.process.stderr),
        (  # type: ignore[type-var]
            page := Page(server)
        ).socket,
    ):
        page.send("sweep", text=LONG + over, name="long.yaml")
        begin = time.monotonic()
        while len(family(server.process.pid)) < 4 and time.monotonic() < begin + 60.0:  # a worker, 2 cases, a tracker
            time.sleep(0.1)
        time.sleep(2.0)  # until they compute
        children = family(server.process.pid)
        assert len(children) >= 4
        begin = time.monotonic()
        server.process.send_signal(number)
        server.process.wait(30.0)
        ended = time.monotonic() - begin
        while any(map(is_alive, children)) and time.monotonic() < begin + 20.0:
            time.sleep(0.02)
        gone = time.monotonic() - begin
        assert not any(map(is_alive, children))
        assert ended < 4.0  # s: 2 on a machine that does nothing else
        assert gone < 5.0


def test_the_disk_is_bounded(tmp_path: Path) -> None:
    (tmp_path / "old.nc").write_bytes(b"x" * 300_000)
    with serving(tmp_path, "--disk", "0.0004", "--workers", "0") as server, (page := Page(server)).socket:
        found = page.ask("run", text=SHORT.replace("every: 10 ms", "every: 0.2 ms"), name="rope.yaml")
        assert "error" in found or found.get("outcome") != "completed"
        assert (tmp_path / "rope.nc").stat().st_size < 150_000
        (tmp_path / "old.nc").write_bytes(b"x" * 500_000)
        for asked in ({"do": "run", "text": SHORT, "name": "rope.yaml"}, {"do": "save", "name": "a.yaml", "text": "x"}):
            refused = page.ask(str(asked.pop("do")), **asked)
            assert "take 0.000" in refused["error"]
            assert "delete results, or start the studio with a larger limit" in refused["error"]
        assert "error" not in page.ask("run", text=SHORT, unkept=True)
    assert os.listdir(tmp_path)
