"""An FMU in a process of its own: the same answers, and an error where it crashes or hangs."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("fmpy", reason="FMUs need FMPy")

from external.fmus import StillLine, c_fmu, python_fmu
from ropewalk.errors import RopewalkError
from ropewalk.external.fmu import FmuModel
from ropewalk.model.fmu import Fmu

H = 0.01  # s
MESSAGE = {"force": "force", "height": "height", "velocity": "velocity"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fmus")


@pytest.fixture
def models() -> Iterator[list[FmuModel]]:
    made: list[FmuModel] = []
    yield made
    for model in made:
        model.close()


def model_of(file: Path, **keys: Any) -> FmuModel:
    keys = {"isolated": True, **keys}
    load = Fmu(on="rope", file=str(file), contacts={"front": MESSAGE}, travel={"speed": 1.0}, every=H, **keys)
    return FmuModel("car", load, 1.0, 2)


def ride(model: FmuModel, steps: int) -> list[float]:
    line = StillLine(lambda t: 0.1 * t)
    model.reset(line)
    forces = [model.step(0.0, H, line)[0].force[-1]]
    for n in range(1, steps + 1):
        line.t = n * H
        forces.append(model.step(n * H, H, line)[0].force[-1])
    return forces


def process_of(model: FmuModel) -> subprocess.Popen[bytes]:
    worker: Any = model._worker
    return worker._watched.process  # type: ignore[no-any-return]


def is_alive(number: int) -> bool:
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    return True


def test_an_isolated_fmu_answers_the_same(folder: Path, models: list[FmuModel]) -> None:
    models += [model_of(c_fmu(folder), isolated=wanted) for wanted in (True, False)]
    assert ride(models[0], 20) == ride(models[1], 20)
    process = process_of(models[0])
    assert process.pid != os.getpid()
    assert process.poll() is None
    models[0].close()
    assert process.poll() == 0
    models[0].close()


def test_it_goes_back_to_states_and_forgets_them(folder: Path, models: list[FmuModel]) -> None:
    model = model_of(c_fmu(folder, 2, 'canGetAndSetFMUstate="true"'), exchange={"scheme": "iterated"})
    models.append(model)
    ride(model, 2)
    assert model.get_state is not None
    assert model.set_state is not None
    line, found = StillLine(lambda t: 0.1 * t), []
    state = model.get_state()
    for _ in range(2):
        model.set_state(state)
        line.t = 3 * H
        found.append(model.step(3 * H, H, line)[0].force[-1])
    assert found[0] == found[1]
    worker: Any = model._worker
    del state
    assert worker._forgotten == [1]
    model.get_state()  # nobody holds it: forgotten with the next question, as the first is with this one
    assert worker._forgotten == [2]
    for number in (1, 2):
        with pytest.raises(RopewalkError, match="has no state"):
            worker.restore(number)


CRASHES = [
    (
        "c",
        {"mood": "segfault", "at": 0.02},
        r"has crashed.*SIGSEGV, in the step from t = 0\.02 s.*its log: here it comes",
    ),
    ("c", {"mood": "quit", "at": 0.02}, r"has ended its process, with exit code 0, in the step from t = 0\.02 s"),
    ("python", {"mood": "abort"}, r"has crashed.*SIGABRT, in the step from t = 0 s to 0\.01 s"),
    ("python", {"mood": "exit"}, "has ended its process, with exit code 7, in the step"),
]


@pytest.mark.parametrize(("kind", "parameters", "said"), CRASHES)
def test_a_crash_is_an_error(
    folder: Path, tmp_path: Path, kind: str, parameters: dict[str, Any], said: str, models: list[FmuModel]
) -> None:
    file = c_fmu(folder) if kind == "c" else python_fmu(tmp_path)
    models.append(model_of(file, parameters=parameters))
    with pytest.raises(RopewalkError, match=f"load car: its FMU vehicle.*{said}"):
        ride(models[0], 5)
    worker: Any = models[0]._worker
    assert not Path(worker._watched.folder).exists()
    with pytest.raises(RopewalkError, match=said.split(",")[0]):  # and remains one
        models[0].step(6 * H, H, StillLine())


@pytest.mark.parametrize(("kind", "mood"), [("c", "hang"), ("python", "hang"), ("python", "loop")])
def test_an_fmu_that_hangs_is_given_up(
    folder: Path, tmp_path: Path, kind: str, mood: str, models: list[FmuModel]
) -> None:
    file = c_fmu(folder) if kind == "c" else python_fmu(tmp_path)
    models.append(model_of(file, parameters={"mood": mood}, patience=0.5))
    begin = time.monotonic()
    with pytest.raises(
        RopewalkError, match=r"has not answered for 0\.5 s on the clock .*was given up, in the step from t"
    ):
        ride(models[0], 1)
    assert time.monotonic() - begin < 200.0  # the FMU would sleep for 1000 s; a start may take long


def test_a_refusal_is_the_same_error_as_without(folder: Path, models: list[FmuModel]) -> None:
    said = []
    for wanted in (True, False):
        models.append(model_of(c_fmu(folder), parameters={"mood": "error", "at": 0.02}, isolated=wanted))
        with pytest.raises(RopewalkError) as caught:
            ride(models[-1], 5)
        said.append(str(caught.value))
    assert said[0] == said[1]
    process = process_of(models[0])
    models[0].close()
    assert process.poll() == 0


def test_what_an_fmu_prints_does_no_harm(tmp_path: Path, models: list[FmuModel]) -> None:
    models.append(model_of(python_fmu(tmp_path), parameters={"mood": "print"}))
    assert len(ride(models[0], 3)) == 4


def test_a_process_that_is_killed_from_outside_is_an_error(folder: Path, models: list[FmuModel]) -> None:
    models.append(model_of(c_fmu(folder)))
    ride(models[0], 1)
    process_of(models[0]).send_signal(signal.SIGKILL)
    process_of(models[0]).wait()
    with pytest.raises(RopewalkError, match="has crashed, its process was ended by SIGKILL"):
        models[0].step(2 * H, H, StillLine())


def test_an_fmu_that_cannot_be_loaded_ends_its_process(folder: Path) -> None:
    model = model_of(c_fmu(folder, 2, "", lambda text: text.replace('"right"', '"wrong"')))
    with pytest.raises(RopewalkError, match="cannot be loaded"):
        model.reset(StillLine())
    assert model._worker is None


PARENT = """
import os, sys
sys.path[:0] = sys.argv[2:]
from external.test_isolation import StillLine, model_of, process_of, ride
model = model_of(sys.argv[1], parameters={"mood": "hang", "at": 0.02}, patience=1000.0)
ride(model, 1)
print(process_of(model).pid, model._worker._watched.folder, flush=True)
for n in range(2, 5):
    model.step(n * 0.01, 0.01, StillLine())
"""


@pytest.mark.skipif(sys.platform == "win32", reason="there a child cannot see that its parent is gone")
def test_the_fmu_ends_with_its_parent_even_while_it_hangs(folder: Path) -> None:
    file = c_fmu(folder)
    command = [sys.executable, "-c", PARENT, str(file), str(Path(__file__).parents[1])]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        number, folder_of_child = parent.stdout.readline().split()
        child = int(number)
        time.sleep(0.5)  # until it hangs
        assert is_alive(child)
        parent.kill()
        parent.wait()
    patience = time.monotonic() + 200.0  # it looks five times a second; the FMU would sleep for 1000 s
    while is_alive(child) and time.monotonic() < patience:
        time.sleep(0.05)
    assert not is_alive(child)
    assert not Path(folder_of_child).exists()
