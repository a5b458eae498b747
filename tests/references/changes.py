"""Changes of a scenario: half the elements, and changes of physical parameters that a comparison has to detect."""

from __future__ import annotations

import json
from typing import Any

from conformance.structures import Tree
from ropewalk.model.mesh import OF_BEAMS
from ropewalk.model.scenario import Scenario
from ropewalk.results.contract import scenario_text

CONTROL = "nothing"
PLANTED: dict[str, tuple[tuple[str, ...], float]] = {
    CONTROL: (("axial_stiffness",), 1.0),
    "EA": (("axial_stiffness",), 1.02),
    "EI": (("bending_stiffness",), 1.02),
    "damping": (("damping", "axial_damping", "drag", "retardation"), 1.2),
    "friction": (("friction",), 1.2),
    "contact_stiffness": (("contact_stiffness",), 1.2),
    "dropper stiffness": (("droppers.stiffness",), 1.2),
}
"""Keys of a scenario and the factor by which their numbers are multiplied; the control must not be detected."""


def half(tree: Tree) -> Tree | None:
    """Return a scenario with half the elements; None if it has no mesh that can be halved."""
    found = dict(tree)
    found["lines"] = {name: _halved(line, "elements") for name, line in tree.get("lines", {}).items()}
    found["overhead_lines"] = {name: _doubled(line, "element") for name, line in tree.get("overhead_lines", {}).items()}
    found["nets"] = {name: _halved_net(net) for name, net in tree.get("nets", {}).items()}
    found = {key: value for key, value in found.items() if value or key in tree}
    return None if found == tree else found


def _halved(block: Tree, key: str) -> Tree:
    count = block.get(key)
    return {**block, key: max((count + 1) // 2, OF_BEAMS)} if isinstance(count, int) and count > OF_BEAMS else block


def _doubled(block: Tree, key: str) -> Tree:
    return {**block, key: 2.0 * block[key]} if isinstance(block.get(key), int | float) else block


def _halved_net(net: Tree) -> Tree:
    if isinstance(net.get("cells"), list):
        return {**net, "cells": [max((n + 1) // 2, 2) for n in net["cells"]]}
    return _doubled(net, "spacing")


def planted(scenario: Scenario, change: str) -> Tree | None:
    """Return the assembled scenario with a planted change; None if it has no such parameter."""
    keys, factor = PLANTED[change]
    count = 0

    def multiplied(value: Any) -> Any:
        nonlocal count
        if isinstance(value, list):
            return [multiplied(entry) for entry in value]
        if isinstance(value, int | float) and not isinstance(value, bool) and value:
            count += 1
            return factor * value
        return value

    def walk(value: Any, path: str) -> Any:
        if isinstance(value, list):
            return [walk(entry, path) for entry in value]
        if not isinstance(value, dict):
            return value
        return {
            key: multiplied(entry) if is_meant(key, path) and not isinstance(entry, dict) else walk(entry, key)
            for key, entry in value.items()
        }

    def is_meant(key: str, path: str) -> bool:
        return key in keys or f"{path}.{key}" in keys

    tree = walk(json.loads(scenario_text(scenario)), "")
    return tree if count else None
