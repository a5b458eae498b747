"""A computation outlives a reload of its page, stops within a second, and its messages name no full paths."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import ropewalk
from ropewalk.scenario import loads
from studio_server import LONG, SHORT, Page, Server, serving

pytest.importorskip("ropewalk.studio.serving")


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with serving(tmp_path_factory.mktemp("sessions"), "--workers", "0", "--pages", "2") as found:
        yield found


def test_a_run_that_is_set_up_is_stopped_within_a_second(server: Server) -> None:
    """The worker imports what it needs, or compiles: it does not listen."""
    with (page := Page(server)).socket:
        number = page.send("run", text=LONG, name="stopped.yaml")
        time.sleep(0.1)
        page.send("stop")
        begin = time.monotonic()
        last = [head for head, _ in page.messages(number)][-1]
        assert time.monotonic() - begin < 2.5  # 0.8 s on an idle machine
        assert last.get("error", "stopped").startswith("stopped") or last["outcome"] == "interrupted"
        assert page.ask("prepare", text=SHORT)["title"] == "A slack rope"  # by a new worker


def test_a_stop_that_follows_at_once_stops_the_run(server: Server) -> None:
    """The run has not reached its worker by then."""
    with (page := Page(server)).socket:
        for _ in range(6):
            number, begin = page.send("run", text=LONG, unkept=True), time.monotonic()
            page.send("stop")
            for head, _ in page.messages(number):
                assert time.monotonic() < begin + 20.0  # s; it would send frames for minutes
                last = head
            assert last.get("error", "stopped").startswith("stopped") or last["outcome"] == "interrupted"


def test_a_page_that_is_reloaded_finds_its_run_again(server: Server) -> None:
    with (page := Page(server)).socket:
        name = page.ask("hello", page="")["page"]
        number = page.send("run", text=LONG, name="long.yaml")
        events = page.messages(number)
        while next(events)[0]["event"] != "frames":
            pass
    with (page := Page(server)).socket, (other := Page(server)).socket:
        found = page.ask("hello", page=name)
        assert found["page"] == name
        assert (found["under_way"]["id"], found["under_way"]["text"]) == (number, LONG)
        duplicate = other.ask("hello", page=name)  # a copy of the tab has a session of its own
        assert duplicate["page"] != name
        assert duplicate["under_way"] is None
        page.send("resume")
        heads = [next(page.messages(number))[0]["event"] for _ in range(2)]
        assert heads == ["state", "layout"]  # from the first message on
        page.send("stop")
        assert [head for head, _ in page.messages(number)][-1]["outcome"] == "interrupted"
        assert page.ask("hello")["under_way"] is None


def test_the_result_of_another_scenario_is_replaced_only_on_request(server: Server, tmp_path: Path) -> None:
    with (page := Page(server)).socket:
        page.ask("run", text=SHORT.replace("0.3 s", "20 ms"), name="mine.yaml")
        other = SHORT.replace("0.3 s", "20 ms").replace("A slack rope", "Another").replace("rope", "cable")
        assert page.ask("run", text=other, name="mine.yaml") == {"id": 2, "replaces": "mine.nc"}
        assert page.ask("run", text=other, name="mine.yaml", overwrite=True)["outcome"] == "completed"


def test_messages_of_the_worker_name_no_full_paths(tmp_path: Path) -> None:
    ropewalk.simulate(loads(SHORT.replace("0.3 s", "20 ms")), file=tmp_path / "begun.nc")
    (tmp_path / "broken.nc").write_bytes(b"no result")
    text = SHORT.replace("  kind: dynamic\n", "  kind: dynamic\n  start: {kind: result, file: begun.nc}\n")
    with serving(tmp_path) as server, (page := Page(server)).socket:
        answers = [
            page.ask("result", name="broken.nc"), page.ask("result", name="absent.nc"),
            page.ask("run", text=text, name="begun.yaml"),
            page.ask("run", text=SHORT, name="broken.yaml", overwrite=True),
        ]  # fmt: skip
    assert all({"error", "problems"} & {*answer} for answer in answers)
    assert str(tmp_path) not in str(answers)
