"""Where a result may be written: what was there before stays until there is something in its place."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from travelling_wave import frames, layout, run_info, scenario

from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.model import Scenario
from ropewalk.results import Recorder, ResultError, check_target, open_result
from ropewalk.results.files import alone, beside, check_own
from ropewalk.simulate import simulate
from ropewalk.studio.folder import Folder, OutsideError, check_inside
from ropewalk.sweeps.writing import check_outputs

HOLDS = """
import sys, time
from pathlib import Path
from ropewalk.results.files import alone
with alone(Path(sys.argv[1])):
    print("mine", flush=True)
    time.sleep(60)
"""


def still(title: str = "", name: str = "rope", start: str | None = None) -> Scenario:
    line = {"start": [0, 0], "end": [10, 0], "tension": 1e3, "mass": 1.0, "axial_stiffness": 1e5, "elements": 4}
    run = {"kind": "dynamic", "until": 0.02, "every": 0.01}
    if start is not None:
        run["start"] = {"kind": "result", "file": start}
    tree = {"lines": {name: line}, "run": run} | ({"title": title} if title else {})
    return Scenario.model_validate(tree)


def recorded(file: Path, count: int = 3, title: str = "one") -> None:
    plan = layout(links=8)
    with Recorder(plan, scenario(title), run_info(), file) as recorder:
        for frame in list(frames(plan))[:count]:
            recorder.append(frame)


def test_an_earlier_result_is_there_until_the_first_frame_of_the_next(tmp_path: Path) -> None:
    file, plan = tmp_path / "out.nc", layout(links=8)
    recorded(file)
    before = file.read_bytes()
    with Recorder(plan, scenario(), run_info(), file) as recorder:
        assert file.read_bytes() == before
        for frame in list(frames(plan))[:5]:
            recorder.append(frame)
        assert file.read_bytes() != before
    assert open_result(file).sizes["time"] == 5
    assert [path.name for path in tmp_path.iterdir()] == ["out.nc"]


def test_a_run_that_cannot_create_its_file_leaves_the_earlier(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As a full disk has it."""
    file, plan = tmp_path / "out.nc", layout(links=8)
    recorded(file)
    before = file.read_bytes()

    def full(*_: object) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr("ropewalk.results.recorder._create", full)
    with (
        pytest.raises(ResultError, match="cannot be created"),
        Recorder(plan, scenario(), run_info(), file) as recorder,
    ):
        recorder.append(next(iter(frames(plan))))
    assert file.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["out.nc"]


@pytest.mark.skipif(sys.platform == "win32", reason="files are not locked there")
def test_of_two_runs_on_one_file_the_second_is_told_who_the_first_is(tmp_path: Path) -> None:
    file = tmp_path / "out.nc"
    recorded(file)
    with subprocess.Popen([sys.executable, "-c", HOLDS, file], stdout=subprocess.PIPE, text=True) as first:
        try:
            assert first.stdout is not None
            assert first.stdout.readline() == "mine\n"
            for refused in (lambda: check_target(file), lambda: simulate(still("one"), file=file, overwrite=True)):
                with pytest.raises(ResultError, match=f"is being written by process {first.pid} since 20"):
                    refused()
        finally:
            first.kill()
    assert open_result(file).sizes["time"] == 3
    assert beside(file, "lock").exists()  # it was killed
    with alone(file):
        pass
    assert not beside(file, "lock").exists()


def test_a_result_of_another_scenario_is_kept(tmp_path: Path) -> None:
    file = tmp_path / "out.nc"
    simulate(still("a bridge"), file=file)
    before = file.read_bytes()
    with pytest.raises(ResultError, match=r"holds a result of another scenario, 'a bridge'; .*--overwrite"):
        simulate(still("a ropeway", "cable"), file=file)
    assert file.read_bytes() == before
    simulate(still("a bridge, once more"), file=file)  # the same lines
    simulate(still("a bridge, once more", "cable"), file=file)  # the same title
    simulate(still("a ropeway", "rope"), file=file, overwrite=True)
    assert open_result(file).attrs["title"] == "a ropeway"


def test_what_cannot_be_read_is_kept(tmp_path: Path) -> None:
    file = tmp_path / "out.nc"
    recorded(file)
    file.write_bytes(file.read_bytes()[:200])
    with pytest.raises(ResultError, match="exists, but its scenario cannot be read"):
        check_own(file, scenario())


@pytest.mark.skipif(not hasattr(os, "link"), reason="no links")
def test_a_motion_is_not_written_over_what_it_starts_from_by_another_name(tmp_path: Path) -> None:
    file, other = tmp_path / "s.nc", tmp_path / "t.nc"
    simulate(still(), file=file)
    os.link(file, other)
    with pytest.raises(ScenarioError, match="is also the output file"):
        simulate(still(start=str(file)), file=other)


@pytest.mark.parametrize(
    ("name", "why"),
    [("x" * 300 + ".nc", "too long"), ("loop.nc", "cannot be written to|symbolic"), (b"\xff.nc", "not UTF-8")],
    ids=["long", "loop", "bytes"],
)
def test_strange_names_are_refused(name: str | bytes, why: str, tmp_path: Path) -> None:
    file = tmp_path / (os.fsdecode(name) if isinstance(name, bytes) else name)
    if name == "loop.nc":
        file.symlink_to(tmp_path / "round.nc")
        (tmp_path / "round.nc").symlink_to(file)
    with pytest.raises(RopewalkError, match=why) as message:
        check_target(file)
    str(message.value).encode()


def _as_of_3_13(file: Path, strict: bool = False) -> Path:
    """`Path.resolve` of Python 3.13, which takes a loop of links for a file that is not there yet."""
    return Path(os.path.realpath(file, strict=strict))


@pytest.mark.parametrize("is_newer", [False, True], ids=["here", "3.13"])
@pytest.mark.parametrize("name", ["one.nc", "pair.nc", "folder/x.nc", "to/loop.nc"])
def test_a_loop_of_links_is_refused_by_every_python(
    name: str, is_newer: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "one.nc").symlink_to(tmp_path / "one.nc")
    (tmp_path / "pair.nc").symlink_to(tmp_path / "other.nc")
    (tmp_path / "other.nc").symlink_to(tmp_path / "pair.nc")
    (tmp_path / "folder").symlink_to("folder")
    (tmp_path / "to").mkdir()
    (tmp_path / "to" / "loop.nc").symlink_to("../one.nc")
    if is_newer:
        monkeypatch.setattr(Path, "resolve", _as_of_3_13)
    links = sorted(tmp_path.rglob("*"))
    with pytest.raises(RopewalkError, match=r"cannot be written to \(Too many levels of symbolic links\)"):
        check_target(tmp_path / name)
    with pytest.raises(RopewalkError, match="cannot be written to"):
        simulate(still(), file=tmp_path / name)
    with pytest.raises(RopewalkError, match=r"cannot be written|does not exist"):
        check_outputs([tmp_path / name])
    with pytest.raises(OutsideError, match="is a link to no file"):
        Folder(tmp_path).file("one.nc", (".nc",))
    with pytest.raises(ScenarioError, match="lies outside of the folder"):
        check_inside({"file": name}, tmp_path.resolve())
    assert sorted(tmp_path.rglob("*")) == links
    assert all(link.is_symlink() or link.is_dir() for link in links)


def test_more_than_fits_into_memory_asks_for_a_file() -> None:
    asked = still().model_copy(update={"run": still().run.model_copy(update={"until": 1e7, "every": 0.1})})
    with pytest.raises(ScenarioError, match=r"5e\+08 node positions .* write to a file \(file=...\), raise run.every"):
        simulate(asked)
