"""The wiring of an FMU: what of it is used, and how, as plain values."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple


class StartValue(NamedTuple):
    """A value of a variable that is set before the beginning."""

    name: str
    reference: int
    type: str  # as FMI names it
    value: bool | int | float | str


@dataclass(frozen=True)
class Wiring:
    """All that it takes to put an FMU to work; of plain values, so that it can be sent to another process."""

    name: str  # of the load
    file: str  # whole path
    identifier: str  # of the binary
    token: str  # guid or instantiation token
    version: int  # 2 or 3
    inputs: tuple[int, ...]  # value references of what it is told
    outputs: tuple[int, ...]  # of what it answers
    output_names: tuple[str, ...]
    settings: tuple[StartValue, ...]
    is_interpolating: bool  # takes the slopes of its inputs
    can_go_back: bool  # its state can be saved
    can_pack: bool  # and given as bytes
    goes_back: bool  # and it will be asked to save it
    needs_tool: bool  # says that it needs the program that made it
    unheard: tuple[str, ...] = ()  # names of inputs that nobody sets

    @property
    def who(self) -> str:
        """Whom an error is about."""
        return f"load {self.name}: its FMU {Path(self.file).name}"
