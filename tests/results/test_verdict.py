"""Whether a run can be trusted: each doubt is raised by what it is for, and stays silent otherwise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import travelling_wave as wave
import xarray as xr

from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.model import Scenario
from ropewalk.results import Recorder, summary, text
from ropewalk.results.audit import turnover
from ropewalk.results.frame import ENERGY_FORMS, OFF_LINE, Doubt, Frame, Layout, RunInfo
from ropewalk.results.peaks import impulses, lonely
from ropewalk.results.statistics import Summary
from ropewalk.simulate import simulate

AUDIT = ENERGY_FORMS.index("imbalance")
TIMES = np.linspace(0.0, wave.UNTIL, 181)
Change = Callable[[int, Frame], Frame]


def watched(
    change: Change = lambda i, frame: frame, plan: Layout | None = None, scenario: Scenario | None = None
) -> RunInfo:
    """The account of a recorded wave whose frames have been changed."""
    plan, run_info = plan or wave.layout(), wave.run_info()
    with Recorder(plan, scenario or wave.scenario(), run_info) as recorder:
        for i, frame in enumerate(wave.frames(plan, TIMES)):
            recorder.append(change(i, frame))
    return run_info


def doubt(run_info: RunInfo) -> Doubt:
    """The only doubt of a doubtful run."""
    assert run_info.outcome == "doubtful"
    (found,) = run_info.doubts
    assert found.what
    assert found.cause
    assert found.remedy
    return found


@cache
def turned_over() -> float:
    """Energy turned over by the whole wave, J."""
    return float(turnover(np.array([frame.energy for frame in wave.frames(wave.layout(), TIMES)])).max())


def missing(share: float, at: int = 100) -> Change:
    """An imbalance of a part of all energy turned over, which comes about in one frame."""

    def change(i: int, frame: Frame) -> Frame:
        energy = frame.energy.copy()
        energy[AUDIT] = share * turned_over() * (i >= at)
        return replace(frame, energy=energy)

    return change


def test_a_run_without_fault_is_completed() -> None:
    run_info = watched()
    assert (run_info.outcome, run_info.doubts) == ("completed", [])


def test_more_than_a_twentieth_of_the_energy_may_not_be_missing() -> None:
    assert watched(missing(0.049)).outcome == "completed"
    found = doubt(watched(missing(0.051)))
    assert "5.1 % of the energy throughput" in found.what
    assert found.key == "lines"


def test_what_rounding_makes_of_a_large_energy_is_not_missing() -> None:
    def still(i: int, frame: Frame) -> Frame:
        energy = np.zeros(len(ENERGY_FORMS))
        energy[2] = 1e9
        energy[AUDIT] = 0.05 * (i % 2)  # 5e-11 of the energy that is there
        return replace(frame, energy=energy)

    assert watched(still).outcome == "completed"


def test_an_imbalance_that_comes_when_a_load_leaves_is_laid_to_that() -> None:
    def change(i: int, frame: Frame) -> Frame:
        frame = missing(0.2, at=150)(i, frame)
        return replace(frame, contact_state=np.full(1, OFF_LINE)) if i >= 150 else frame

    found = doubt(watched(change))
    assert "leaves its line" in found.cause
    assert found.key == "loads.walker.travel"


def test_an_imbalance_above_the_wave_speed_is_laid_to_the_speed() -> None:
    def change(i: int, frame: Frame) -> Frame:
        return replace(missing(0.2)(i, frame), contact_tension=np.full((1, 2), 50.0), contact_speed=np.full(1, 10.0))

    found = doubt(watched(change))  # 10 m/s over the root of 50 N / 1 kg/m
    assert "1.41 times the speed of transverse waves" in found.cause
    assert found.key == "loads.walker.travel.speed"


def test_an_imbalance_in_compression_is_laid_to_the_damping() -> None:
    def change(i: int, frame: Frame) -> Frame:
        return replace(missing(0.2)(i, frame), tension=frame.tension - 1e4 * (i >= 99))

    assert doubt(watched(change)).key == "lines.rope.axial_damping"


def test_an_audit_without_numbers_is_doubtful_unless_it_is_said_why() -> None:
    def change(i: int, frame: Frame) -> Frame:
        return missing(np.nan)(i, frame)

    assert "no energy audit" in doubt(watched(change)).what
    run_info = RunInfo(audit="the theory keeps no energies")
    with Recorder(wave.layout(), wave.scenario(), run_info) as recorder:
        for i, frame in enumerate(wave.frames(wave.layout(), TIMES)):
            recorder.append(change(i, frame))
    assert run_info.outcome == "completed"
    found = summary(recorder.close())
    assert found["energy"]["audit"] == "the theory keeps no energies"
    assert "the theory keeps no energies" in text(found)


def test_a_load_that_is_never_on_its_line_is_named() -> None:
    def change(i: int, frame: Frame) -> Frame:
        nowhere = np.full_like(frame.contact_force, np.nan)
        return replace(frame, contact_state=np.full(1, OFF_LINE), contact_force=nowhere)

    found = doubt(watched(change))
    assert found.what == "load walker is never on rope"
    assert found.key == "loads.walker.travel"


def test_a_load_that_leaves_at_once_but_was_there_is_fine() -> None:
    def change(i: int, frame: Frame) -> Frame:
        if i < 3:
            return frame
        nowhere = np.full_like(frame.contact_force, np.nan)
        return replace(frame, contact_state=np.full(1, OFF_LINE), contact_force=nowhere)

    assert watched(change).outcome == "completed"


@pytest.mark.parametrize(("force", "outcome"), [(1e-3, "completed"), (1e-11, "doubtful"), (0.0, "doubtful")])
def test_a_load_presses_more_than_rounding_does(force: float, outcome: str) -> None:
    def change(i: int, frame: Frame) -> Frame:
        return replace(frame, contact_force=np.array([[0.0, -force]]))

    run_info = watched(change)
    assert run_info.outcome == outcome
    if outcome == "doubtful":
        assert doubt(run_info).key == "loads.walker.force"


def test_a_force_that_comes_from_one_step_is_doubtful() -> None:
    def peak(width: int, times: float) -> Change:
        def change(i: int, frame: Frame) -> Frame:
            high = 90 <= i < 90 + width
            return replace(frame, contact_force=frame.contact_force * (times if high else 1.0))

        return change

    assert watched(peak(1, 8.0)).outcome == "completed"
    assert watched(peak(3, 50.0)).outcome == "completed"
    found = doubt(watched(peak(1, 50.0)))
    assert "contact force of load walker" in found.what
    assert found.key == "loads.walker"


def test_a_tension_that_comes_from_one_step_is_doubtful() -> None:
    def change(times: float) -> Change:
        return lambda i, frame: replace(frame, tension=frame.tension * (times if i == 90 else 1.0))

    assert watched(change(5.0)).outcome == "completed"
    assert "largest tension" in doubt(watched(change(50.0))).what


def test_a_peak_of_tension_that_instants_are_too_far_apart_for_is_remarked() -> None:
    """A sine that is squared, of which a part may be missed: the remark names what is beside the peak."""

    def swung(instants: float, part: float = 1.0) -> Change:
        return lambda i, frame: replace(
            frame, tension=part * frame.tension * (1.0 + 4.0 * np.sin(np.pi * i / instants) ** 2)
        )

    assert not any("largest tension" in said for said in watched(swung(30.0)).warnings)
    assert not any("largest tension" in said for said in watched(swung(6.0, 1e-6)).warnings)  # mN of a line of 196 N
    (said,) = [said for said in watched(swung(6.0)).warnings if "largest tension" in said]
    assert "write a smaller run.every" in said


def test_support_forces_at_rest_carry_the_weights() -> None:
    plan = replace(wave.layout(), path="load_path", weight=200.0)

    def carries(up: float) -> Change:
        reaction, load = np.array([[0.0, up / 2], [0.0, up / 2]]), np.array([[0.0, -800.0]])
        return lambda i, frame: replace(frame, reaction=reaction, contact_force=load)

    slow = wave.scenario().model_copy(update={"run": wave.scenario().run})
    assert watched(carries(1000.5), plan, slow).outcome == "completed"
    found = doubt(watched(carries(1010.0), plan, slow))
    assert "10 N" in found.what


@pytest.mark.parametrize(
    ("values", "found"),
    [
        ([1, 1, 1, 1, 99, 1, 1, 1, 1], 4),
        ([1, 1, 1, 99, 99, 1, 1, 1, 1], None),  # two are no single one
        ([99, 1, 1, 1, 1, 1, 1, 1, 1], None),  # where it comes onto its line
        ([1, 1, 1, 1, 9, 1, 1, 1, 1], None),  # high, not more
        ([0, 0, 0, 0, 99, 0, 0, 0, 0], None),  # mostly nothing: a blow is all there is
        ([1, np.nan, 1, 1, 1, 99, 1, 1, 1, np.nan, 1], 5),
        ([1, 99, 1], None),
    ],
)
def test_a_peak_is_lonely_if_its_neighbours_and_the_usual_value_are_small(
    values: Sequence[float], found: int | None
) -> None:
    assert lonely(np.array(values, dtype=float)) == found


def test_impulses_of_entering_and_leaving_are_found_at_the_ends_only() -> None:
    nan = np.nan
    first, last = impulses(np.array([nan, nan, 99, 1, 1, 2, 1, 1, 1, 50, nan]))
    assert (first.tolist(), last.tolist()) == ([2], [9])
    first, last = impulses(np.array([99, 1, 1, 2, 1, 1, 1, 50.0]))  # there from the first sample to the last
    assert (first.tolist(), last.tolist()) == ([], [])


def _entering() -> Summary:
    def change(i: int, frame: Frame) -> Frame:
        nowhere = np.full_like(frame.contact_force, np.nan)
        if i < 20:
            return replace(frame, contact_state=np.full(1, OFF_LINE), contact_force=nowhere)
        return replace(frame, contact_force=frame.contact_force * (1000.0 if i == 20 else 1.0))

    plan, run_info = wave.layout(), wave.run_info()
    with Recorder(plan, wave.scenario(), run_info) as recorder:
        for i, frame in enumerate(wave.frames(plan, TIMES)):
            recorder.append(change(i, frame))
    assert run_info.outcome == "completed"
    return summary(recorder.close())


def test_the_impulse_of_entering_is_told_and_not_counted() -> None:
    found = _entering()
    walker = found["contacts"]["walker"]
    assert walker["impulses"]["entering"]["value"] > 5e5
    assert walker["impulses"]["entering"]["time"] == pytest.approx(TIMES[20])
    assert walker["impulses"]["leaving"] is None
    assert walker["force"]["magnitude"]["max"] < 2e3
    assert "impact when entering" in text(found)


def test_doubts_stand_in_the_first_lines_of_the_summary() -> None:
    plan, run_info = wave.layout(), wave.run_info()
    with Recorder(plan, wave.scenario(), run_info) as recorder:
        for i, frame in enumerate(wave.frames(plan, TIMES)):
            recorder.append(missing(0.2)(i, frame))
    result = recorder.close()
    assert result.attrs["outcome"] == "doubtful"
    message = text(summary(result)).splitlines()
    assert "doubtful" in message[0]
    assert message[1].startswith("doubt: ")
    assert "half the sum of all changes" in "\n".join(message)


STRING = {"start": [0, 0], "end": [10, 0], "tension": 1000.0, "mass": 0.1, "axial_stiffness": 1e5, "elements": 20}


def _runs(load: dict[str, object], **more: object) -> RunInfo:
    tree = {
        "lines": {"string": STRING}, "loads": {"load": {"on": "string", **load}},
        "run": {"kind": "dynamic", "until": 0.05, "every": 0.005, **more},
    }  # fmt: skip
    result = simulate(Scenario.model_validate(tree))
    return RunInfo(result.attrs["outcome"], warnings=result.attrs["warnings"].splitlines())


def test_a_load_that_is_set_down_at_once_is_remarked() -> None:
    load = {"kind": "mass", "mass": 1.0, "travel": {"speed": 10.0, "from": 5.0}}
    run_info = _runs(load)
    assert run_info.outcome == "completed"
    assert any("set down suddenly" in remark for remark in run_info.warnings)
    for other in (_runs(load, start={"with_loads": True}), _runs({**load, "travel": {"speed": 10.0}})):
        assert not any("set down suddenly" in remark for remark in other.warnings)


def test_a_payload_that_falls_into_its_slack_rope_is_not_remarked() -> None:
    """What swings from it is what was asked for; hanging on a taut one it is set down as others are."""
    payload = {"mass": 1.0, "length": 1.5}
    load = {"kind": "trolley", "mass": 0.1, "travel": {"speed": 1.0, "from": 5.0}}
    assert not _runs({**load, "payload": {**payload, "at": [0.3, 0.0]}}).warnings
    assert any("set down suddenly" in remark for remark in _runs({**load, "payload": payload}).warnings)


def test_a_mass_without_gravity_is_doubtful() -> None:
    load = {"kind": "mass", "mass": 1.0, "on": "string", "travel": {"speed": 10.0, "from": 5.0}}
    tree = {
        "gravity": 0.0,
        "lines": {"string": STRING},
        "loads": {"load": load},
        "run": {"kind": "dynamic", "until": 0.05},
    }
    result = simulate(Scenario.model_validate(tree))
    assert result.attrs["outcome"] == "doubtful"
    assert "(gravity)" in result.attrs["doubts"]


def test_a_run_does_not_write_into_the_result_that_it_starts_from(tmp_path: Path) -> None:
    tree = {"lines": {"string": STRING}, "run": {"kind": "dynamic", "until": 0.05}}
    file = tmp_path / "first.nc"
    simulate(Scenario.model_validate(tree), file=file)
    before = file.read_bytes()
    again = tree | {"run": {"kind": "dynamic", "until": 0.05, "start": {"kind": "result", "file": str(file)}}}
    with pytest.raises(ScenarioError, match=r"run\.start\.file: is also the output file"):
        simulate(Scenario.model_validate(again), file=file)
    assert file.read_bytes() == before
    simulate(Scenario.model_validate(again), file=tmp_path / "second.nc")


def test_a_start_that_cannot_be_read_leaves_the_earlier_result_alone(tmp_path: Path) -> None:
    tree = {"lines": {"string": STRING}, "run": {"kind": "dynamic", "until": 0.05}}
    file = tmp_path / "out.nc"
    simulate(Scenario.model_validate(tree), file=file)
    before = file.read_bytes()
    again = tree | {"run": {"kind": "dynamic", "until": 0.05, "start": {"kind": "result", "file": "none.nc"}}}
    with pytest.raises(RopewalkError):
        simulate(Scenario.model_validate(again), file=file)
    assert file.read_bytes() == before


def leaving(law: str) -> xr.Dataset:
    """A bead that runs down a slack rope without damping, up to its end and off it."""
    line = {
        "start": [0.0, 0.0], "end": [19.0, 0.0], "length": 20.0, "mass": 1.0, "axial_stiffness": 1e6, "elements": 100,
        "law": {"kind": law},
    }  # fmt: skip
    travel = {"kind": "free", "from": 19.52, "speed": 3.0, "at_end": "leave"}
    bead = {"kind": "mass", "on": "rope", "mass": 5.0, "travel": travel}
    run = {"kind": "dynamic", "until": 0.2, "every": 0.01}
    return simulate(Scenario.model_validate({"lines": {"rope": line}, "loads": {"bead": bead}, "run": run}))


def test_a_line_that_springs_up_when_a_load_leaves_is_doubtful() -> None:
    """The last link turned back on itself: made whole again, it is pushed together by a force that nothing gave."""
    found = leaving("hooke")
    assert found.attrs["outcome"] == "doubtful"
    assert "springs up" in found.attrs["doubts"]
    assert "travel.margin" in found.attrs["doubts"]
    # what cannot be pushed does not spring
    assert "springs up" not in leaving("tension_only").attrs["doubts"]


def test_a_load_that_is_set_down_on_a_stiff_line_is_not_told_to_begin_at_rest_with_it() -> None:
    """Runs of stiff lines refuse that key."""
    load = {"kind": "mass", "mass": 1.0, "on": "string", "travel": {"speed": 10.0, "from": 5.0}}
    tree = {
        "lines": {"string": STRING | {"bending_stiffness": 1.0}}, "loads": {"load": load},
        "run": {"kind": "dynamic", "until": 0.05, "every": 0.005},
    }  # fmt: skip
    message = simulate(Scenario.model_validate(tree)).attrs["warnings"]
    assert "set down suddenly" in message
    assert "with_loads" not in message


WIND = {"speed": 5.0, "direction": [1.0, 0.0]}
HALF = {"tension": 1000.0, "mass": 1.0, "axial_stiffness": 1e5, "elements": 10, "wind_drag": 0.02}
JOINED = {"kind": "joined", "to": "middle"}
NET = {
    "one": {**HALF, "start": [0, 0], "end": [5, 0], "end_support": JOINED},
    "two": {**HALF, "start": [5, 0], "end": [10, 0], "start_support": JOINED},
}
OVER = {
    "rope": {
        "start": [0, 0], "end": [20, 0], "length": 20.5, "mass": 1.0, "axial_stiffness": 1e6, "elements": 41,
        "wind_drag": 0.02, "sheaves": {"tower": {"at": [10, 1]}},
    }
}  # fmt: skip


@pytest.mark.parametrize("kind", ["equilibrium", "dynamic"])
@pytest.mark.parametrize("tree", [
    {"lines": NET, "joints": {"middle": {"mass": 0.1}}, "wind": WIND}, {"lines": OVER}, {"lines": OVER, "wind": WIND},
])  # fmt: skip
def test_wind_joints_and_sheaves_raise_no_doubt_about_what_supports_carry(
    tree: dict[str, dict[str, object]], kind: str
) -> None:
    air = {} if "wind" in tree else {"wind": {"speed": 0.0, "direction": [1.0, 0.0]}}
    run = {"kind": kind} | ({"until": 0.1} if kind == "dynamic" else {})
    result = simulate(Scenario.model_validate(tree | air | {"run": run}))
    assert (result.attrs["outcome"], result.attrs["doubts"]) == ("completed", "")
