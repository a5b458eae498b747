"""Numbers are shown in units that a person would choose, or in those asked for; JSON and tables stay in SI units."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from ropewalk.cli.app import app
from ropewalk.errors import Refused
from ropewalk.results import DisplayUnits, Recorder, summary, tables, text
from ropewalk.results.display_units import Column, number
from ropewalk.units import to_si


@pytest.mark.parametrize(
    ("unit", "values", "displayed"),
    [
        ("N", [3.0, 900.0], "N"),
        ("N", [3.0, -1500.0], "kN"),
        ("N", [2e7], "MN"),
        ("N", [0.0], "N"),
        ("m", [0.012], "mm"),
        ("m", [1.2], "m"),
        ("m/s", [1.4], "m/s"),
        ("m/s", [69.4], "km/h"),
        ("s", [1.3e-4], "µs"),
        ("J", [np.nan, 5e4], "kJ"),
        ("strain", [0.02], "%"),
        ("1", [0.5], ""),
    ],
)
def test_the_largest_of_like_numbers_decides(unit, values, displayed):
    assert DisplayUnits.read(None).of(unit, values).symbol == displayed


@pytest.mark.parametrize("asked", ["kN", "mm", "km/h", "kJ", "lbf", "deg", "%", "ms"])
def test_a_unit_that_is_asked_for_replaces_that_of_the_quantity(asked):
    si = {"kN": "N", "mm": "m", "km/h": "m/s", "kJ": "J", "lbf": "N", "deg": "rad", "%": "strain", "ms": "s"}[asked]
    chosen = DisplayUnits.read(f"SI,{asked}").of(si, [1.0])
    base = "dimensionless" if si == "strain" else si
    assert chosen.size == pytest.approx(to_si(f"1 {asked}", base))
    assert DisplayUnits.read(f"SI,{asked}").of("W", [1e6]).symbol == "W"


@pytest.mark.parametrize(("asked", "said"), [("kNN", "unknown unit"), ("kg", "no quantity is shown in kg")])
def test_a_unit_of_nothing_is_refused(asked, said):
    with pytest.raises(Refused, match=said):
        DisplayUnits.read(asked)


def test_like_things_stand_in_one_unit_and_rounding_is_zero():
    say = Column(DisplayUnits.read(None), {"value": 3639.0, "unit": "N"}, floor={"N": 1e-5})
    assert [say(3639.0, "N"), say(219.5, "N"), say(1e-9, "N"), say(None, "N")] == ["3.639 kN", "0.2195 kN", "0 kN", "–"]
    assert say(12.0, "N") == "12.00 N"  # far smaller than the column: in its own unit
    assert say.span(-3575.0, -206.8, "N") == "-3.575 to -0.207 kN"
    assert say.span(800.0, 800.0, "N") == "0.8000 kN"


def test_the_summary_is_written_in_the_units_asked_for(result):
    found = summary(result)
    si, kilo = text(found, DisplayUnits.read("SI")), text(found, DisplayUnits.read("kN,mm"))
    largest, sag = found["largest_tension"]["value"], found["largest_sag"]["value"]
    assert f"{largest:.0f} N " in si
    assert f"{largest / 1e3:.3f} kN" in kilo
    assert f"{sag:.3f} m " in si
    assert f"{1e3 * sag:.0f} mm" in kilo
    assert found == summary(result)


def test_the_place_of_an_extreme_is_told_along_the_line_and_in_space(result):
    found = summary(result)["largest_tension"]
    frame = int(np.abs(result["time"].values - found["time"]).argmin())
    xi, x = result["xi"].values, result["position"].sel(axis="x").values[frame]
    assert found["x"] == pytest.approx(np.interp(found["xi"], xi, x))
    assert f"x = {number(found['x'])} m, xi = {number(found['xi'])} m" in text(summary(result))


def test_there_are_no_rows_about_nothing(result):
    tiny = 1e-9 * result["contact_force"]
    still = result.assign(
        hold_force=tiny.assign_attrs(result["hold_force"].attrs),
        contact_friction=(0.0 * result["contact_friction"]).assign_attrs(result["contact_friction"].attrs),
    )
    for what in ("largest hold force", "friction coefficient needed"):
        assert what not in text(summary(still))
    assert "largest hold force" in text(summary(result))
    zero = result.assign(tension=(0.0 * result["tension"]).assign_attrs(result["tension"].attrs))
    assert "smallest tension" not in text(summary(zero))  # a beam that only bends
    unknown = result.assign(strain=(np.nan * result["strain"]).assign_attrs(result["strain"].attrs))
    assert "strain" not in text(summary(unknown))


@pytest.mark.parametrize(("needed", "told"), [(0.8, False), (18.0, True)])
def test_a_coefficient_that_no_surfaces_have_is_what_a_clamp_bears(result, needed, told):
    felt = (0.0 * result["contact_friction"] + needed).assign_attrs(result["contact_friction"].attrs)
    row = next(row for row in text(summary(result.assign(contact_friction=felt))).splitlines() if "needed" in row)
    assert ("requires a clamp" in row) == told


def test_tables_stay_in_si_until_units_are_asked_for(result):
    plain, displayed = tables(result), tables(result, units=DisplayUnits.read("kN,mm"))
    column = "rope.largest_tension"
    np.testing.assert_allclose(displayed["series"][f"{column} [kN]"], plain["series"][f"{column} [N]"] / 1e3)
    np.testing.assert_allclose(
        displayed["series"]["rope.largest_sag [mm]"], 1e3 * plain["series"]["rope.largest_sag [m]"]
    )
    np.testing.assert_array_equal(
        displayed["series"]["walker.position.x [m]"], plain["series"]["walker.position.x [m]"]
    )
    rows = displayed["summary"].set_index("quantity")
    assert rows.loc["largest_tension", "unit"] == "kN"
    assert rows.loc["largest_tension", "value"] == pytest.approx(summary(result)["largest_tension"]["value"] / 1e3)


def test_the_command_line_takes_units_and_keeps_json_in_si(make, tmp_path):
    make(file=tmp_path / "a.nc", times=np.linspace(0.0, 1.0, 11)).close()

    def call(*arguments):
        return CliRunner().invoke(app, ["show", str(tmp_path / "a.nc"), *arguments])

    assert " kN " in call().stdout
    assert " kN" not in call("--units", "SI").stdout
    plain, asked = (json.loads(call("--json", *more).stdout) for more in ([], ["--units", "kN"]))
    assert plain == asked
    wrong = call("--units", "kNN")
    assert wrong.exit_code == 2
    assert "--units kNN: unknown unit" in wrong.output


def crab():
    """A trolley at rest 1 m above its payload, which swings by 0.2 m on a rope of 0.99 m and 10 kN/m."""
    from dataclasses import replace

    import travelling_wave as wave

    from ropewalk.model import Scenario

    times = 0.05 * np.arange(41)
    plan = replace(wave.layout(links=4), body=("walker.payload",))
    tree = wave.scenario().model_dump(by_alias=True, exclude_none=True)
    payload = {"mass": 10.0, "length": 0.99, "stiffness": 1e4}
    tree["loads"] = {
        "walker": {"kind": "trolley", "on": "rope", "mass": 1.0, "payload": payload, "travel": {"speed": 1.0}}
    }
    with Recorder(plan, Scenario.model_validate(tree), wave.run_info()) as recorder:
        for time, frame in zip(times, wave.frames(plan, times), strict=True):
            aside, rate = 0.2 * np.sin(3.0 * time), 0.6 * np.cos(3.0 * time)
            swung = frame.contact_position[:1] + np.array([[aside, -np.sqrt(1.0 - aside**2)]])
            recorder.append(replace(frame, body_position=swung, body_velocity=np.array([[rate, 0.0]])))
    return recorder.close()


def test_payloads_sway_and_pull_at_their_ropes():
    found = summary(crab())["payloads"]["walker"]
    assert found["sway"]["value"] == pytest.approx(0.2, rel=1e-2)  # it turns between outputs
    assert found["swing"]["value"] == pytest.approx(np.arcsin(0.2), rel=1e-2)
    assert found["pull"]["value"] == pytest.approx(1e4 * 0.01)  # k (l - L)
    assert found["speed"]["value"] == pytest.approx(0.6)
    assert found["slack"]["value"] == 0.0
    table = text(summary(crab()))
    for row in ("largest sway 199.6 mm", "largest angle from the vertical 11.5°", "largest pull of its rope 100.0 N"):
        assert any(line.split()[: len(row.split())] == row.split() for line in table.splitlines()), row


def test_ropes_of_payloads_are_as_stiff_here_as_in_the_motion():
    from ropewalk.mechanics.multibody_system import STRETCH as moving
    from ropewalk.results.hanging import STRETCH

    assert moving == STRETCH
