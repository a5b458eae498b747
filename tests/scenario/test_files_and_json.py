"""Files that cannot be read, and JSON with its line numbers."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from ropewalk.errors import ScenarioError
from ropewalk.scenario import load, loads

BYTES = {
    "a binary file is refused": (b"title: x\nlines: \x00\x01", 2, "not a text file"),
    "Latin-1 is refused": ("title: x\nlines: \xe4".encode("latin-1"), 2, "save it as UTF-8"),
    "UTF-16 is refused": ("title: x".encode("utf-16"), 1, "save it as UTF-8"),
}


@pytest.mark.parametrize(("data", "line", "words"), BYTES.values(), ids=BYTES)
def test_bytes(tmp_path: Path, data: bytes, line: int, words: str) -> None:
    path = tmp_path / "case.yaml"
    path.write_bytes(data)
    with pytest.raises(ScenarioError) as caught:
        load(path)
    assert str(caught.value).startswith(f"{path}:{line}: ")
    assert words in str(caught.value)


def test_a_missing_file_suggests_one_that_is_there(tmp_path: Path) -> None:
    (tmp_path / "rope.yaml").write_text("")
    with pytest.raises(ScenarioError, match=r"roep\.yaml: no such file; did you mean rope\.yaml\?"):
        load(tmp_path / "roep.yaml")


def test_a_missing_folder_asks_to_check_the_path(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="no such file; check the path"):
        load(tmp_path / "nowhere" / "rope.yaml")


def test_a_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="is a folder; name a scenario file in it"):
        load(tmp_path)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="permissions do not bind this user")
def test_a_locked_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "case.yaml"
    path.write_text("title: x")
    path.chmod(0)
    with pytest.raises(ScenarioError, match="cannot be read; change its permissions"):
        load(path)


def test_a_refused_permission_is_explained(monkeypatch: pytest.MonkeyPatch) -> None:
    def locked(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("builtins.open", locked)
    with pytest.raises(ScenarioError, match="cannot be read; change its permissions"):
        load("case.yaml")


def test_a_path_with_a_zero_byte_is_refused() -> None:
    with pytest.raises(ScenarioError, match="check the path"):
        load("a\0b.yaml")


def test_windows_line_ends_keep_the_line_numbers(example: str) -> None:
    text = example.replace("mass: 1 kg/m", "mass: 1 m").replace("\n", "\r\n")
    with pytest.raises(ScenarioError, match=r"^case:8: lines\.rope\.mass"):
        loads(text, "case")


@pytest.fixture
def as_json(example: str) -> str:
    return json.dumps(YAML(typ="safe", pure=True).load(example), indent=2)


@pytest.mark.parametrize("name", ["case.json", "case.yaml"])
def test_a_byte_order_mark_is_skipped(tmp_path: Path, as_json: str, example: str, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(b"\xef\xbb\xbf" + as_json.encode())
    assert load(path) == loads(example)


@pytest.mark.parametrize("name", ["case.json", "case", "case.txt", "case.yaml"])
def test_json_gives_the_same_scenario(as_json: str, example: str, name: str) -> None:
    assert loads(as_json, name) == loads(example)


def test_a_yaml_block_in_braces_is_yaml() -> None:
    text = "{lines: {a: {start: [0, 0], end: [1, 0], tension: 1, mass: 1, axial_stiffness: 1e5}}}"
    assert loads(text).lines["a"].axial_stiffness == 1e5


def test_json_with_tabs_is_read(as_json: str, example: str) -> None:
    assert loads(as_json.replace("  ", "\t"), "case.json") == loads(example)


def test_json_keeps_line_numbers(as_json: str) -> None:
    text = as_json.replace('"1 kg/m"', '"1 m"')
    line = text[: text.index('"1 m"')].count("\n") + 1
    with pytest.raises(ScenarioError, match=f"^case.json:{line}: lines.rope.mass: m does not fit"):
        loads(text, "case.json")


JSON = {
    "a missing comma is refused": ('{"a": 1\n "b": 2}', 2, "Expecting ','"),
    "an open list is refused": ('{"a": [1,\n 2', 2, "Expecting ','"),
    "a key without quotes is refused": ("{\na: 1}", 2, "double quotes"),
    "a key without colon is refused": ('{"a" 1}', 1, "Expecting ':'"),
    "a missing value is refused": ('{"a":\n}', 2, "Expecting value"),
    "an early end is refused": ('{"a":\n', 2, "Expecting value"),
    "an open text is refused": ('{"a": "b}', 1, "Unterminated string"),
    "a trailing comma is refused": ('{"a": 1,\n}', 2, "double quotes"),
    "text after the end is refused": ('{"a": 1}\n}', 2, "Extra data"),
    "an empty text is refused": ("", 1, "is empty"),
    "a list at the top is refused": ("\n[1]", 2, "a list instead of"),
    "null at the top is refused": ("null", 1, "is empty"),
}


@pytest.mark.parametrize(("text", "line", "words"), JSON.values(), ids=JSON)
def test_malformed_json(text: str, line: int, words: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        loads(text, "case.json")
    assert len(caught.value.problems) == 1
    assert str(caught.value).startswith(f"case.json:{line}: ")
    assert words in str(caught.value)


def test_a_duplicate_key_in_json_points_to_the_first() -> None:
    with pytest.raises(ScenarioError, match=r"case.json:2: gravity: the key occurs twice .*case.json:1"):
        loads('{"gravity": 1,\n"gravity": {"a": 2}, "lines": {}}', "case.json")


def test_keys_of_a_duplicate_block_are_no_duplicates_themselves() -> None:
    with pytest.raises(ScenarioError) as caught:
        loads('{"lines": {"a": {"mass": 1}},\n"lines": {"a": {"mass": 2}}}', "case.json")
    assert [problem.key for problem in caught.value.problems if "twice" in problem.wrong] == ["lines"]


def test_words_that_json_lacks_are_refused_as_values() -> None:
    with pytest.raises(ScenarioError, match="gravity: expected an acceleration, not nan"):
        loads('{"gravity": NaN, "lines": {}}', "case.json")
