"""The models of external loads, found or made."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.external.cosimulation_master import CosimulationMaster
from ropewalk.mechanics.contact_points import contacts_of, named
from ropewalk.model.fmu import Fmu
from ropewalk.model.load import AnyLoad, ExternalModel
from ropewalk.model.stepper import Stepper
from ropewalk.permission import check_code, refusal_of_code


def cosimulation_of(name: str, load: ExternalModel, until: float, dim: int, reach: float) -> CosimulationMaster:
    """An external load and its line, ready to take turns.

    Args:
        name: of the load.
        load: as declared.
        until: end of the run, s.
        dim: number of axes.
        reach: m, a contact that is said to be further from where it has slid to is put down anew.

    Raises:
        RopewalkError: there is no such model, or it cannot be made.
    """
    model = model_of(name, load, until, dim)
    at_end = load.at_end if isinstance(load, Stepper) else load.travel.at_end
    master = CosimulationMaster(name, model, load.every, load.exchange, at_end, contacts_of(name, load), dim, reach)
    master.diagnostics += model.diagnostics if isinstance(load, Fmu) else []
    return master


def model_of(name: str, load: ExternalModel, until: float, dim: int) -> Any:
    """The model of an external load: the object itself, or made from what its text names, or from its FMU.

    Raises:
        RopewalkError: there is no such thing, or it cannot be made.
    """
    if not isinstance(load, Stepper):
        check_code(name, "file", load.file)
        from ropewalk.external.fmu import FmuModel  # lazy: few runs need FMPy

        return FmuModel(name, load, until, dim)
    if not isinstance(load.model, str):
        return load.model
    made = named(name, load.model)
    try:
        made = made(**load.options) if callable(made) else made
    except RopewalkError:
        raise
    except (Exception, SystemExit) as error:
        why = f"it ends the program, {error!r}" if isinstance(error, SystemExit) else error
        raise RopewalkError(f"load {name}: its model {load.model} cannot be made ({why})") from error
    if not callable(getattr(made, "step", None)):
        raise RopewalkError(f"load {name}: {load.model} has no method step(t, h, line)")
    return made


def refuse_code(loads: Mapping[str, AnyLoad]) -> None:
    """Refuse loads whose computation runs code of somebody else: models of Python, and FMUs.

    Raises:
        ScenarioError: with all of them.
    """
    problems = [
        refusal_of_code(name, *(("file", load.file) if isinstance(load, Fmu) else ("model", str(load.model))))
        for name, load in loads.items()
        if isinstance(load, ExternalModel)
    ]
    if problems:
        raise ScenarioError(problems)


def check_external(loads: Mapping[str, AnyLoad]) -> None:
    """Find problems of the files of external loads, without running them.

    Raises:
        ScenarioError: with all mistakes.
        RopewalkError: what reads them is not installed.
    """
    fmus = {name: load for name, load in loads.items() if isinstance(load, Fmu)}
    if not fmus:
        return
    from ropewalk.external.description import check_fmu  # lazy: few runs need FMPy

    if problems := [problem for name, load in fmus.items() for problem in check_fmu(name, load)]:
        raise ScenarioError(problems)
