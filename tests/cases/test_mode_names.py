"""The spectrum lists its modes with frequency, damping and a name of the shape."""

from __future__ import annotations

import numpy as np
import pytest
from typer.testing import CliRunner

import ropewalk
from ropewalk.cli.app import app
from ropewalk.results.spectrum import Modes, mode_names
from ropewalk.scenario import loads

BEAM = """
lines:
  deck: {start: START, end: END, length: 20, mass: 100, bending_stiffness: 1 MN*m^2, axial_stiffness: 100 MN,
    elements: 12}
gravity: 0
run: {kind: equilibrium}
"""


@pytest.mark.parametrize(
    ("start", "end"), [("[0, 0, 0]", "[20, 0, 0]"), ("[20, 4, 0]", "[0.4, 0, 0]"), ("[0, 0, 0]", "[0, 20, 0]")]
)
def test_modes_of_a_beam_are_named_by_direction_and_half_waves(start, end):
    found = ropewalk.spectrum(loads(BEAM.replace("START", start).replace("END", end)))
    named = [mode["shape"] for mode in found.as_dict()["modes"]]
    for direction in ("vertical", "lateral"):
        assert [name for name in named if name.startswith(direction)][:3] == [
            f"{direction}, 1 half-wave", f"{direction}, 2 half-waves", f"{direction}, 3 half-waves"
        ]  # fmt: skip


def test_the_command_prints_one_row_for_each_of_the_lowest_modes(tmp_path):
    (tmp_path / "beam.yaml").write_text(BEAM.replace("START", "[0, 0]").replace("END", "[20, 0]"))
    rows = CliRunner().invoke(app, ["spectrum", str(tmp_path / "beam.yaml")]).stdout.splitlines()
    head = next(i for i, row in enumerate(rows) if row.startswith("mode "))
    assert rows[head].split() == ["mode", "frequency", "period", "damping", "ratio", "shape"]
    number, frequency, unit = rows[head + 1].split()[:3]
    exact = np.pi / 2.0 / 20.0**2 * np.sqrt(1e6 / 100.0)  # Hz, of a hinged beam
    assert (number, unit) == ("1", "Hz")
    assert float(frequency) == pytest.approx(exact, rel=1e-2)  # twelve elements are 0.6 % too soft
    assert rows[head + 1].endswith("1 half-wave")


def grid(name: str, y: float, count: int) -> tuple[np.ndarray, list[str]]:
    x = np.linspace(0.0, 10.0, count)
    return np.stack([x, np.full(count, y), np.zeros(count)], axis=1), [name] * count


def test_girders_that_move_in_opposite_directions_are_torsional_and_moving_along_is_axial():
    (left, a), (right, b) = grid("left", 1.0, 9), grid("right", -1.0, 9)
    wave = np.sin(np.pi * left[:, 0] / 10.0)
    shape = np.zeros((3, 18, 3))
    shape[0, :, 2], shape[1, :, 2], shape[2, :, 0] = np.r_[wave, wave], np.r_[wave, -wave], np.r_[wave, wave]
    modes = Modes(np.ones(3), np.zeros(3), shape, np.concatenate([left, right]), (*a, *b))
    assert [name.partition(",")[0] for name in mode_names(modes)] == ["vertical", "torsional", "axial"]


def test_modes_of_a_net_are_named_without_half_waves():
    rows = [grid("net", y, 9)[0] for y in range(9)]
    place = np.concatenate(rows)
    shape = np.zeros((1, 81, 3))
    shape[0, :, 2] = np.sin(np.pi * place[:, 0] / 10.0)
    assert mode_names(Modes(np.ones(1), np.zeros(1), shape, place, ("net",) * 81)) == ["vertical"]


def test_a_slack_beam_in_any_direction_has_the_same_modes_and_no_warning():
    slack, found = BEAM.replace("length: 20", "length: 20.1").replace("gravity: 0\n", ""), []
    for end in ("[20, 0, 0]", "[0, 20, 0]", "[-12, 16, 0]"):
        with np.errstate(all="raise", under="ignore"):
            modes = ropewalk.spectrum(loads(slack.replace("START", "[0, 0, 0]").replace("END", end))).as_dict()["modes"]
        found.append([mode["shape"] for mode in modes[:4]])  # higher ones are lateral and vertical at one frequency
    assert found[1] == found[2]
    assert not any("torsional" in name for names in found for name in names)
