"""The studio serves its own page on this machine, computes as the command line does, and refuses all else."""

from __future__ import annotations

import importlib.util
import io
import multiprocessing
import os
import signal
import socket
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import ropewalk
from ropewalk.errors import RopewalkError
from ropewalk.results.frame import Doubt
from ropewalk.results.picture import drawn_position
from ropewalk.scenario import ScenarioError, loads
from ropewalk.studio.folder import check_inside
from ropewalk.studio.streams import remark_of
from ropewalk.studio.sweeps import checked_plan
from ropewalk.studio.worker import ComputingProcess
from studio_server import LONG, SHORT, Page, Server, got, serving

starting = pytest.importorskip("ropewalk.studio.serving")
CODE = SHORT.replace("    kind: force\n", "    kind: stepper\n    model: evil.py:Evil\n").replace(
    "    force: [0 N, -800 N]\n    travel: {speed: 10 m/s, measured: slip, from: 0 m}\n", "    every: 1 ms\n"
)
SWEPT = (
    SHORT.replace("until: 0.3 s", "until: 20 ms")
    + """\
sweep:
  over:
    loads.walker.travel.speed: [2 m/s, 3 m/s]
    lines.rope.length: [20 m, 20.5 m]
  record: [largest_sag]
"""
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("studio") / "inside"
    place.mkdir()
    (place / "rope.yaml").write_text(SHORT)
    (place.parent / "secret.yaml").write_text("title: secret\n")
    (place / "link.yaml").symlink_to(place.parent / "secret.yaml")
    (place / "evil.py").write_text("from pathlib import Path\nPath('ran').touch()\nclass Evil: pass\n")
    return place


@pytest.fixture(scope="module")
def server(folder: Path) -> Iterator[Server]:
    with serving(folder, "--memory", "3", "--workers", "1") as found:
        yield found


@pytest.fixture
def page(server: Server) -> Iterator[Page]:
    found = Page(server)
    with found.socket:
        yield found


def test_only_who_knows_the_token_and_comes_from_here_is_served(server: Server) -> None:
    own = f"/{server.token}/"
    assert got(server, own)[0] in (200, 503)  # 503: the front end is not built
    assert got(server, "/")[0] == 403
    assert got(server, f"/{'x' * 32}/")[0] == 403
    assert got(server, own, Host=f"evil.example:{server.port}")[0] == 403
    assert got(server, own, Origin="http://evil.example")[0] == 403
    assert got(server, own, Origin="null")[0] == 403
    assert got(server, own, Origin=f"http://127.0.0.1:{server.port}")[0] in (200, 503)


def test_who_starts_it_without_its_page_is_told_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(starting, "PAGE", tmp_path / "page")
    monkeypatch.setattr(starting.uvicorn.Server, "run", lambda _, sockets: [one.close() for one in sockets])
    starting.serve(starting.Settings(tmp_path), browser=False)
    assert "make studio" in capsys.readouterr().err
    (tmp_path / "page").mkdir()
    (tmp_path / "page" / "index.html").touch()
    starting.serve(starting.Settings(tmp_path), browser=False)
    assert "make studio" not in capsys.readouterr().err


@pytest.mark.parametrize("origin", [None, "http://evil.example", "null"])
def test_a_page_of_somebody_else_opens_no_socket(server: Server, origin: str | None) -> None:
    from websockets.exceptions import InvalidStatus

    with pytest.raises(InvalidStatus, match="403"):
        Page(server, origin)


@pytest.mark.parametrize(
    "path", ["assets/../../secret.yaml", "assets/%2e%2e/%2e%2e/server.py", "../secret.yaml", "assets//etc/passwd",
             "export?name=../secret.nc&as=png", "export?name=/etc/passwd&as=csv", "export?name=rope.yaml&as=csv"]
)  # fmt: skip
def test_no_path_leads_out_of_the_folder(server: Server, path: str) -> None:
    status, body = got(server, f"/{server.token}/{path}")
    assert status in (400, 403, 404)
    assert b"title: secret" not in body
    assert b"root:" not in body


@pytest.mark.parametrize(
    "name", ["../secret.yaml", "/etc/passwd", "link.yaml", "..\\secret.yaml", ".hidden.yaml", "evil.py", "", "a\0.yaml"]
)
def test_no_file_outside_of_the_folder_is_read_or_written(page: Page, folder: Path, name: str) -> None:
    assert "error" in page.ask("read", name=name)
    assert "error" in page.ask("save", name=name, text="title: mine\n", stamp=None)
    assert (folder.parent / "secret.yaml").read_text() == "title: secret\n"


def test_a_scenario_that_names_files_elsewhere_is_refused(page: Page) -> None:
    text = SHORT.replace("  kind: dynamic\n", "  kind: dynamic\n  start: {kind: result, file: ../other.nc}\n")
    assert [p["key"] for p in page.ask("check", text=text)["problems"]] == ["run.start.file"]
    assert [p["key"] for p in page.ask("run", text=text, name="rope.yaml")["problems"]] == ["run.start.file"]


def test_a_scenario_that_runs_code_is_refused(page: Page, folder: Path) -> None:
    for do in ("check", "prepare", "run"):
        problems = page.ask(do, text=CODE, name="code.yaml")["problems"]
        assert [p["wrong"] for p in problems] == ["is external code, which the studio does not run"]
    assert not (folder / "ran").exists()


def test_a_huge_scenario_is_refused(page: Page) -> None:
    many = page.ask("check", text=SHORT.replace("elements: 50", "elements: 100000"))
    assert many["problems"][0]["key"] == "lines.rope.elements"
    deep = page.ask("check", text="[" * 100_000)
    assert deep["problems"]
    bomb = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
        f"{chr(98 + k)}: &{chr(98 + k)} [{', '.join([f'*{chr(97 + k)}'] * 9)}]\n" for k in range(8)
    )
    answer = page.ask("check", text=bomb)
    assert answer.get("problems") or answer.get("error")
    assert page.ask("check", text=SHORT)["problems"] == []
    from websockets.exceptions import ConnectionClosed

    with pytest.raises(ConnectionClosed):
        page.ask("check", text="x" * 3_000_000)


def test_a_thousand_connections_are_borne(server: Server) -> None:
    several = [socket.create_connection(("127.0.0.1", server.port)) for _ in range(1000)]
    for one in several[:200]:
        one.sendall(b"GET / HTTP/1.1\r\nHost: x\r\n\r\n")
    for one in several:
        one.close()
    until = time.monotonic() + 20.0
    while got(server, f"/{server.token}/")[0] == 503 and time.monotonic() < until:
        time.sleep(0.1)
    with (found := Page(server)).socket:
        assert found.ask("hello")["version"] == ropewalk.__version__


def test_mistakes_are_told_with_their_lines(page: Page) -> None:
    found = page.ask("check", text=SHORT.replace("axial_stiffness", "axial_stifness"), name="rope.yaml")["problems"]
    assert (found[0]["line"], found[0]["remedy"]) == (8, "did you mean axial_stiffness?")


def test_a_run_is_the_one_of_the_command_line(page: Page, folder: Path) -> None:
    events = list(page.messages(page.send("run", text=SHORT, name="rope.yaml")))
    assert (events[-1][0]["outcome"], events[-1][0]["file"]) == ("completed", "rope.nc")
    shown = np.concatenate([arrays["position"] for head, arrays in events if head.get("event") == "frames"])
    expected = ropewalk.simulate(loads(SHORT))
    with ropewalk.open_result(folder / "rope.nc") as stored:
        np.testing.assert_allclose(stored.position, expected.position, rtol=0, atol=1e-12)  # OpenBLAS on one thread
        again = list(page.messages(page.send("result", name="rope.nc")))
    np.testing.assert_array_equal(shown, drawn_position(expected).astype("f4"))
    np.testing.assert_array_equal(np.concatenate([a["position"] for _, a in again[1:-1]]), shown)
    assert again[0][0]["layout"] == events[[e[0].get("event") for e in events].index("layout")][0]["layout"]


def test_what_is_saved_is_what_was_written_unless_the_file_has_changed(page: Page, folder: Path) -> None:
    (folder / "mine.yaml").write_text(SHORT)
    read = page.ask("read", name="mine.yaml")
    changed = read["text"].replace("800", "700")
    saved = page.ask("save", name="mine.yaml", text=changed, stamp=read["stamp"])
    assert (folder / "mine.yaml").read_text() == changed
    assert "# stays" in changed
    (folder / "mine.yaml").write_text("title: of somebody else\n")
    assert "was changed on disk" in page.ask("save", name="mine.yaml", text=changed, stamp=saved["stamp"])["error"]
    assert (folder / "mine.yaml").read_text() == "title: of somebody else\n"
    assert "exists already" in page.ask("save", name="rope.yaml", text=changed, stamp=None)["error"]


def test_a_sweep_is_the_one_of_the_command_line_and_each_case_can_be_seen(
    page: Page, server: Server, folder: Path
) -> None:
    events = [head for head, _ in page.messages(page.send("sweep", text=SWEPT, name="swept.yaml"))]
    assert [event["done"] for event in events[:-1]] == [0, 1, 2, 3, 4]
    answer = events[-1]["sweep"]
    assert page.ask("result", name="swept.sweep.nc")["sweep"] == answer
    columns = {one["name"]: one["values"] for one in (*answer["parameters"], *answer["quantities"])}
    expected = ropewalk.sweep(loads(SWEPT), workers=0)
    assert columns["speed"] == [2.0, 2.0, 3.0, 3.0]
    assert columns["length"] == [20.0, 20.5, 20.0, 20.5]
    np.testing.assert_allclose(columns["largest_sag"], expected["largest_sag"].values.ravel(), rtol=1e-9)
    case = page.ask("case", name="swept.sweep.nc", row=1)
    found = loads(case["text"])
    assert (found.title, found.lines["rope"].length) == ("A slack rope, speed 2 m/s, length 20.5 m", 20.5)
    status, table = got(server, f"/{server.token}/export?name=swept.sweep.nc&as=csv")
    assert (status, len(table.splitlines())) == (200, 5)
    assert got(server, f"/{server.token}/export?name=swept.sweep.nc&as=gif")[0] == 400


def test_a_sweep_takes_the_processes_that_it_may(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def sweep(*_: object, workers: int, **__: object) -> None:
        raise RopewalkError(f"{workers} processes")

    monkeypatch.setattr("ropewalk.sweeps.sweeping.sweep", sweep)
    worker = ComputingProcess(multiprocessing.Pipe()[0], starting.Settings(tmp_path, workers=3))
    with pytest.raises(RopewalkError, match="3 processes"):
        worker._do_sweep({"text": SWEPT})


@pytest.mark.parametrize(
    ("values", "wrong"),
    [
        ("run.start: ['{kind: result, file: ../other.nc}']", "lies outside of the folder of the studio"),
        ("run.start: [{kind: result, file: ../other.nc}]", "lies outside of the folder of the studio"),
        ("loads.walker: [{kind: stepper, model: 'evil.py:Evil', on: rope, every: 1 ms}]",
         "is external code, which the studio does not run"),
        ("lines.rope.elements: [50, 60000]", "is too large here"),
    ],
)  # fmt: skip
def test_no_case_of_a_sweep_does_what_a_scenario_may_not(page: Page, folder: Path, values: str, wrong: str) -> None:
    text = SWEPT.replace("loads.walker.travel.speed: [2 m/s, 3 m/s]", values)
    assert [problem["wrong"] for problem in page.ask("sweep", text=text, name="bad.yaml")["problems"]] == [wrong]
    assert not (folder / "ran").exists()
    assert not (folder / "bad.sweep.nc").exists()


def test_no_case_of_a_sweep_reads_elsewhere(tmp_path: Path) -> None:
    """Not even to see whether a file is still the same: what a case may be is not asked here."""
    text = SWEPT.replace(
        "loads.walker.travel.speed: [2 m/s, 3 m/s]", "run.start: ['{kind: result, file: ../other.nc}']"
    )
    scenario = loads(text)
    assert scenario.sweep is not None
    with pytest.raises(ScenarioError, match=r"run\.start\.file: lies outside of the folder"):
        checked_plan(scenario, scenario.sweep, lambda _: None, tmp_path)
    several = {"loads": {"head": {"irregularity": {"first": "own.csv", "second": "../other.csv"}}}}
    with pytest.raises(ScenarioError, match=r"loads\.head\.irregularity\.second: lies outside of the folder"):
        check_inside(several, tmp_path)


def test_a_film_and_a_workbook_are_exported(page: Page, server: Server, folder: Path) -> None:
    ropewalk.simulate(loads(SHORT.replace("0.3 s", "20 ms")), file=folder / "small.nc")
    for kind, begins in (("gif", b"GIF8"), ("xlsx", b"PK"), ("svg", b"<?xml"), ("pdf", b"%PDF")):
        status, body = got(server, f"/{server.token}/export?name=small.nc&as={kind}")
        assert (status, body[: len(begins)]) == (200, begins)
    tables = zipfile.ZipFile(io.BytesIO(got(server, f"/{server.token}/export?name=small.nc&as=zip")[1])).namelist()
    assert {"small.csv", "small.summary.csv"} <= {*tables}
    status, body = got(server, f"/{server.token}/export?name=small.nc&as=mp4")
    if importlib.util.find_spec("imageio_ffmpeg"):
        assert (status, body[4:8]) == (200, b"ftyp")
    else:
        assert (status, b"pip install 'ropewalk[film]'" in body) == (400, True)


def test_simpler_models_are_compared_as_on_the_command_line(page: Page) -> None:
    text = SHORT.replace("until: 0.3 s", "until: 20 ms").replace("elements: 50", "elements: 20")
    answer = page.ask("models", text=text, name="rope.yaml")
    assert answer["verdict"] == ropewalk.model_hierarchy(loads(text)).verdict
    assert [table[0][-1] for table in answer["tables"]] == ["full", "measured"]
    assert "<svg" in answer["picture"]


def test_doubts_are_told_with_their_instant_and_key() -> None:
    doubt = Doubt("wheel a (b) lifts at t = 1.2e-05 s", "a hop between t = 0 and 3 s (as it is)", "loads.w.x", "look")
    assert remark_of(str(doubt)) == {"text": str(doubt), "time": 1.2e-05, "key": "loads.w.x"}
    assert remark_of(str(Doubt("no audit", "none is known", "", "look"))) == {
        "text": "no audit; likely cause: none is known; look", "time": None, "key": "",
    }  # fmt: skip


def begun(page: Page, text: str, file: Path) -> None:
    """Begin a run; returns when its file holds instants. What is not read would hold the run up."""
    for head, _ in page.messages(page.send("run", text=text, name=file.with_suffix(".yaml").name)):
        if head["event"] == "frames":
            with ropewalk.open_result(file) as found:
                if found.sizes["time"]:
                    return
    raise AssertionError(f"{file} was over before it held anything")


def holds(file: Path, outcome: str = "interrupted") -> bool:
    """Whether a result comes to hold instants, with an outcome; one that is being written is interrupted so far."""
    until = time.monotonic() + 60.0  # other tests may keep the processors busy
    while time.monotonic() < until:
        time.sleep(0.2)
        with ropewalk.open_result(file) as found:
            if found.attrs["outcome"] == outcome and found.sizes["time"]:
                return True
    return False


def stands(file: Path) -> bool:
    """Whether a result comes to grow no more: nobody writes it."""
    before, until = -1, time.monotonic() + 60.0
    while time.monotonic() < until:
        with ropewalk.open_result(file) as found:
            now = found.sizes["time"]
        if now == before:
            return True
        before = now
        time.sleep(3.0)  # it is synchronised every second or so
    return False


def test_a_run_is_stopped_by_its_page_and_when_that_closes(server: Server, folder: Path) -> None:
    with (one := Page(server)).socket, (other := Page(server)).socket:  # two pages at once
        number = one.send("run", text=LONG, name="stopped.yaml")
        for head, _ in one.messages(number):
            if head["event"] == "frames":
                one.send("stop")
            last = head
        assert last["outcome"] == "interrupted"
        begun(other, LONG, folder / "left.nc")
    assert holds(folder / "left.nc")
    assert stands(folder / "left.nc")


def test_a_killed_server_leaves_results_whole_and_another_one_goes_on(folder: Path) -> None:
    with serving(folder) as first:
        page = Page(first)
        begun(page, LONG, folder / "killed.nc")
        first.end(signal.SIGKILL)
        page.socket.close()
    assert holds(folder / "killed.nc")
    with serving(folder, "--port", str(first.port)) as second, (page := Page(second)).socket:
        assert "killed.nc" in page.ask("hello")["results"]
        assert page.ask("result", name="killed.nc")["outcome"] == "interrupted"
        assert os.listdir(folder)
