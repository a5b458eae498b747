"""Export: lines and vehicles of a scenario as FMUs (FMI 2.0, co-simulation)."""

from __future__ import annotations

import importlib.util
import json
import re
import sys
import tempfile
import uuid
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ropewalk.cosim.outside import Outside, Side, Stepwise
from ropewalk.cosim.stepwise import stepwise
from ropewalk.cosim.vehicle import alone
from ropewalk.errors import Problem, RopewalkError, ScenarioError, did_you_mean
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.scenario import dump

Gives = Literal["force", "motion"]
Measure = Literal["material", "horizontal"]

_EVERY = 1e-3  # s, step of a master where none is said
_CONTACT_STIFFNESS = 1e6  # N/m
_NEEDS = "It runs in Python with ropewalk installed: pip install 'ropewalk[fmi]'."
_SCRIPT = '''"""{title}"""

import ctypes

try:
    import ropewalk.cosim.slaves as slaves
except ImportError as error:
    raise ImportError(
        f"this FMU runs in Python with ropewalk installed (pip install 'ropewalk[fmi]'), and it is not: {{error}}"
    ) from error


class {model}(slaves.{slave}):
    """{title}"""


# For every instance this text is run once more, and then the loader lets go of the names of this module, which it has
# not taken hold of (pythonfmu 0.7): without one hold more the second instance would find the module empty.
ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))
'''


@dataclass(frozen=True)
class LineExport:
    """What an exported line is to look like."""

    contacts: int = 1
    measured: Measure = "material"
    contact_stiffness: float = _CONTACT_STIFFNESS  # N/m, where it gives force
    contact_damping: float = 0.0  # N s/m
    side: Side | None = None  # of bodies that may leave it
    every: float = _EVERY  # s, step of the master


def export(
    scenario: Scenario,
    what: str,
    file: str | Path,
    *,
    causality: Gives | None = None,
    contacts: int = 1,
    measured: Measure = "material",
    contact_stiffness: float | None = None,
    contact_damping: float = 0.0,
    side: Side | None = None,
    every: float = _EVERY,
) -> Path:
    """Write a line or net with its supports, or a vehicle, as an FMU for co-simulation (FMI 2.0).

    Args:
        scenario: of kind dynamic; all lines and loads of it travel in the FMU of a line.
        what: name of the line, the net or the load; contacts on a net go along the path of its first load.
        file: to be written, .fmu.
        causality: what it gives. Of a line, motion (the default): forces in, heights of the contacts out; force:
            heights in, forces of contact springs out. Of a vehicle, force (the default where its contacts have
            springs): heights of the line in, forces on it out; motion (else): forces in, heights of its contacts out.
        contacts: of a line, how many.
        measured: of a line, what places count: the unstrained length from its start, or x.
        contact_stiffness: N/m, of a line that gives force (default 1 MN/m); of a vehicle, below contacts without one.
        contact_damping: N s/m, of a line that gives force.
        side: of a line that gives force: where bodies are that may leave it; None: they are held.
        every: s, the step that a master is expected to take; wires go on by whole parts of it only.

    Returns:
        The file.

    Raises:
        RopewalkError: pythonfmu or the folder is missing, or there is something that cannot be exported.
    """
    file = Path(file)
    _check(scenario, file)
    if what in {**scenario.lines, **scenario.overhead_lines, **scenario.nets}:
        wish = LineExport(
            contacts, measured, _CONTACT_STIFFNESS if contact_stiffness is None else contact_stiffness, contact_damping,
            side, every,
        )  # fmt: skip
        resources, options = _line(scenario, what, file, causality or "motion", wish)
        slave = "LineSlave"
    elif what in scenario.loads:
        resources, options = _vehicle(scenario, what, file, causality, contact_stiffness, every)
        slave = "VehicleSlave"
    else:
        names = [*scenario.lines, *scenario.overhead_lines, *scenario.nets, *scenario.loads]
        raise _refused("export", "there is no such line or load", what, did_you_mean(what, names))
    _build(file, slave, resources, options)
    return file


def _check(scenario: Scenario, file: Path) -> None:
    if importlib.util.find_spec("pythonfmu") is None:
        raise RopewalkError("writing an FMU needs pythonfmu, which is not installed: pip install 'ropewalk[fmi]'")
    if file.suffix != ".fmu":
        raise _refused("output", "the name of an FMU must end in .fmu", str(file), f"write {file.stem}.fmu")
    if not file.parent.is_dir():
        raise _refused("output", "the folder does not exist", str(file.parent), "create it or choose another place")
    if isinstance(scenario.run, Dynamic) and scenario.run.start.kind == "result":
        raise _refused(
            "run.start", "an FMU does not carry the result that the motion begins with", remedy="start from equilibrium"
        )


def _refused(key: str, wrong: str, given: str = "", remedy: str = "") -> ScenarioError:
    return ScenarioError([Problem(key, wrong, given, remedy)])


def _model(file: Path) -> str:
    """A name for the model that is the name of a class, too."""
    name = re.sub(r"\W", "_", file.stem, flags=re.ASCII)
    return name if name[:1].isalpha() else f"Model_{name}"


def _line(scenario: Scenario, line: str, file: Path, gives: Gives, wish: LineExport) -> tuple[dict[str, str], Any]:
    if wish.contacts < 1:
        raise _refused("contacts", "a line needs a contact", str(wish.contacts), "ask for one or more")
    if gives == "force" and not wish.contact_stiffness > 0.0:
        wrong, remedy = "a line that gives force needs a spring", "write more than 0 N/m, for example 1e6 N/m"
        raise _refused("contact_stiffness", wrong, f"{wish.contact_stiffness:g} N/m", remedy)
    text = dump(scenario)
    names = [f"contact{i + 1}" for i in range(wish.contacts)]
    sprung = gives == "force"
    outside = Outside(line, wish.contact_stiffness if sprung else 0.0, wish.contact_damping, wish.side)
    motion = stepwise(scenario, dict.fromkeys(names, outside), step=wish.every)
    length = motion.length(line)
    middle, ends = motion.at(line, 0.5 * length)[0], [motion.at(line, xi)[0] for xi in (0.0, length)]
    run = scenario.run
    assert isinstance(run, Dynamic)
    way = "heights of bodies in, contact forces out" if sprung else "forces in, motion of the contacts out"
    wires = "lines with bending stiffness and overhead lines take whole parts of the step that the FMU was exported for"
    given = {
        "model": _model(file), "description": f"{scenario.title}: line {line} with its supports, {way}. {_NEEDS}",
        "line": line, "gives": gives, "places": [0.5 * length if wish.measured == "material" else float(middle[0])]
        * wish.contacts, "heights": [float(middle[-1])] * wish.contacts, "measured": wish.measured,
        "span": sorted(float(end[0]) for end in ends), "along": not scenario.has_bending_stiffness, "side": wish.side,
        "stiffness": wish.contact_stiffness, "damping": wish.contact_damping, "until": run.until, "every": wish.every,
        "step": run.step or 0.0, "step_means": f"largest inner step; 0: run.step of the scenario, or the largest "
                                               f"stable step; {wires}",
        "axes": _axes(motion), "supports": list(motion.support_forces()),
    }  # fmt: skip
    return {"about.json": json.dumps(given, indent=1), "scenario.yaml": text}, {
        "canGetAndSetFMUstate": _can_go_back(motion)
    }


def _axes(motion: Stepwise) -> list[str]:
    return ["x", "z"] if motion.dim == 2 else ["x", "y", "z"]


def _can_go_back(motion: Stepwise) -> bool:
    try:
        motion.get_state()
    except RopewalkError:
        return False
    return True


def _vehicle(
    scenario: Scenario, name: str, file: Path, gives: Gives | None, stiffness: float | None, every: float
) -> tuple[dict[str, str], Any]:
    vehicle = alone(scenario, name, contact_stiffness=stiffness)
    stiff = [touch for touch in vehicle.touches if not touch.stiffness < float("inf")]
    if gives is None:
        gives = "motion" if stiff else "force"
    if gives == "force" and stiff:
        raise RopewalkError(
            f"load {name}: its contact has no spring that could answer a motion with a force; give contact_stiffness, "
            "for example 1e6 N/m, or let it give motion"
        )
    way = "heights of the line in, forces out" if gives == "force" else "forces in, heights of its contacts out"
    level = [touch.base for touch in vehicle.touches]
    given = {
        "model": _model(file),
        "description": f"{scenario.title}: {vehicle.kind} {name} without its line, {way}. {_NEEDS}",
        "gives": gives, "heights": level, "every": every,
    }  # fmt: skip
    return {"about.json": json.dumps(given, indent=1), "vehicle.json": vehicle.written()}, {
        "canGetAndSetFMUstate": True
    }


def _build(file: Path, slave: str, resources: dict[str, str], options: dict[str, Any]) -> None:
    """Write the FMU through pythonfmu.

    The module of the slave gets a name that no other FMU has: within a process Python imports a name only once, and the
    second FMU would get the class of the first. What pythonfmu leaves behind in this process is taken back.
    """
    from pythonfmu.builder import FmuBuilder

    module = f"slave_{uuid.uuid4().hex}"
    given = json.loads(resources["about.json"])
    script = _SCRIPT.format(title=given["description"].replace('"', "'"), model=given["model"], slave=slave)
    paths = list(sys.path)
    with tempfile.TemporaryDirectory(prefix="ropewalk_") as folder:
        source = Path(folder) / f"{module}.py"
        source.write_text(script, encoding="utf-8")
        files = []
        for name, text in resources.items():
            files.append(Path(folder) / name)
            files[-1].write_text(text, encoding="utf-8")
        sys.path.insert(0, folder)
        # An FMU that has run in this process has imported our slaves with the pythonfmu that it brings, whose classes
        # the builder does not know.
        sys.modules.pop("ropewalk.cosim.slaves", None)
        try:
            FmuBuilder.build_FMU(source, dest=file, project_files=files, **options)
        except OSError as error:
            raise RopewalkError(f"{file}: cannot be written ({error.strerror or error})") from error
        finally:
            sys.path[:] = paths
            sys.modules.pop(module, None)
