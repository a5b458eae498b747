"""The description of an FMU: what the file says of itself, and whether a load fits it."""

from __future__ import annotations

import zipfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from typing import Any

from ropewalk.errors import Problem, Refused, RopewalkError, ScenarioError, did_you_mean
from ropewalk.external.archive import DESCRIPTION, check_description, check_size
from ropewalk.external.fmu_wiring import StartValue, Wiring
from ropewalk.model.fmu import Fmu, FmuContact, Value

REALS = {2: "Real", 3: "Float64"}
WHOLE = {
    "Integer": 31, "Int8": 7, "Int16": 15, "Int32": 31, "Int64": 63, "UInt8": 8, "UInt16": 16, "UInt32": 32,
    "UInt64": 64,
}  # fmt: skip
"""Types of whole numbers, with the bits of their size."""
DISPLAYED = 8  # names that a remedy lists

INPUTS = {"force": ("height", "velocity", "place"), "motion": ("force", "place")}
OUTPUTS = {"force": ("force", "force_along"), "motion": ("height", "velocity")}
"""Keys of a contact that name what it is told and what it answers, by what it gives."""


def check_fmu(name: str, load: Fmu) -> list[Problem]:
    """List all mistakes of a load and its file that can be found without starting the FMU.

    Raises:
        RopewalkError: FMPy is not installed.
    """
    return _Reading(name, load).problems


def wiring_of(name: str, load: Fmu) -> Wiring:
    """What it takes to put the FMU of a load to work.

    Raises:
        RopewalkError: FMPy is not installed.
        ScenarioError: the file is no FMU that can be used, or the load does not fit it.
    """
    reading = _Reading(name, load)
    if reading.problems or reading.wiring is None:
        raise ScenarioError(reading.problems)
    return reading.wiring


def mentioned(contact: FmuContact) -> list[str]:
    """The keys of a contact that name what its FMU is told."""
    return [key for key in INPUTS[contact.gives] if getattr(contact, key) is not None]


def answered(contact: FmuContact) -> list[str]:
    """The keys of a contact that name what its FMU answers."""
    return [key for key in OUTPUTS[contact.gives] if getattr(contact, key) is not None]


@dataclass
class _Reading:
    """A load beside the description of its FMU, and everything that does not fit."""

    name: str
    load: Fmu
    problems: list[Problem] = field(default_factory=list)
    wiring: Wiring | None = None

    def __post_init__(self) -> None:
        description = self._described()
        if description is None:
            return
        version, slave = int(description.fmiVersion[0]), description.coSimulation
        self._variables = {variable.name: variable for variable in description.modelVariables}
        self._version = version
        inputs = [self._variable(*each, ("input",)) for each in self._keys(mentioned)]
        outputs = [self._variable(*each, ("output", "local")) for each in self._keys(answered)]
        self._mentioned_twice()
        settings = [*self._settings("parameters"), *self._settings("start_values")]
        goes_back = self.load.exchange.scheme == "iterated"
        if goes_back and not slave.canGetAndSetFMUstate:
            wrong = "repeats intervals, and this FMU cannot (canGetAndSetFMUstate is not set)"
            self._report("exchange.scheme", wrong, "iterated", "write sequential or parallel")
        self._fits_step(slave)
        if self.problems:
            return
        self.wiring = Wiring(
            self.name, str(Path(self.load.file).resolve()), slave.modelIdentifier, description.guid, version,
            tuple(v.valueReference for v in inputs), tuple(v.valueReference for v in outputs),
            tuple(v.name for v in outputs), tuple(settings),
            is_interpolating=version == 2 and bool(slave.canInterpolateInputs),
            can_go_back=bool(slave.canGetAndSetFMUstate), can_pack=bool(slave.canSerializeFMUstate),
            goes_back=goes_back, needs_tool=bool(slave.needsExecutionTool), unheard=tuple(self._unheard()),
        )  # fmt: skip

    def _unheard(self) -> Iterator[str]:
        """Inputs that neither a contact nor a start value sets."""
        known = {wanted for _, wanted in self._keys(mentioned)} | set(self.load.start_values)
        return (v.name for v in self._variables.values() if v.causality == "input" and v.name not in known)

    # -- The file ------------------------------------------------------------------------------------------------

    def _described(self) -> Any:
        """What FMPy reads of the file, None if it cannot be used."""
        try:
            from fmpy import read_model_description
        except ImportError as error:
            raise RopewalkError(
                f'load {self.name}: FMUs need FMPy, which is not installed ({error}); pip install "ropewalk[fmi]"'
            ) from error
        path = Path(self.load.file)
        if not path.is_file():
            wrong = "is a folder" if path.is_dir() else "there is no such file"
            return self._report("file", wrong, remedy="write its path relative to the working directory")
        try:
            with zipfile.ZipFile(path) as archive:
                names = archive.namelist()
            check_size(path)
        except RopewalkError as error:
            return self._report("file", str(error), remedy="remove unused files from it")
        except (zipfile.BadZipFile, OSError) as error:
            return self._report("file", f"is not an FMU, it cannot be unpacked ({error})", remedy="export it again")
        if DESCRIPTION not in names:
            return self._report("file", "is not an FMU, it has no modelDescription.xml", remedy="export it again")
        try:
            check_description(path)
        except Refused as error:
            return self._report("file", f"its {DESCRIPTION} {error.wrong}", remedy=error.remedy)
        except Exception as error:  # whatever a broken archive makes of its reader
            return self._report("file", f"its {DESCRIPTION} cannot be unpacked ({error})", remedy="export it again")
        try:
            description = read_model_description(str(path), validate=False)
            version = description.fmiVersion
        except Exception as error:  # whatever a broken description makes of the reader
            return self._report("file", f"its modelDescription.xml cannot be read ({error})", remedy="export it again")
        if version.split(".")[0] not in ("2", "3"):
            return self._report("file", f"is an FMU of FMI {version}", remedy="export it with FMI 2.0 or 3.0")
        if description.coSimulation is None:
            kinds = {"modelExchange": "model exchange", "scheduledExecution": "scheduled execution"}
            kind = next((text for key, text in kinds.items() if getattr(description, key, None)), "nothing")
            return self._report("file", f"is an FMU for {kind} only", remedy="export it for co-simulation")
        return description if self._has_binary(names, description) else None

    def _has_binary(self, names: list[str], description: Any) -> bool:
        from fmpy import platform, platform_tuple, sharedLibraryExtension

        here = platform_tuple if description.fmiVersion.startswith("3") else platform
        wanted = f"binaries/{here}/{description.coSimulation.modelIdentifier}{sharedLibraryExtension}"
        if wanted in names:
            return True
        parts = [name.split("/") for name in names]
        there = sorted({part[1] for part in parts if part[0] == "binaries" and len(part) > 2 and part[2]})
        sources = any(part[0] == "sources" and part[-1].endswith(".c") for part in parts)
        has = [f"binaries for {', '.join(there)}"] * bool(there) + ["sources in C"] * sources
        wrong = f"has no binary for this platform (no {wanted} in it)"
        remedy = "it has " + " and ".join(has) if has else "it has none at all"
        self._report("file", wrong, remedy=f"{remedy}; export it for {here}" + ", or compile it" * sources)
        return False

    # -- Variables -----------------------------------------------------------------------------------------------

    def _keys(self, of: Any) -> Iterator[tuple[str, str]]:
        for label, contact in self.load.contacts.items():
            for key in of(contact):
                yield f"contacts.{label}.{key}", getattr(contact, key)

    def _variable(self, key: str, wanted: str, causality: tuple[str, ...]) -> Any:
        """A variable that is exchanged: a single real number of the right causality."""
        variable = self._variables.get(wanted)
        fitting = [v.name for v in self._variables.values() if self._is_real(v) and v.causality == causality[0]]
        if variable is None:
            remedy = did_you_mean(wanted, self._variables, _listed(f"its {causality[0]}s:", fitting))
            return self._report(key, "the FMU has no such variable", wanted, remedy)
        if variable.causality not in causality:
            wrong = f"must be an {causality[0]} of the FMU, this is of causality {variable.causality}"
            return self._report(key, wrong, wanted, _listed(f"its {causality[0]}s:", fitting))
        if not self._is_real(variable):
            kind = "array" if variable.shape else variable.type
            wrong = f"must be a single number of type {REALS[self._version]}, this is of type {kind}"
            return self._report(key, wrong, wanted, _listed(f"its {causality[0]}s:", fitting))
        return variable

    def _is_real(self, variable: Any) -> bool:
        return variable.type == REALS[self._version] and not variable.shape

    def _mentioned_twice(self) -> None:
        first: dict[str, str] = {}
        for key, wanted in self._keys(mentioned):
            if wanted in first:
                remedy = "give every contact inputs of its own"
                self._report(key, f"is set by {first[wanted]} already", wanted, remedy)
            first.setdefault(wanted, key)

    def _fits_step(self, slave: Any) -> None:
        """Of FMI 3.0: a step of the FMU's own, of which the interval must be a multiple."""
        own = float(slave.fixedInternalStepSize or 0.0)
        times = self.load.every / own if own > 0.0 else 1.0
        if abs(times - round(times)) > 1e-6 * times or round(times) < 1:
            wrong = f"must be a multiple of the FMU's own step, {own:g} s"
            self._report("every", wrong, f"{self.load.every:g} s", f"write {max(round(times), 1) * own:g} s")

    # -- Values --------------------------------------------------------------------------------------------------

    def _settings(self, block: str) -> Iterator[StartValue]:
        lines = {wanted: key for key, wanted in self._keys(mentioned)}
        for wanted, value in getattr(self.load, block).items():
            key, variable = f"{block}.{wanted}", self._variables.get(wanted)
            if variable is None:
                options = [v.name for v in self._variables.values() if _block_of(v) == block]
                remedy = did_you_mean(wanted, self._variables, _listed("it has", options))
                self._report(key, "the FMU has no such variable", remedy=remedy)
            elif _block_of(variable) is None:
                what = "is constant" if variable.variability == "constant" else f"is {variable.causality}"
                self._report(key, f"cannot be set: it {what} ({variable.variability})", remedy="leave it out")
            elif _block_of(variable) != block:
                what = "a parameter" if block == "start_values" else "none of the parameters"
                self._report(key, f"is {what} of the FMU", remedy=f"write it under {_block_of(variable)}")
            elif wanted in lines:
                self._report(key, f"is set by the line ({lines[wanted]})", remedy="leave it out")
            elif (wrong := _misfit(variable, value)) is not None:
                self._report(key, wrong, repr(value), f"write {_expected(variable)}")
            else:
                yield StartValue(wanted, variable.valueReference, variable.type, _converted(variable, value))

    def _report(self, key: str, wrong: str, given: str | None = None, remedy: str = "") -> None:
        given = self.load.file if given is None and key == "file" else given or ""
        self.problems.append(Problem(f"loads.{self.name}.{key}", wrong, given, remedy))


def _listed(head: str, names: list[str]) -> str:
    """Name what there is, as far as it is short."""
    more = f" and {len(names) - DISPLAYED} more" if len(names) > DISPLAYED else ""
    return f"{head} {', '.join(names[:DISPLAYED])}{more}" if names else f"{head} none"


def _block_of(variable: Any) -> str | None:
    """The block of a load under which a variable can be set."""
    if variable.variability == "constant" or variable.type in ("Binary", "Clock"):
        return None
    if variable.causality == "parameter":
        return "parameters"
    is_settable = variable.causality == "input" or variable.initial in ("exact", "approx")
    return "start_values" if variable.causality in ("input", "output", "local") and is_settable else None


def _items(variable: Any) -> dict[str, int]:
    items: Iterable[Any] = getattr(variable.declaredType, "items", None) or ()
    return {item.name: int(item.value) for item in items}


def _misfit(variable: Any, value: Value) -> str | None:
    """Problems of the value of a variable."""
    kind = variable.type
    if variable.shape:
        return "is an array, of which values cannot be set"
    if kind == "Enumeration" and isinstance(value, str):
        return None if value in _items(variable) else "is none of the values of this enumeration"
    if kind == "String":
        fits = isinstance(value, str)
    elif kind == "Boolean":
        fits = isinstance(value, bool)
    elif kind in WHOLE or kind == "Enumeration":
        fits = isinstance(value, int | float) and not isinstance(value, bool) and float(value).is_integer()
        bits = WHOLE.get(kind, 31)
        fits = fits and (0 if kind.startswith("U") else -(2**bits)) <= int(value) < 2**bits
    else:
        fits = isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
    if not fits:
        return f"does not fit the type of the variable, {kind}"
    if isinstance(value, int | float) and not isinstance(value, bool):
        if variable.min is not None and value < float(variable.min):
            return f"is below the minimum of the FMU, {variable.min}"
        if variable.max is not None and value > float(variable.max):
            return f"is above the maximum of the FMU, {variable.max}"
    return None


def _expected(variable: Any) -> str:
    kind = variable.type
    if kind == "Enumeration":
        return f"one of {', '.join(_items(variable))}" if _items(variable) else "a whole number"
    if kind in WHOLE:
        return "a whole number"
    unit = f" in {variable.unit}" if variable.unit else ""
    return {"String": "text", "Boolean": "true or false"}.get(kind, f"a number{unit}")


def _converted(variable: Any, value: Value) -> Value:
    if isinstance(value, str):
        return _items(variable)[value] if variable.type == "Enumeration" else value
    return (
        value
        if variable.type == "Boolean"
        else int(value)
        if variable.type in (*WHOLE, "Enumeration")
        else float(value)
    )
