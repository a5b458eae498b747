"""Co-simulation: what an exchange costs beside the model's own step."""

from __future__ import annotations

import importlib.util
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

from ropewalk.external.fmu import FmuModel
from ropewalk.model import Dynamic, Fmu, Line, MovingForce, Scenario, Stepper
from ropewalk.simulate import simulate

STEPS, TIMES = 10_000, 5
SPEED, EVERY = 2.0, 1e-4  # m/s, s


def seconds(act: Callable[[], Any]) -> float:
    """Median processor time of an action, after one for warming up."""
    act()
    taken = []
    for _ in range(TIMES):
        begin = time.process_time()
        act()
        taken.append(time.process_time() - begin)
    return median(taken)


def built(folder: Path) -> Path:
    """The FMU of C that the tests build: a mass on a spring above its contact."""
    place = Path(__file__).parents[1] / "tests" / "external" / "fmus.py"
    spec = importlib.util.spec_from_file_location("fmus", place)
    assert spec is not None
    assert spec.loader is not None
    fmus = importlib.util.module_from_spec(spec)
    sys.modules["fmus"] = fmus
    spec.loader.exec_module(fmus)
    found: Path = fmus.c_fmu(folder)
    return found


def bare(file: Path) -> float:
    """Seconds of a step of the FMU through FMPy alone: two inputs, a step, an output."""
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    description = fmpy.read_model_description(str(file))
    folder = fmpy.extract(str(file))
    fmu = FMU2Slave(
        guid=description.guid, unzipDirectory=folder, modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="bare",
    )  # fmt: skip
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    step = [0]

    def go() -> None:
        for _ in range(STEPS):
            fmu.setReal([1, 2], [0.0, 0.0])
            fmu.doStep(step[0] * EVERY, EVERY)
            fmu.getReal([5])
            step[0] += 1

    try:
        return seconds(go) / STEPS
    finally:
        fmu.terminate()
        fmu.freeInstance()


class Still:
    """A line that does not move."""

    length = 20.0

    def at(self, xi: float) -> tuple[list[float], list[float]]:
        return [xi, 0.0], [0.0, 0.0]


class Nobody:
    """The least that a model can do."""

    def step(self, t: float, h: float, line: Any) -> list[Any]:
        return [(5.0 + SPEED * t, (0.0, -300.0), SPEED)]


def vehicle(file: Path, *, isolated: bool = False) -> Fmu:
    """The FMU as a load."""
    contacts = {"w": {"force": "force", "height": "height", "velocity": "velocity"}}
    return Fmu.model_validate(
        {
            "on": "rope",
            "file": str(file),
            "contacts": contacts,
            "travel": {"speed": SPEED, "from": 5.0},
            "parameters": {"mass": 20.0},
            "every": EVERY,
            "isolated": isolated,
        }
    )


def adapter(load: Fmu) -> float:
    """Seconds of a step of the FMU through our adapter, on a line that does not move."""
    model, line, step = FmuModel("a", load, 1e9, 2), Still(), [0]
    model.reset(line)  # type: ignore[arg-type]

    def go() -> None:
        for _ in range(STEPS):
            model.step(step[0] * EVERY, EVERY, line)  # type: ignore[arg-type]
            step[0] += 1

    model.step(0.0, EVERY, line)  # type: ignore[arg-type]
    step[0] = 1
    try:
        return seconds(go) / STEPS
    finally:
        model.close()


def whole(load: Any, *, beam: bool = False) -> float:
    """Seconds of a run of a second with a load on a rope of 50 links, or a beam of 50."""
    line = Line(start=(0, 0), end=(20.0, 0), tension=2e4, mass=1.0, axial_stiffness=1e5, elements=50)
    run = Dynamic(until=1.0, every=0.5, step=EVERY, method="auto" if beam else "verlet")
    if beam:
        line = line.model_copy(update={"bending_stiffness": 1e3})
        run = run.model_copy(update={"geometry": "linearised", "sample": EVERY})
    scenario = Scenario(lines={"rope": line}, loads={"a": load}, run=run)
    return seconds(lambda: simulate(scenario))


def main() -> None:
    """Print all tables."""
    print(f"\nCo-simulation, microseconds of CPU per exchange (medians of {TIMES})")
    force = MovingForce.model_validate({"on": "rope", "force": [0.0, -300.0], "travel": {"speed": SPEED, "from": 5.0}})
    nobody = Stepper.model_validate({"on": "rope", "model": Nobody(), "every": EVERY, "from": 5.0})
    for beam in (False, True):
        alone, asked = whole(force, beam=beam), whole(nobody, beam=beam)
        where = "a beam" if beam else "a rope"
        what = f"an empty model on {where} of 50 links, beyond kind: force"
        print(f"  {what:90}{1e6 * (asked - alone) * EVERY:7.1f}")
    with tempfile.TemporaryDirectory() as folder:
        file = built(Path(folder))
        own, apart = vehicle(file), vehicle(file, isolated=True)
        rows = {
            "an FMU of C through FMPy alone": bare(file),
            "the same through our adapter, with the place and the height of a line that holds still": adapter(own),
            "the same in a process of its own (this side)": adapter(apart),
            "on the rope, all of it, beyond kind: force": (whole(own) - whole(force)) * EVERY,
        }
        for what, cost in rows.items():
            print(f"  {what:90}{1e6 * cost:7.1f}")


if __name__ == "__main__":
    main()
