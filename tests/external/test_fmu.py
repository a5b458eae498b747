"""An FMU on a line: what it is told, what it answers, and how it ends."""

from __future__ import annotations

import gc
import resource
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("fmpy", reason="FMUs need FMPy")

from external.fmus import StillLine, c_fmu, python_fmu
from ropewalk.errors import RopewalkError
from ropewalk.external.cosimulation_master import CosimulationMaster
from ropewalk.external.fmu import FmuModel
from ropewalk.model.fmu import Fmu

H = 0.01  # s, interval of all tests
EXPECTED = {"force": "force", "height": "height", "velocity": "velocity", "place": "place"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fmus")


@pytest.fixture(params=[2, 3], ids=["FMI 2.0", "FMI 3.0"])
def version(request: pytest.FixtureRequest) -> int:
    return int(request.param)


@pytest.fixture
def models() -> Iterator[list[FmuModel]]:
    made: list[FmuModel] = []
    yield made
    for model in made:
        model.close()


def fmu(file: Path, contact: dict[str, Any] | None = None, travel: dict[str, Any] | None = None, **keys: Any) -> Fmu:
    contacts = keys.pop("contacts", {"front": contact or EXPECTED})
    return Fmu(
        on="rope", file=str(file), contacts=contacts, travel=travel or {"speed": 1.0, "from": 1.0}, every=H, **keys
    )


def ride(model: FmuModel, line: StillLine, steps: int) -> list[list[Any]]:
    """Answers at 0, H, 2 H ..."""
    line.t = 0.0
    model.reset(line)
    answers = [model.step(0.0, H, line)]
    for n in range(1, steps + 1):
        line.t = n * H
        answers.append(model.step(n * H, H, line))
    return answers


def seen(model: FmuModel, line: StillLine, steps: int) -> np.ndarray:
    """What the FMU was told, (step, input)."""
    line.t = 0.0
    model.reset(line)
    model.step(0.0, H, line)
    rows = [list(model._inputs)]
    for n in range(1, steps + 1):
        line.t = n * H
        model.step(n * H, H, line)
        rows.append(list(model._inputs))
    return np.array(rows)


def test_the_mass_of_an_fmu_rings_on_a_line_that_is_lifted(folder: Path, version: int, models: list[FmuModel]) -> None:
    line = StillLine(lambda t: 0.02 if t > 0.0 else 0.0)
    models.append(FmuModel("car", fmu(c_fmu(folder, version)), 1.0, 2))
    answers = ride(models[0], line, 63)  # about one period of sqrt(k / m) = 10/s
    force = np.array([touch.force[-1] for (touch,) in answers])
    t = H * np.arange(force.size)
    expected = -(98.1 + 1000.0 * 0.02 * np.cos(10.0 * t))
    expected[0] = -98.1
    # The FMU integrates with steps of 0.5 ms at first order: 0.5 % of the amplitude of 20 N in this period.
    assert force == pytest.approx(expected, abs=0.1)
    assert [touch.xi for (touch,) in answers] == pytest.approx(1.0 + t, abs=1e-12)
    assert {touch.speed for (touch,) in answers} == {1.0}


def test_an_fmu_is_told_height_and_velocity_of_its_moving_contact(folder: Path, models: list[FmuModel]) -> None:
    line = StillLine(lambda t: 3.0 * t**2)
    line.slope = 0.1
    contact = {**EXPECTED, "motion_factor": -2.0}
    models.append(FmuModel("car", fmu(c_fmu(folder), contact), 1.0, 2))
    expected = seen(models[0], line, 5)
    t = H * np.arange(6)
    # Rounding; and the second-order difference is exact for a parabola, but the first step only knows two heights.
    assert expected[:, 0] == pytest.approx((3.0 * t**2 + 0.1 * t) / -2.0, abs=1e-12)
    assert expected[2:, 1] == pytest.approx((6.0 * t[2:] + 0.1) / -2.0, abs=1e-9)
    assert expected[1, 1] == pytest.approx((3.0 * H + 0.1) / -2.0, abs=1e-9)
    assert expected[0, 1] == pytest.approx(0.1 / -2.0, abs=1e-9)
    assert expected[:, 2] == pytest.approx(1.0 + t, abs=1e-12)


def test_the_velocity_told_is_of_second_order(folder: Path, models: list[FmuModel]) -> None:
    errors = []
    for n in (20, 40, 80):
        h = 1.0 / n
        line = StillLine(lambda t: float(np.sin(3.0 * t)))
        model = FmuModel("car", fmu(c_fmu(folder), travel={"speed": 0.0, "from": 1.0}), 1.0, 2)
        models.append(model)
        model.reset(line)
        model.step(0.0, h, line)
        for i in range(1, n + 1):
            line.t = i * h
            model.step(i * h, h, line)
        errors.append(abs(model._inputs[1] - 3.0 * np.cos(3.0)))
    orders = [float(np.log2(a / b)) for a, b in pairwise(errors)]
    print("orders", orders)
    assert orders == pytest.approx([2.0, 2.0], abs=0.15)  # the next term of the series is a tenth of this one here


def test_heights_count_from_zero_where_that_is_asked(folder: Path, models: list[FmuModel]) -> None:
    line = StillLine(lambda t: 5.0)
    models.append(FmuModel("car", fmu(c_fmu(folder), {**EXPECTED, "height_from": "zero"}), 1.0, 2))
    models.append(FmuModel("car", fmu(c_fmu(folder), EXPECTED), 1.0, 2))
    assert seen(models[0], line, 1)[:, 0] == pytest.approx([5.0, 5.0], abs=1e-12)
    assert seen(models[1], line, 1)[:, 0] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_inputs_that_can_be_interpolated_rise_linearly_within_a_step(folder: Path, models: list[FmuModel]) -> None:
    line = StillLine(lambda t: t)
    contact = {"force": "seen", "height": "height"}
    restrained = FmuModel("car", fmu(c_fmu(folder), contact), 1.0, 2)
    ramp = FmuModel("car", fmu(c_fmu(folder, 2, 'canInterpolateInputs="true"'), contact), 1.0, 2)
    models += [restrained, ramp]
    # `seen` is the mean of the height in the last step; exact up to rounding.
    assert -ride(restrained, line, 3)[3][0].force[-1] == pytest.approx(3.0 * H, abs=1e-12)
    assert -ride(ramp, line, 3)[3][0].force[-1] == pytest.approx(2.5 * H, abs=1e-12)


def test_a_contact_off_the_line_stays_as_high_as_its_end(folder: Path, models: list[FmuModel]) -> None:
    line = StillLine(length=1.0)
    line.slope = 1.0
    load = fmu(c_fmu(folder), travel={"speed": 100.0, "from": 0.0}, contacts={"rear": {**EXPECTED, "at": -0.5}})
    models.append(FmuModel("car", load, 1.0, 2))
    answers = ride(models[0], line, 3)
    assert [touch.xi for (touch,) in answers] == pytest.approx([-0.5, 0.5, 1.5, 2.5], abs=1e-12)
    expected = seen(models[0], line, 3)
    assert expected[:, 0] == pytest.approx([0.0, 0.5, 0.5, 0.5], abs=1e-12)  # it was never seen at the far end itself
    assert expected[0, 1] == expected[2, 1] == expected[3, 1] == 0.0


def test_a_horizontal_advance_is_measured_across_the_line(folder: Path, models: list[FmuModel]) -> None:
    line = StillLine(length=10.0)
    line.stretch = -0.5  # it leads backwards, half as long as its material
    travel = {"speed": 2.0, "measured": "horizontal", "from": 4.9}
    models.append(FmuModel("car", fmu(c_fmu(folder), EXPECTED, travel), 1.0, 2))
    answers = ride(models[0], line, 6)
    assert [touch.xi for (touch,) in answers[:6]] == pytest.approx(9.8 + 0.04 * np.arange(6), abs=1e-9)
    assert [touch.speed for (touch,) in answers[:6]] == pytest.approx([4.0] * 6, abs=1e-9)
    assert answers[6][0].xi == pytest.approx(10.02, abs=1e-9)  # beyond the end, as far as it is in the air


def test_a_table_of_speeds_is_integrated(folder: Path, models: list[FmuModel]) -> None:
    travel = {"speed": {"time": [0.0, 0.02, 0.02, 0.04], "value": [0.0, 2.0, 1.0, 1.0]}, "from": 1.0}
    models.append(FmuModel("car", fmu(c_fmu(folder), EXPECTED, travel), 1.0, 2))
    answers = ride(models[0], StillLine(), 5)
    expected = [1.0, 1.005, 1.02, 1.03, 1.04, 1.05]  # half a t^2, then 1 m/s
    assert [touch.xi for (touch,) in answers] == pytest.approx(expected, abs=1e-12)
    assert [touch.speed for (touch,) in answers] == pytest.approx([0.0, 1.0, 1.0, 1.0, 1.0, 1.0], abs=1e-12)


def test_an_fmu_may_answer_with_its_motion(folder: Path, version: int, models: list[FmuModel]) -> None:
    contact = {
        "gives": "motion", "force": "push", "height": "height_out", "velocity": "w",
        "force_factor": -1.0, "motion_factor": -1.0,
    }  # fmt: skip
    load = fmu(c_fmu(folder, version), contact, parameters={"stiffness": 0.0}, exchange={"stiffness": 1e5})
    line = StillLine(lambda t: 7.0)
    line.forces[0] = (0.0, -20.0)  # N on the line, 20 N in compression: 2 m/s^2 of the mass of 10 kg
    models.append(FmuModel("car", load, 1.0, 2))
    answers = ride(models[0], line, 10)
    touch = answers[10][0]
    assert touch.motion is not None
    # z = a t^2 / 2 at t = 0.1 s, upwards where the variable counts downwards; the FMU's method errs by a t d / 2 = 5e-5
    # m, and by a d / 2 = 5e-4 m/s in the differences of its heights.
    assert touch.motion == pytest.approx((7.0 - 0.01, -0.2), abs=6e-5)
    assert list(touch.force) == [0.0, 0.0]
    del contact["velocity"]
    load = fmu(c_fmu(folder, version), contact, parameters={"stiffness": 0.0}, exchange={"stiffness": 1e5})
    models.append(FmuModel("car", load, 1.0, 2))
    assert ride(models[1], line, 10)[10][0].motion == pytest.approx((7.0 - 0.01, -0.2), abs=6e-4)


def test_two_contacts_have_variables_of_their_own(folder: Path, models: list[FmuModel]) -> None:
    contacts = {
        "rear": {"at": -0.5, "force": "seen", "place": "place"},
        "front": {"at": 0.5, "force": "force", "force_along": "clock", "height": "height", "force_factor": 1.0},
    }
    models.append(FmuModel("car", fmu(c_fmu(folder), contacts=contacts), 1.0, 3))
    rear, front = ride(models[0], StillLine(), 2)[2]
    assert (rear.xi, front.xi) == pytest.approx((0.52, 1.52), abs=1e-12)
    assert list(rear.force) == [0.0, 0.0, 0.0]
    assert list(front.force) == pytest.approx([2.0 * H, 0.0, 98.1], abs=1e-12)
    assert models[0].contacts == 2


def test_parameters_of_every_type_are_set(folder: Path, version: int, models: list[FmuModel]) -> None:
    parameters = {"mass": 20, "eager": True, "label": "good morning", "mood": "shout"}
    models.append(FmuModel("car", fmu(c_fmu(folder, version), parameters=parameters), 1.0, 2))
    (touch,) = ride(models[0], StillLine(), 0)[0]
    assert touch.force[-1] == pytest.approx(-2.0 * 20.0 * 9.81, abs=1e-9)
    worker: Any = models[0]._worker
    assert any("good morning" in message for _, message in worker._log)


def test_start_values_move_the_mass(folder: Path, version: int, models: list[FmuModel]) -> None:
    models.append(FmuModel("car", fmu(c_fmu(folder, version), start_values={"z": 0.01, "push": 5.0}), 1.0, 2))
    answers = ride(models[0], StillLine(), 1)
    assert answers[0][0].force[-1] == pytest.approx(-98.1 + 10.0, abs=1e-9)


MISHAPS = [
    ("discard", "refuses the step from t = 0.02 s to 0.03 s .*DoStep: discard"),
    ("error", "refuses the step from t = 0.02 s.*error.*its log: the spring is broken"),
    ("fatal", "refuses the step from t = 0.02 s.*fatal"),
    ("nan", "gives no number for force at t = 0.03 s"),
    ("refuse_to_begin", "cannot be initialised.*EnterInitializationMode: error.*I had rather not begin"),
]


@pytest.mark.parametrize(("mood", "said"), MISHAPS)
def test_an_fmu_that_fails_says_when_and_why(
    folder: Path, version: int, mood: str, said: str, models: list[FmuModel]
) -> None:
    models.append(FmuModel("car", fmu(c_fmu(folder, version), parameters={"mood": mood, "at": 0.02}), 1.0, 2))
    with pytest.raises(RopewalkError, match=f"load car: its FMU vehicle.*fmu {said}"):
        ride(models[0], StillLine(), 5)


def test_an_fmu_may_ask_for_the_end(folder: Path, models: list[FmuModel]) -> None:
    models.append(FmuModel("car", fmu(c_fmu(folder, 3), parameters={"mood": "end", "at": 0.02}), 1.0, 2))
    with pytest.raises(RopewalkError, match="requests the end of the simulation"):
        ride(models[0], StillLine(), 5)


def test_an_fmu_that_cannot_be_instantiated_says_that_it_needs_its_tool(folder: Path, version: int) -> None:
    file = c_fmu(folder, version, 'needsExecutionTool="true"', lambda text: text.replace('"right"', '"wrong"'))
    model = FmuModel("car", fmu(file), 1.0, 2)
    with pytest.raises(RopewalkError, match=r"cannot be loaded.*requires the program that exported it"):
        model.reset(StillLine())


def test_a_library_without_the_functions_of_fmi_is_refused(folder: Path) -> None:
    import zipfile

    from fmpy import platform, sharedLibraryExtension

    good = c_fmu(folder)
    bad = folder / "nonsense.fmu"
    with zipfile.ZipFile(good) as source, zipfile.ZipFile(bad, "w") as target:
        target.writestr("modelDescription.xml", source.read("modelDescription.xml"))
        target.writestr(f"binaries/{platform}/vehicle{sharedLibraryExtension}", b"no library")
    here = Path.cwd()
    with pytest.raises(RopewalkError, match=r"nonsense\.fmu cannot be loaded"):
        FmuModel("car", fmu(bad), 1.0, 2).reset(StillLine())
    assert Path.cwd() == here


def test_an_fmu_goes_back_to_a_state(folder: Path, version: int, models: list[FmuModel]) -> None:
    which = "canGetAndSetFMUstate" if version == 2 else "canGetAndSetFMUState"
    file = c_fmu(folder, version, f'{which}="true" canInterpolateInputs="true"')
    load = fmu(file, exchange={"scheme": "iterated"})
    model = FmuModel("car", load, 1.0, 2)
    models.append(model)
    line = StillLine(lambda t: 3.0 * t**2)
    ride(model, line, 3)
    assert model.get_state is not None
    assert model.set_state is not None
    state = model.get_state()
    answers = []
    for lift in (1.0, 0.0, 1.0):
        model.set_state(state)
        line.height = lambda t, lift=lift: 3.0 * t**2 * lift  # type: ignore[misc]
        line.t = 4 * H
        answers.append(model.step(4 * H, H, line)[0].force[-1])
    straight = FmuModel("car", fmu(file), 1.0, 2)
    models.append(straight)
    line.height = lambda t: 3.0 * t**2
    assert answers[0] == answers[2] == ride(straight, line, 4)[4][0].force[-1]
    assert answers[1] != answers[0]


def test_states_are_freed(folder: Path, version: int, models: list[FmuModel]) -> None:
    which = "canGetAndSetFMUstate" if version == 2 else "canGetAndSetFMUState"
    model = FmuModel("car", fmu(c_fmu(folder, version, f'{which}="true"')), 1.0, 2)
    models.append(model)
    ride(model, StillLine(), 1)
    assert model.get_state is not None
    gc.collect()
    for _ in range(1000):
        model.get_state()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(50_000):
        state = model.get_state()
    assert model._worker._states.keys() == {state.number}  # type: ignore[union-attr]
    # 50 000 states of 250 bytes and their handles would be 25 MB; ru_maxrss is in kB (on macOS in bytes).
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 4000 * (
        1024 if sys.platform == "darwin" else 1
    )


def test_an_fmu_that_cannot_go_back_has_no_state(folder: Path) -> None:
    model = FmuModel("car", fmu(c_fmu(folder)), 1.0, 2)
    assert not callable(getattr(model, "get_state", None))
    cosimulation = CosimulationMaster(
        "car", model, H, model._load.exchange.model_copy(update={"scheme": "iterated"}), "leave", 1, 2, 0.1
    )
    with pytest.raises(RopewalkError, match="its model has no get_state"):
        cosimulation.begin(StillLine())


def test_it_can_be_reset_and_let_go_again_and_again(folder: Path, version: int) -> None:
    model = FmuModel("car", fmu(c_fmu(folder, version)), 1.0, 2)
    line = StillLine(lambda t: 0.1 * t)
    first = ride(model, line, 3)[3][0].force[-1]
    worker: Any = model._worker
    place = worker._resources.parent
    assert place.is_dir()
    assert ride(model, line, 3)[3][0].force[-1] == first
    model.close()
    model.close()
    assert not place.exists()
    with pytest.raises(RopewalkError, match="has been released"):
        model.step(H, H, line)


# -- FMUs of Python -------------------------------------------------------------------------------------------------

PYTHON_EXPECTED = {"force": "force", "height": "height", "velocity": "velocity"}


def test_fmus_of_python_with_modules_of_one_name_are_each_their_own(tmp_path: Path, models: list[FmuModel]) -> None:
    path, modules = list(sys.path), set(sys.modules)
    one = FmuModel("one", fmu(python_fmu(tmp_path / "a"), PYTHON_EXPECTED), 1.0, 2)
    two = FmuModel("two", fmu(python_fmu(tmp_path / "b", factor=2.0), PYTHON_EXPECTED), 1.0, 2)
    models += [one, two]
    for model in models:
        model.reset(StillLine())
    for t in (H, 2.0 * H):  # in turns
        assert one.step(t, H, StillLine())[0].force[-1] == pytest.approx(-98.1, abs=1e-9)
        assert two.step(t, H, StillLine())[0].force[-1] == pytest.approx(-196.2, abs=1e-9)
    one.close()
    assert two.step(3.0 * H, H, StillLine())[0].force[-1] == pytest.approx(-196.2, abs=1e-9)
    for _ in range(3):
        one.reset(StillLine())
        assert one.step(H, H, StillLine())[0].force[-1] == pytest.approx(-98.1, abs=1e-9)
        one.close()
    two.close()
    assert sys.path == path
    assert "vehicle" not in set(sys.modules) - modules


@pytest.mark.parametrize(
    ("mood", "said"),
    [
        ("raise", "refuses the step from t = 0 s to 0.01 s.*its log: Fatal py exception"),
        ("refuse", "refuses the step from t = 0 s.*discard.*not today"),
        ("nan", "gives no number for force"),
    ],
)
def test_an_fmu_of_python_that_fails_says_so(tmp_path: Path, mood: str, said: str, models: list[FmuModel]) -> None:
    models.append(FmuModel("car", fmu(python_fmu(tmp_path), PYTHON_EXPECTED, parameters={"mood": mood}), 1.0, 2))
    with pytest.raises(RopewalkError, match=said) as caught:
        ride(models[0], StillLine(), 2)
    print(caught.value)
