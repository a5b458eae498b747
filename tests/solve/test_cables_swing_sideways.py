"""The lowest mode of a sagging cable is out of its plane, however it is given and whoever computes it.

Source: small motions about the elastic catenary (Irvine, Cable structures), (A r')' = -w^2 m r over the unstrained
length, with A = EA along the cable and T / (1 + e) across it; by collocation at Chebyshev's points.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner

from ropewalk.cli.app import app
from ropewalk.model import Scenario
from ropewalk.scenario import dump
from ropewalk.simulate import spectrum_of
from ropewalk.solve.spectrum import Modes
from ropewalk.theory.rope import elastic_catenary

Array = NDArray[np.float64]
SPAN, RISE, LENGTH, MASS, EA = 20.0, 3.0, 22.0, 1.2, 5e4
MODES = 6


def chebyshev(count: int) -> tuple[Array, Array]:
    """Points from 1 to -1 and the matrix of derivatives there (Trefethen, Spectral methods in MATLAB, cheb)."""
    i = np.arange(count + 1)
    x = np.cos(np.pi * i / count)
    c = np.where((i == 0) | (i == count), 2.0, 1.0) * (-1.0) ** i
    apart = x[:, None] - x
    D = np.outer(c, 1.0 / c) / (apart + np.eye(count + 1))
    return x, D - np.diag(D.sum(axis=1))


def exact() -> Array:
    """The lowest frequencies, rad/s: in the plane of the cable, and across it."""
    x, D = chebyshev(60)
    cable = elastic_catenary(span=SPAN, height=RISE, length=LENGTH, weight=9.81 * MASS, axial_stiffness=EA)
    s, D = 0.5 * LENGTH * (1.0 - x), -2.0 / LENGTH * D
    T = cable.tension(s)
    way = D @ cable.position(s)
    way /= np.linalg.norm(way, axis=1)[:, None]
    one = np.eye(2)
    A = EA * way[:, :, None] * way[:, None] + (T / (1.0 + T / EA))[:, None, None] * (
        one - way[:, :, None] * way[:, None]
    )
    inner = slice(1, -1)
    plane = np.block([[(D @ (A[:, a, b, None] * D))[inner, inner] for b in (0, 1)] for a in (0, 1)])
    across = (D @ ((T / (1.0 + T / EA))[:, None] * D))[inner, inner]
    squares = np.concatenate([np.linalg.eigvals(-operator / MASS) for operator in (plane, across)])
    assert np.abs(squares.imag).max() < 1e-6 * np.abs(squares).max()
    return np.sqrt(np.sort(squares.real))[:MODES]


def cable(elements: int, turned: bool = False, **more: Any) -> dict[str, Any]:
    """A cable in the plane of x and z, or, as points in space, in a plane turned about z by a given angle."""
    c, s = (0.6, 0.8) if turned else (1.0, 0.0)
    end = [c * SPAN, s * SPAN, RISE] if turned else [SPAN, RISE]
    line = {"start": [0] * len(end), "end": end, "length": LENGTH, "mass": MASS, "axial_stiffness": EA}
    return {**line, "elements": elements, **more}


def halves(elements: int) -> dict[str, Any]:
    """The same of two lines that are joined in the middle, computed as a network."""
    middle = {"length": 0.5 * LENGTH, "elements": elements // 2}
    joined = {"kind": "joined", "to": "knot"}
    whole, near = cable(elements), [0.5 * SPAN, 0.5 * RISE - 4.0]
    lines = {
        "left": {**whole, **middle, "end": near, "end_support": joined},
        "right": {**whole, **middle, "start": near, "start_support": joined},
    }
    return {"joints": {"knot": {}}, "lines": lines}


STRUCTURES: dict[str, Any] = {
    "rope": lambda elements: {"lines": {"line": cable(elements)}},
    "rope in space": lambda elements: {"lines": {"line": cable(elements, turned=True)}},
    "stiff line": lambda elements: {"lines": {"line": cable(elements, bending_stiffness=1e-9)}},
    "network": halves,
}


def modes_of(structure: dict[str, Any]) -> Modes:
    found = spectrum_of(Scenario.model_validate({**structure, "run": {"kind": "equilibrium"}}), how_many=8).modes
    assert found is not None
    return found


@pytest.mark.parametrize("name", STRUCTURES)
def test_a_cable_has_the_frequencies_of_small_motions_about_the_catenary(name: str) -> None:
    known, errors, build = exact(), [], STRUCTURES[name]
    for elements in (20, 40, 80):
        errors.append(modes_of(build(elements)).frequency[:MODES] / known - 1.0)
    order = np.log2(np.abs(np.divide(errors[:-1], errors[1:])))
    print("exact", known, "errors", np.array(errors), "orders", order)
    assert known[1] > 1.5 * known[0]  # what would be taken for the lowest without the motion sideways
    if name == "network":  # on splines: of fourth order but near held ends, where it is of third
        assert np.abs(errors[-1]).max() < 1e-5
        assert np.abs(order[:, 0] - 3.0).max() < 0.12
        assert order[:, 1:3].min() > 3.9  # modes that end in errors of either sign have no order on these meshes
    else:
        assert np.abs(errors[-1]).max() < 1.2e-3
        assert np.abs(order - 2.0).max() < 0.02


@pytest.mark.parametrize("build", STRUCTURES.values(), ids=STRUCTURES)
def test_the_lowest_mode_is_a_swing_out_of_the_plane(build: Any) -> None:
    modes = modes_of(build(40))
    ends = modes.position[-1 if "left" not in modes.line else np.flatnonzero(np.array(modes.line) == "right")[-1]]
    along = np.array([ends[0], ends[1], 0.0]) / np.hypot(ends[0], ends[1])
    sideways = np.array([-along[1], along[0], 0.0])
    first = modes.shape[0]
    assert np.abs(first @ along).max() < 1e-6
    assert np.abs(first[:, 2]).max() < 1e-6
    assert np.abs(first @ sideways).max() == pytest.approx(1.0)


@pytest.mark.parametrize("name", STRUCTURES)
def test_the_command_draws_its_modes(name: str, tmp_path: Path) -> None:
    """In two formats, by turns."""
    build, suffix = STRUCTURES[name], ("png", "svg")[list(STRUCTURES).index(name) % 2]
    file, figure = tmp_path / "cable.yaml", tmp_path / f"modes.{suffix}"
    scenario = Scenario.model_validate({**build(20), "run": {"kind": "equilibrium"}})
    file.write_text(dump(scenario), encoding="utf-8")
    out = CliRunner().invoke(app, ["spectrum", str(file), "-o", str(figure)])
    assert out.exit_code == 0, out.output
    hertz = modes_of(build(20)).frequency[0] / (2.0 * np.pi)
    assert f"{hertz:.4g}"[:4] in out.stdout
    drawn = figure.read_bytes()
    assert drawn.startswith(b"\x89PNG" if suffix == "png" else b"<?xml")
    assert len(drawn) > 10_000
