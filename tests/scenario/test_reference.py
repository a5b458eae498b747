"""The schema and the reference page say the same as the declarations."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ropewalk.model import Line, Travel
from ropewalk.scenario import json_schema, loads, reference
from ropewalk.scenario.reference import MARK, refreshed

PAGE = Path(__file__).parents[2] / "docs" / "scenario.md"


def test_the_committed_page_is_the_generated_one() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert MARK in page
    assert page == refreshed(page), "write refreshed(page) into docs/scenario.md"


def test_the_hand_written_example_of_the_page_loads() -> None:
    example = PAGE.read_text(encoding="utf-8").split("```yaml\n")[1].split("```")[0]
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


def test_the_page_names_every_key() -> None:
    page = reference()
    for model in (Line, Travel):
        for name, field in model.model_fields.items():
            assert f"| `{field.alias or name}`" in page
