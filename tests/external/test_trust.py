"""What a file from a stranger may do: run no code where that is forbidden, and little where an FMU is isolated."""

from __future__ import annotations

import io
import json
import pickle
import zipfile
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ropewalk.checkpoint import CheckpointError, to_bytes
from ropewalk.cli.app import app
from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.external import archive, isolation
from ropewalk.external.description import check_fmu
from ropewalk.external.models import refuse_code
from ropewalk.model import Scenario
from ropewalk.model.fmu import Fmu
from ropewalk.simulate import simulate

CODE = """
import pathlib
pathlib.Path("has run").touch()
{body}

class Hip:
    def step(self, t, h, line):
        {step}
"""


def scenario(model: str) -> dict[str, object]:
    rope = {"start": [0, 0], "end": [10, 0], "tension": 1e3, "mass": 1.0, "axial_stiffness": 1e5, "elements": 8}
    walker = {"kind": "stepper", "on": "rope", "model": model, "every": 0.01, "from": 5.0}
    run = {"kind": "dynamic", "until": 0.03, "every": 0.01}
    return {"lines": {"rope": rope}, "loads": {"walker": walker}, "run": run}


def written(folder: Path, body: str = "", step: str = "return [(5.0, (0.0, -100.0))]") -> Path:
    (folder / "hip.py").write_text(CODE.format(body=body, step=step))
    file = folder / "walk.yaml"
    file.write_text(json.dumps(scenario("hip.py:Hip")))
    return file


def test_answers_of_an_isolated_fmu_are_data_that_can_run_nothing() -> None:
    class Evil:
        def __reduce__(self) -> tuple[object, tuple[str]]:
            return print, ("it has run",)

    data = pickle.dumps(Evil())
    stream = io.BytesIO(len(data).to_bytes(8, "little") + data)
    with pytest.raises(CheckpointError):
        isolation._receive(stream)
    with pytest.raises(CheckpointError, match="too large"):
        isolation._receive(io.BytesIO(b"\xff" * 8))
    with pytest.raises(EOFError):
        isolation._receive(io.BytesIO(b"\x01"))
    sound = to_bytes(("done", [1.0, float("inf")]))
    assert isolation._receive(io.BytesIO(len(sound).to_bytes(8, "little") + sound)) == ("done", [1.0, float("inf")])


def test_an_archive_that_would_fill_the_disk_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "bomb.fmu"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as bomb:
        bomb.writestr("modelDescription.xml", b"\0" * 3_000_000)
    archive.check_size(file)
    assert file.stat().st_size < 10_000
    monkeypatch.setattr(archive, "LARGEST", 2_000_000)
    with pytest.raises(RopewalkError, match=r"it holds 1 files of 0.003 GB; at most"):
        archive.check_size(file)


START = '<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="2.0">'


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        (START + '<Unknown index="1"/>' * 2_000_000, "is larger than 32 MB"),
        (START + "<U/>" * 700_000, "has about 350001 elements and 3 attributes, which is"),
        (START + '<U a="" />' * 2_100_000, "has about 1050001 elements and 2100003 attributes"),
        (START + "<U " + " ".join(f'a{i}=""' for i in range(1200)) + "/>", "has an element of more than 1000"),
        (START.replace("<fmi", '<!DOCTYPE x [<!ENTITY a SYSTEM "/dev/zero">]><fmi'), "defines a document type"),
        (START.replace("UTF-8", "UTF-7"), "is not in UTF-8"),
        (START.encode("utf-16"), "is not in UTF-8"),
    ],
    ids=["size", "elements", "attributes", "attributes of one", "entity", "utf-7", "utf-16"],
)  # fmt: skip
def test_a_description_that_would_take_much_is_refused_before_it_is_parsed(
    text: str | bytes, wrong: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fmpy = pytest.importorskip("fmpy", reason="FMUs need FMPy")
    monkeypatch.setattr(fmpy, "read_model_description", None)  # it would fail otherwise
    file = tmp_path / "car.fmu"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as bomb:
        bomb.writestr("modelDescription.xml", text)
    travel = {"speed": 1.0}
    problems = check_fmu("car", Fmu(on="s", file=str(file), contacts={"a": {"force": "f"}}, travel=travel))
    assert [problem.key for problem in problems] == ["loads.car.file"]
    assert problems[0].wrong.startswith(f"its modelDescription.xml {wrong}")
    assert problems[0].remedy


@pytest.mark.parametrize("command", [["run"], ["spectrum"], ["feedback"], ["compare"], ["check"]])
def test_no_code_is_run_where_that_is_forbidden(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    file = written(tmp_path)
    flags = [] if command == ["check"] else ["--no-code"]
    found = CliRunner().invoke(app, [*command, str(file), *flags])
    assert not (tmp_path / "has run").exists()
    if flags:
        assert found.exit_code == 2
        assert (
            "loads.walker.model: is external code, which --no-code refuses, given hip.py:Hip; omit --no-code"
            in found.output
        )


def test_a_scenario_without_code_runs_where_it_is_forbidden(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    tree = scenario("none") | {"loads": {}}
    (tmp_path / "still.yaml").write_text(json.dumps(tree))
    assert CliRunner().invoke(app, ["run", "still.yaml", "--no-code", "-q"]).exit_code == 0


def test_fmus_are_code() -> None:
    contacts = {"front": {"force": "f"}}
    load = {"kind": "fmu", "on": "rope", "file": "car.fmu", "contacts": contacts, "travel": {"speed": 1.0}}
    asked = Scenario.model_validate(scenario("none") | {"loads": {"car": load}})
    with pytest.raises(ScenarioError, match=r"loads\.car\.file: is external code"):
        refuse_code(asked.loads)


@pytest.mark.parametrize(
    ("body", "step", "message"),
    [
        ("raise SystemExit(0)", "pass", r"load walker: its model hip.py:Hip cannot be found \(it ends the program"),
        ("", "raise SystemExit(0)", r"load walker: its model failed at t = 0 s \(SystemExit: 0\)"),
    ],
)
def test_a_model_that_ends_the_program_is_an_error(
    body: str, step: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path, body, step)
    with pytest.raises(RopewalkError, match=message):
        simulate(Scenario.model_validate(scenario("hip.py:Hip")))
