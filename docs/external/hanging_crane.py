"""A crane of the package py-crane, hung on a line: an FMU that is told an acceleration and gives its positions.

py-crane 0.3.1 of DNV, licence MIT, is made for ships; its FMUs (FMI 2.0, made with PythonFMU) need the packages
component-model and pythonfmu, which come with it. The crane is told how its fixation accelerates, moves it, and swings
its load. The line bears the fixation by the spring of the interface (`exchange.stiffness`), whose force F says how:

    (M + m) a = F - (M + m) g - m r''

with the masses M of pedestal and boom and m of the load, and the acceleration r'' of the load as seen from the
fixation, which lags by an interval. `kind: fmu` cannot say this: no output of the crane is the whole force. Its
`force` leaves the load out, and counts pedestal and boom twice: -2 M (g + a). (Its last boom is never noted, so that
what should be the load is the whole crane once more.) Nor does the load feel quite what it should: its speed counts
the rise of the fixation along the wire, which runs away in a time of (length of the wire) / (speed of the fixation):
let the wire be long where the line gives way much.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import numpy as np
from fmpy import read_model_description

from ropewalk.errors import RopewalkError, did_you_mean
from ropewalk.external.fmu_wiring import StartValue, Wiring
from ropewalk.external.protocol import SeenLine, Touch
from ropewalk.external.slave import Slave
from ropewalk.mechanics.chain import Array

GRAVITY = 9.81  # m/s^2, that of py-crane
ALONG_WIRE = 0.99  # where on the wire its centre of mass is
_PLACES = tuple(f"{part}.end[{axis}]" for part in ("pedestal", "boom", "wire") for axis in range(3))
_FORCE = tuple(f"force[{axis}]" for axis in range(3))
_OUTPUTS = (*_PLACES, *_FORCE, "velocity[2]", "pedestal.mass", "boom.mass", "wire.mass")
_INPUTS = tuple(f"d_velocity[{axis}]" for axis in range(3))


class HangingCrane:
    """A crane that hangs on a line at one place, upright, and goes up and down with it.

    It begins at rest where the line is, without having been borne before. What it would do to the line by its moments
    is left out: the line takes forces only.

    Args:
        at: where it hangs, m from the start of the line.
        file: its FMU; the name alone if it is one of those in py-crane.
        parameters: variable: value, set before it begins, in the units of the FMU.
        drives: input variable: value, or [times in s, values], linear in between; what the crane driver does.

    Raises:
        RopewalkError: py-crane is absent, or there is no such file or variable.
    """

    contacts = 1

    def __init__(
        self, at: float, file: str = "MobileCrane.fmu", parameters: Mapping[str, float] | None = None,
        drives: Mapping[str, float | Sequence[Sequence[float]]] | None = None,
    ) -> None:  # fmt: skip
        self._at, self._drives = at, dict(drives or {})
        self._wiring = _wiring(_found(file), dict(parameters or {}), tuple(self._drives))
        self._slave: Slave | None = None

    @property
    def height(self) -> float:
        """Of the fixation from where it began, m."""
        return float(self._seen["pedestal.end[2]"] - self._first["pedestal.end[2]"])

    @property
    def places(self) -> Array:
        """Ends of pedestal, boom and wire as the FMU gives them, (part, axis) m, counted as it does."""
        return np.array([self._seen[name] for name in _PLACES]).reshape(3, 3)

    @property
    def own_force(self) -> Array:
        """Force on the fixation as the FMU gives it, (axis,) N: twice the pedestal and the boom, without the load."""
        return np.array([self._seen[name] for name in _FORCE])

    @property
    def masses(self) -> tuple[float, float]:
        """Of pedestal and boom together, and of the load, kg."""
        return self._seen["pedestal.mass"] + self._seen["boom.mass"], self._seen["wire.mass"]

    def reset(self, line: SeenLine) -> None:
        """Begin anew, hung on the line where it is.

        Raises:
            RopewalkError: the FMU cannot be loaded or initialised.
        """
        self.close()
        self._slave = Slave(self._wiring)
        self._ground = float(line.at(self._at)[0][-1])
        self._t = 0.0
        self._read(self._slave.begin(self._inputs(0.0, 0.0), np.inf))
        self._first = dict(self._seen)
        self._loads = [self._load()] * 3

    def step(self, t: float, h: float, line: SeenLine) -> list[Touch]:
        """Go on to t as the mean force of the interface in the interval before says.

        Raises:
            RopewalkError: no spring of the interface bears it, or the FMU fails.
        """
        if self._slave is None:
            self.reset(line)
        assert self._slave is not None
        borne = -float(line.force(0)[-1])
        below = float(line.at(self._at)[0][-1]) - self._ground - self.height
        if borne == 0.0 and abs(below) > 1e-3:
            raise RopewalkError("nothing carries the crane; give exchange.stiffness, for example 1e6 N/m")
        crane, load = self.masses
        swing = (self._loads[0] - 2.0 * self._loads[1] + self._loads[2]) / h**2  # m/s^2
        a = (borne - load * swing[2]) / (crane + load) - GRAVITY
        if t > 0.0:
            self._read(self._slave.advance(self._t, t - self._t, self._inputs(t, a)))
            self._t = t
            self._loads = [self._load(), *self._loads[:2]]
        dim = line.at(self._at)[0].size
        pull = -load * swing
        across = (pull[0],) if dim == 2 else (pull[0], pull[1])
        # The FMU will move by its velocity at the end of the next interval, foreseen with the acceleration of the last.
        return [Touch(self._at, (*across, 0.0), 0.0, (self._ground + self.height, self._seen["velocity[2]"] + a * h))]

    def close(self) -> None:
        """Let the FMU go."""
        slave, self._slave = self._slave, None
        if slave is not None:
            slave.close()

    def _load(self) -> Array:
        """The load as seen from the top of the pedestal, (axis,) m."""
        pedestal, boom, wire = self.places
        place: Array = boom + ALONG_WIRE * (wire - boom) - pedestal
        return place

    def _inputs(self, t: float, a: float) -> list[float]:
        drives = [
            float(value) if isinstance(value, int | float) else float(np.interp(t, value[0], value[1]))
            for value in self._drives.values()
        ]
        return [0.0, 0.0, a, *drives]

    def _read(self, outputs: Sequence[float]) -> None:
        self._seen = dict(zip(_OUTPUTS, outputs, strict=True))


def _found(file: str) -> Path:
    """The FMU as a file, from the folder or from py-crane."""
    if Path(file).is_file():
        return Path(file)
    try:
        files = distribution("py-crane").files or []
    except PackageNotFoundError as error:
        raise RopewalkError(
            f"there is no file {file}, and the package py-crane, which contains FMUs by name, is not installed; "
            'pip install py-crane, or pip install "ropewalk[external]"'
        ) from error
    fmus = {each.name: Path(str(each.locate())) for each in files if each.suffix == ".fmu"}
    if file not in fmus:
        raise RopewalkError(f"there is no FMU {file}; {did_you_mean(file, fmus)}")
    # It brings modules of its own, which stay when its folder has gone, and half of which the next FMU of its kind
    # would find: let all take those that are installed.
    for module in ("component_model.model", "component_model.utils.transform", "py_crane.crane_fmu"):
        import_module(module)
    return fmus[file]


def _wiring(file: Path, parameters: Mapping[str, float], drives: tuple[str, ...]) -> Wiring:
    """What of the crane is used, by the names of its variables."""
    description = read_model_description(str(file))
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    for name in (*_INPUTS, *_OUTPUTS, *parameters, *drives):
        if name not in references:
            raise RopewalkError(f"the FMU {file.name} has no variable {name}; {did_you_mean(name, references)}")
    return Wiring(
        name="crane",
        file=str(file.resolve()),
        identifier=description.coSimulation.modelIdentifier,
        token=description.guid,
        version=2,
        inputs=tuple(references[name] for name in (*_INPUTS, *drives)),
        outputs=tuple(references[name] for name in _OUTPUTS),
        output_names=_OUTPUTS,
        settings=tuple(StartValue(name, references[name], "Real", float(value)) for name, value in parameters.items()),
        is_interpolating=False,
        can_go_back=False,
        can_pack=False,
        goes_back=False,
        needs_tool=False,
    )
