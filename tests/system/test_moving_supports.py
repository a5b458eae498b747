"""Supports of joined lines that move: beside the chain, a rope that only the engine of networks computes as one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.results.frame import ENERGY_FORMS
from ropewalk.simulate import simulate

ROPE: dict[str, Any] = {
    "start": [0, 0], "end": [19.0, 1.0], "length": 19.3, "mass": 1.0, "axial_stiffness": 5e4, "elements": 80,
    "drag": 0.3,
}  # fmt: skip


def swings(t: float) -> tuple[float, float]:
    s = np.sin(np.pi * min(t / 0.5, 1.0)) ** 4
    return 0.05 * s, -0.1 * s


SUPPORTS: dict[str, dict[str, Any]] = {
    "moving": {"kind": "moving", "displacement": swings},
    "shaken": {"kind": "elastic", "stiffness": 1e4, "damping": 200.0, "mass": 2.0, "displacement": swings},
}
LOADS: dict[str, dict[str, Any]] = {
    "none": {},
    "force": {"kind": "force", "on": "rope", "force": [0, -50.0], "travel": {"speed": 0.0, "from": 19.2}},
}


def both(run: dict[str, Any], support: dict[str, Any], load: dict[str, Any], elements: int = 0) -> Any:
    """The same rope on the chain, and as a network: in calm air."""
    calm = {"wind": {"direction": [1, 0], "speed": 0.0}}
    for more, drag in (({}, {}), (calm, {"wind_drag": 0.01})):
        line = {**ROPE, **drag, "end_support": support} | ({"elements": elements} if elements else {})
        tree = {"lines": {"rope": line}, "loads": {"load": load} if load else {}, "run": run, **more}
        yield simulate(Scenario.model_validate(tree))


def test_a_chain_comes_to_the_network_with_the_square_of_its_links() -> None:
    away = []
    for elements in (40, 80):
        chain, network = both({"kind": "dynamic", "until": 0.6, "every": 0.02}, SUPPORTS["moving"], {}, elements)
        away.append(float(np.abs(network.position.values - chain.position.values).max()))
    assert away[1] < away[0] / 3.5


@pytest.mark.parametrize("load", LOADS.values(), ids=LOADS)
@pytest.mark.parametrize("support", SUPPORTS.values(), ids=SUPPORTS)
def test_a_network_moves_with_its_supports_as_a_chain(support: dict[str, Any], load: dict[str, Any]) -> None:
    """With a force within the last link, too."""
    chain, network = both({"kind": "dynamic", "until": 0.6, "every": 0.02, "method": "auto"}, support, load)
    assert network.attrs["outcome"] == chain.attrs["outcome"] == "completed"
    away = np.abs(network.position.values - chain.position.values).max()
    forces = np.abs(network.reaction.values - chain.reaction.values).max() / np.abs(chain.reaction.values).max()
    ends = {form: [float(r.energy.sel(form=form)[-1]) for r in (chain, network)] for form in ENERGY_FORMS}
    print("away", away, "reaction", forces, ends)
    # The chain is right to the second order of its links, and lets two nodes share a load in the last one.
    assert away < (1e-2 if load else 1.5e-3)
    assert forces < (1.0 if load else 1e-3)
    assert abs(ends["support_work"][0]) > 1.0
    assert ends["support_work"][1] == pytest.approx(ends["support_work"][0], rel=2e-2 if load else 5e-3)
    assert ends["line_damping"][1] == pytest.approx(ends["line_damping"][0], rel=0.05)
    imbalance = np.abs(network.energy.sel(form="imbalance")).max().item()
    assert imbalance < 2e-3 * abs(ends["support_work"][0])


def test_what_moves_as_prescribed_has_the_speed_of_its_way() -> None:
    """It was none and twice that in turn."""
    table = {"time": [0.0, 0.6], "value": [[0, 0], [0.06, -0.12]]}
    for result in both({"kind": "dynamic", "until": 0.6, "every": 0.02}, {"kind": "moving", "displacement": table}, {}):
        speed = result.velocity.values[1:-1, -1]
        assert speed == pytest.approx(np.tile([0.1, -0.2], (len(speed), 1)), rel=1e-9)


@pytest.mark.parametrize("support", SUPPORTS.values(), ids=SUPPORTS)
def test_a_slow_load_finds_supports_of_networks_where_they_are_then(support: dict[str, Any]) -> None:
    load = {**LOADS["force"], "travel": {"speed": 30.0, "from": 1.0}}  # there in 0.6 s
    table = {"time": [0.0, 0.6], "value": [[0, 0], [0.05, -0.1]]}
    chain, network = both({"kind": "quasistatic", "positions": 4}, {**support, "displacement": table}, load)
    np.testing.assert_allclose(network.position.values[:, -1], chain.position.values[:, -1], atol=1e-5)
    np.testing.assert_allclose(
        network.position, chain.position, atol=2e-4
    )  # polygons under half links, of second order
    assert chain.position.values[-1, -1] == pytest.approx([19.05, 0.9], abs=0.05)
