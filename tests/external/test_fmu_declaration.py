"""Declarations of FMUs: what is wrong with them and their files is found before anything starts."""

from __future__ import annotations

import re
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("fmpy", reason="FMUs need FMPy")

from external.fmus import c_fmu
from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.external.description import check_fmu
from ropewalk.external.fmu import FmuModel
from ropewalk.model.fmu import Fmu

MESSAGE = {"force": "force", "height": "height", "velocity": "velocity"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fmus")


def fmu(file: Path | str, contact: dict[str, Any] | None = None, **keys: Any) -> Fmu:
    contacts = keys.pop("contacts", {"front": contact or MESSAGE})
    return Fmu(on="rope", file=str(file), contacts=contacts, travel={"speed": 1.0}, **keys)


def only(load: Fmu) -> str:
    """The one problem of a load."""
    problems = check_fmu("car", load)
    assert len(problems) == 1, [str(problem) for problem in problems]
    return str(problems[0])


@pytest.mark.parametrize("version", [2, 3])
def test_a_good_fmu_has_no_problems(folder: Path, version: int) -> None:
    parameters = {"mass": 12, "mood": "shout", "eager": False, "label": "red"}
    assert check_fmu("car", fmu(c_fmu(folder, version), parameters=parameters, start_values={"z": 1})) == []


def description(version: str, content: str = "", attributes: str = "") -> str:
    head = f'<fmiModelDescription fmiVersion="{version}" modelName="a" guid="b" {attributes}>'
    return f"{head}{content}<ModelVariables/><ModelStructure/></fmiModelDescription>"


ONE = description("1.0", "", 'modelIdentifier="c" numberOfContinuousStates="0" numberOfEventIndicators="0"')
EXCHANGE = description("2.0", '<ModelExchange modelIdentifier="c"/>')
SLAVE = description("2.0", '<CoSimulation modelIdentifier="c"/>')
FILES = [
    ("text", "an FMU is a zip archive", r"loads\.car\.file: is not an FMU, it cannot be unpacked"),
    ("no description", {"a": "b"}, r"is not an FMU, it has no modelDescription\.xml"),
    ("no XML", {"modelDescription.xml": "<a"}, r"its modelDescription\.xml cannot be read"),
    ("other XML", {"modelDescription.xml": "<a/>"}, r"its modelDescription\.xml cannot be read"),
    ("FMI 4.0", {"modelDescription.xml": description("4.0")}, r"cannot be read .*4\.0"),
    (
        "FMI 1.0",
        {"modelDescription.xml": ONE},
        r"loads\.car\.file: is an FMU of FMI 1\.0, given .*car\.fmu; export it with FMI 2\.0 or 3\.0",
    ),
    (
        "model exchange",
        {"modelDescription.xml": EXCHANGE},
        r"is an FMU for model exchange only, given .*; export it for co-simulation",
    ),
    (
        "for others",
        {"modelDescription.xml": SLAVE, "binaries/win16/c.dll": "", "sources/c.c": ""},
        r"has no binary for this platform \(no binaries/.*; it has binaries for win16 and sources in C; export it for",
    ),
    ("no binary", {"modelDescription.xml": SLAVE}, "has no binary for this platform .*it has none at all"),
]


@pytest.mark.parametrize(("name", "content", "said"), FILES, ids=[name for name, _, _ in FILES])
def test_a_file_that_is_no_usable_fmu_is_named(
    tmp_path: Path, name: str, content: str | dict[str, str], said: str
) -> None:
    file = tmp_path / "car.fmu"
    if isinstance(content, str):
        file.write_text(content)
    else:
        with zipfile.ZipFile(file, "w") as archive:
            for entry, text in content.items():
                archive.writestr(entry, text)
    load = fmu(file)
    assert re.search(said, only(load))
    with pytest.raises(ScenarioError, match=said):
        FmuModel("car", load, 1.0, 2)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    assert "loads.car.file: there is no such file, given" in only(fmu(tmp_path / "nothing.fmu"))
    assert "loads.car.file: is a folder, given" in only(fmu(tmp_path))


VARIABLES: list[tuple[dict[str, Any], str]] = [
    (
        {"contact": {**MESSAGE, "force": "forse"}},
        "contacts.front.force: the FMU has no such variable, given forse; did you mean force?",
    ),
    ({"contact": {**MESSAGE, "force": "qqqqqq"}}, "its outputs: force, seen, seen_place, clock, height_out"),
    (
        {"contact": {**MESSAGE, "force": "push"}},
        "contacts.front.force: must be an output of the FMU, this is of causality input, given push;",
    ),
    (
        {"contact": {**MESSAGE, "height": "force"}},
        "contacts.front.height: must be an input of the FMU, this is of causality output, given force;",
    ),
    (
        {"contact": {**MESSAGE, "force": "count"}},
        "must be a single number of type Real, this is of type Integer, given count",
    ),
    (
        {"contacts": {"a": MESSAGE, "b": {"force": "seen", "height": "height"}}},
        "contacts.b.height: is set by contacts.a.height already, given height",
    ),
    ({"parameters": {"stifness": 1.0}}, "parameters.stifness: the FMU has no such variable; did you mean stiffness?"),
    ({"parameters": {"qqqqq": 1.0}}, "it has mass, stiffness, damping, at, mood, eager, label"),
    ({"parameters": {"z": 1.0}}, "parameters.z: is none of the parameters of the FMU; write it under start_values"),
    ({"start_values": {"mass": 1.0}}, "start_values.mass: is a parameter of the FMU; write it under parameters"),
    ({"parameters": {"speed_of_light": 1.0}}, "cannot be set: it is constant"),
    ({"start_values": {"force": 1.0}}, r"cannot be set: it is output \(continuous\)"),
    ({"start_values": {"height": 1.0}}, r"is set by the line \(contacts.front.height\); leave it out"),
    ({"parameters": {"mass": "heavy"}}, "does not fit the type of the variable, Real, given 'heavy'; write a number"),
    ({"parameters": {"mass": True}}, "does not fit the type of the variable, Real, given True"),
    ({"parameters": {"mass": 0.0}}, "is below the minimum of the FMU, 0.001, given 0.0"),
    ({"parameters": {"eager": 1}}, "does not fit the type of the variable, Boolean, given 1; write true or false"),
    ({"parameters": {"label": 1.5}}, "does not fit the type of the variable, String, given 1.5; write text"),
    (
        {"parameters": {"mood": 1.5}},
        "does not fit the type of the variable, Enumeration, given 1.5; write one of good, segf",
    ),
    ({"parameters": {"mood": "sad"}}, "is none of the values of this enumeration, given 'sad'; write one of good"),
    ({"exchange": {"scheme": "iterated"}}, "exchange.scheme: repeats intervals, and this FMU cannot"),
]


@pytest.mark.parametrize(("keys", "said"), VARIABLES)
def test_a_load_that_does_not_fit_its_fmu_is_told_where_and_what_to_do(
    folder: Path, keys: dict[str, Any], said: str
) -> None:
    assert re.search(said, only(fmu(c_fmu(folder), **keys)))


def test_an_array_of_fmi_3_is_no_single_number(folder: Path) -> None:
    found = only(fmu(c_fmu(folder, 3), {**MESSAGE, "force": "row"}))
    assert "must be a single number of type Float64, this is of type array, given row" in found


def test_the_interval_is_a_multiple_of_the_step_of_an_fmu_of_fmi_3(folder: Path) -> None:
    file = c_fmu(folder, 3, 'fixedInternalStepSize="0.0004"')
    assert check_fmu("car", fmu(file, every=0.0012)) == []
    assert "loads.car.every: must be a multiple of the FMU's own step, 0.0004 s, given 0.001 s" in only(
        fmu(file, every=1e-3)
    )


def test_all_mistakes_are_found_at_once(folder: Path) -> None:
    load = fmu(c_fmu(folder), {**MESSAGE, "force": "forse", "height": "hight"}, parameters={"mass": -1.0, "colour": 3})
    keys = [problem.key for problem in check_fmu("car", load)]
    assert keys == [
        "loads.car.contacts.front.height", "loads.car.contacts.front.force",
        "loads.car.parameters.mass", "loads.car.parameters.colour",
    ]  # fmt: skip


def test_without_fmpy_one_is_told_how_to_get_it(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    load = fmu(c_fmu(folder))
    monkeypatch.setitem(sys.modules, "fmpy", None)
    with pytest.raises(RopewalkError, match=r'load car: FMUs need FMPy.*pip install "ropewalk\[fmi\]"'):
        check_fmu("car", load)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"contacts": {}}, "the vehicle has no contact with the line"),
        ({"contact": {"gives": "motion", "force": "push", "height": "z"}}, "stiffness"),
        ({"contact": {"gives": "motion", "force": "push"}, "exchange": {"stiffness": 1e6}}, "height"),
        ({"contact": {"force": "force", "force_factor": 0.0}}, "must not be zero"),
        ({"parameters": {"a": [1.0]}}, "not a value of a variable"),
        ({"parameters": {"a": float("inf")}}, "too large, or none"),
        ({"patience": 0.0}, "positive"),
        ({"isolated": "yes"}, "isolated"),
    ],
)
def test_a_declaration_checks_itself(keys: dict[str, Any], said: str) -> None:
    contacts = keys.pop("contacts", {"front": keys.pop("contact", MESSAGE)})
    with pytest.raises(ScenarioError, match=said):
        Fmu(on="rope", file="a.fmu", contacts=contacts, travel={"speed": 1.0}, **keys)
