"""The reference of the scenario file, page by page, made from the schema's own descriptions."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import import_module
from posixpath import dirname, relpath
from types import ModuleType
from typing import Any

from ropewalk.model import DECLARATIONS
from ropewalk.scenario.schema import json_schema
from ropewalk.units import written

MARK = "<!-- Generated from the schema by docs/make_reference.py: do not edit below this line. -->"
"""What separates the hand-written part of a page from the generated one."""

SECTIONS = {
    "The file": ("scenario",),
    "A line": ("line", "segment", "cut", "damping", "profile"),
    "Joints and hangers": ("joint", "hangers"),
    "Rails, sleepers and ballast": ("track",),
    "Nets and membranes": ("net",),
    "Wind": ("wind",),
    "Laws": ("law", "hysteresis"),
    "Supports": ("support", "saddle"),
    "Supports between the ends of a line": ("inner_support",),
    "Loads": ("load", "mass", "oscillator", "trolley", "vehicle"),
    "Ropeways": ("carriage",),
    "Trains": ("axles", "train"),
    "Loads given by matrices": ("matrices",),
    "Loads that walk": ("footsteps", "walker", "balance"),
    "Crowds": ("crowd", "spread"),
    "Loads of your own": ("stepper", "fmu", "exchange"),
    "Travel": ("travel",),
    "Tables": ("history",),
    "Overhead lines": (
        "overhead_wire",
        "spans",
        "overhead",
        "dropper_cut",
        "condition",
        "limits",
        "pantograph",
        "head",
    ),
    "Runs": ("run",),
    "Recorded quantities": ("outputs",),
    "Many runs": ("sweep",),
}
"""Headings with the modules of `ropewalk.model` whose declarations stand below them."""

FIRST = "scenario.md"
PAGES = {
    FIRST: ("The file",),
    "file/lines.md": ("A line", "Laws"),
    "file/supports.md": ("Supports", "Supports between the ends of a line"),
    "file/loads.md": ("Loads", "Loads given by matrices"),
    "file/travel.md": ("Travel", "Tables"),
    "file/trains.md": ("Trains",),
    "file/tracks.md": ("Rails, sleepers and ballast",),
    "file/ropeways.md": ("Ropeways",),
    "file/people.md": ("Loads that walk", "Crowds"),
    "file/own.md": ("Loads of your own",),
    "file/networks.md": ("Joints and hangers",),
    "file/wind.md": ("Wind",),
    "file/nets.md": ("Nets and membranes",),
    "file/overhead-lines.md": ("Overhead lines",),
    "file/runs.md": ("Runs",),
    "file/outputs.md": ("Recorded quantities",),
    "file/sweeps.md": ("Many runs",),
}
"""Pages of docs/ with the headings on them; the first one has what no other has."""


def declarations(modules: Iterable[str]) -> list[str]:
    """The declarations of some modules of `ropewalk.model`, in the order in which they are written there."""
    homes = (import_module(f"ropewalk.model.{module}") for module in modules)
    return [name for home in homes for name in vars(home) if name in DECLARATIONS and is_from(home, name)]


def is_from(home: ModuleType, name: str) -> bool:
    """Whether a name of a module is of something that was defined in it."""
    return bool(vars(home)[name].__module__ == home.__name__)


def placed() -> dict[str, str]:
    """All declarations, in the order of the reference, with the page of each."""
    home = {heading: page for page, headings in PAGES.items() for heading in headings}
    names = {name: home.get(heading, FIRST) for heading, modules in SECTIONS.items() for name in declarations(modules)}
    return names | {name: FIRST for name in ("Scenario", *json_schema()["$defs"]) if name not in names}


def reference(page: str) -> str:
    """Write the keys of all blocks of one page as Markdown."""
    schema = json_schema()
    blocks, home = {"Scenario": schema, **schema["$defs"]}, placed()
    rows = [MARK, "", "## Keys", "", "Required keys are marked with *.", ""]
    for name in home:
        if home[name] == page:
            rows += _block(name, blocks[name], _Links(page, home))
    return "\n".join(rows).rstrip() + "\n"


def refreshed(text: str, page: str = FIRST) -> str:
    """Write a page anew: its hand-written part as it is, the reference generated."""
    return text.partition(MARK)[0] + reference(page)


@dataclass(frozen=True)
class _Links:
    """From one page to the blocks of all of them."""

    page: str
    home: dict[str, str]

    def to(self, name: str) -> str:
        there = "" if self.home[name] == self.page else relpath(self.home[name], dirname(self.page) or ".")
        return f"[{name}]({there}#{name.lower()})"


def _block(name: str, block: dict[str, Any], links: _Links) -> list[str]:
    kind = block["properties"].get("kind", {}).get("const")
    title = [f"### {name}", ""]
    if kind:
        left_out = "" if "kind" in block.get("required", []) else " (may be left out)"
        title += [f"`kind: {kind}`{left_out}", ""]
    properties = {key: value for key, value in block["properties"].items() if "const" not in value}
    rows = [*title, _cell(block.get("description", "")), ""]
    if properties:
        rows += ["| key | value | default | meaning |", "|---|---|---|---|"]
        required = block.get("required", [])
        for key, value in properties.items():
            star = " *" if key in required else ""
            meaning = _cell(value.get("description", ""))
            rows.append(f"| `{key}`{star} | {_value(value, links)} | {_default(value)} | {meaning} |")
        rows.append("")
    return rows


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|") if text.count("\n\n") == 0 else text


def _value(schema: dict[str, Any], links: _Links) -> str:
    options = schema.get("oneOf") or schema.get("anyOf")
    if options:
        return " or ".join(dict.fromkeys(_value(option, links) for option in options))
    if "$ref" in schema:
        return links.to(schema["$ref"].rsplit("/", 1)[1])
    if "enum" in schema:
        return ", ".join(f"`{word}`" for word in schema["enum"])
    if "unit" in schema:
        bound = ", > 0" if "exclusiveMinimum" in schema else ", >= 0" if "minimum" in schema else ""
        return ("number" if schema["unit"] == "dimensionless" else schema["unit"]) + bound
    kind = schema.get("type")
    if kind == "array" and "prefixItems" in schema:
        return f"{len(schema['prefixItems'])} of: {_value(schema['prefixItems'][0], links)}"
    if kind == "array":
        return f"list of {_value(schema['items'], links)}"
    if kind == "object" and "properties" in schema:
        return f"`{{{', '.join(f'{key}: ...' for key in schema['properties'])}}}`"
    if kind == "object":
        inner = schema.get("additionalProperties")
        return f"names, each with {_value(inner, links)}" if isinstance(inner, dict) else "names, each with a value"
    if kind == "integer":
        return f"{schema['minimum']} to {schema['maximum']}"
    return {"string": "text", "boolean": "true or false"}.get(str(kind), str(kind))


def _default(schema: dict[str, Any]) -> str:
    if "default" not in schema:
        return ""
    default = schema["default"]
    if isinstance(default, dict):
        telling = {key: value for key, value in default.items() if key in ("kind", "until")}
        return f"`{{{', '.join(f'{key}: {value}' for key, value in telling.items())}}}`"
    if isinstance(default, int | float) and "unit" in schema:
        angle = schema["unit"] == "rad"  # a whole number of degrees is not one of radians
        default = f"{math.degrees(default):.6g} deg" if angle else written(default, schema["unit"])
    return f"`{_plain(default)}`"


def _plain(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
