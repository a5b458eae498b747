"""The schema and the pages of the reference say the same as the declarations."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from scenario_reference import FIRST, MARK, PAGES, SECTIONS, reference, refreshed  # of docs/: see conftest.py

from ropewalk.model import Line, Travel
from ropewalk.scenario import json_schema, loads

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("name", PAGES)
def test_a_committed_page_is_the_generated_one(name: str) -> None:
    page = (DOCS / name).read_text(encoding="utf-8")
    assert MARK in page
    assert page == refreshed(page, name), "run  python docs/make_reference.py"


def test_every_page_and_every_heading_has_its_place() -> None:
    """Each heading on one page, each page linked from the first one, with a figure of its own."""
    assert sorted(heading for headings in PAGES.values() for heading in headings) == sorted(SECTIONS)
    assert {f"file/{path.name}" for path in (DOCS / "file").iterdir()} == PAGES.keys() - {FIRST}
    first = (DOCS / FIRST).read_text(encoding="utf-8")
    for name in PAGES.keys() - {FIRST}:
        picture = f"images/{name.removesuffix('md')}svg"
        assert f"({name})" in first
        assert f"](../{picture})" in (DOCS / name).read_text(encoding="utf-8")
        assert (DOCS / picture).is_file()


@pytest.mark.parametrize("name", sorted(PAGES.keys() - {FIRST}))
def test_the_words_of_a_figure_are_keys_of_its_page(name: str) -> None:
    """What is set in the type of keys: keys, kinds, or words that are explained on the page in that type."""
    page = (DOCS / name).read_text(encoding="utf-8")
    drawn = re.findall(r"monospace[^>]*>([^<]+)<", (DOCS / "images" / f"{name.removesuffix('md')}svg").read_text())
    known = set(re.findall(r"\w+", " ".join(re.findall(r"```.*?```|`[^`\n]+`", page, flags=re.DOTALL))))
    assert drawn
    assert set(re.findall(r"[a-z_]{2,}", " ".join(drawn))) <= known


def test_the_hand_written_example_of_the_first_page_loads() -> None:
    example = (DOCS / FIRST).read_text(encoding="utf-8").split("```yaml\n")[1].split("```")[0]
    assert loads(example).lines["rope"].length == 20.0


def test_every_key_of_the_schema_is_described() -> None:
    schema = json_schema()
    for name, block in {"Scenario": schema, **schema["$defs"]}.items():
        for key, value in block["properties"].items():
            assert "const" in value or value.get("description"), f"{name}.{key}"


def test_quantities_carry_their_unit_and_bounds() -> None:
    line = json_schema()["$defs"]["Line"]["properties"]
    assert (line["mass"]["unit"], line["mass"]["exclusiveMinimum"]) == ("kg/m", 0)
    assert line["length"]["unit"] == "m"
    assert "default" not in line["length"]


def test_variants_require_their_kind() -> None:
    schema = json_schema()
    assert schema["$defs"]["Dynamic"]["required"][0] == "kind"
    assert schema["properties"]["run"]["oneOf"]


def test_no_reference_in_the_schema_leads_nowhere() -> None:
    schema = json_schema()

    def references(node: Any) -> list[str]:
        entries = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
        own = [node["$ref"]] if isinstance(node, dict) and "$ref" in node else []
        return own + [found for entry in entries for found in references(entry)]

    assert {ref.rsplit("/", 1)[1] for ref in references(schema)} <= set(schema["$defs"])


def test_the_pages_name_every_key() -> None:
    for model, page in ((Line, "file/lines.md"), (Travel, "file/travel.md")):
        text = reference(page)
        for name, field in model.model_fields.items():
            assert name == "kind" or f"| `{field.alias or name}`" in text
