"""The parts of a scenario, as the checks of what does not fit together see them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from ropewalk.model.joint import Joint
from ropewalk.model.law import Inextensible
from ropewalk.model.line import Line
from ropewalk.model.load import AnyLoad
from ropewalk.model.net import AnyNet
from ropewalk.model.outputs import Outputs
from ropewalk.model.overhead import OverheadLine
from ropewalk.model.quantity import Auto
from ropewalk.model.run import Dynamic, Equilibrium, Linear, Quasistatic
from ropewalk.model.track import Track
from ropewalk.model.wind import Wind


@dataclass(frozen=True)
class Parts:
    """A scenario in parts; a part that is itself wrong is None, and checks that need it are left out."""

    lines: Mapping[str, Line | None]
    loads: Mapping[str, AnyLoad | None]
    run: Dynamic | Quasistatic | Equilibrium | Linear | None
    gravity: float | None
    on: Mapping[str, str] = field(default_factory=dict)  # line named by each load, also by those that are None
    overhead: Mapping[str, OverheadLine | None] = field(default_factory=dict)
    nets: Mapping[str, AnyNet | None] = field(default_factory=dict)
    joints: Mapping[str, Joint | None] = field(default_factory=dict)
    wind: Wind | None = None
    outputs: Outputs = field(default_factory=Outputs)
    is_complete: bool = True  # whether no block of lines hides behind a misspelt key
    tracks: Mapping[str, Track | None] = field(default_factory=dict)

    def loads_on(self, line: str) -> list[str]:
        """Names of the loads on a line."""
        return [load for load, name in self.on.items() if name == line]

    @property
    def is_network(self) -> bool:
        """Whether lines are joined, by tracks, too, over sheaves or, if none bends, on inner supports; nets; air."""
        lines = [line for line in self.lines.values() if line is not None]
        joined = any(line.is_joined for line in lines)
        joined = joined or bool(self.tracks)
        return bool(self.nets) or self.is_airy or joined or (self.is_supported and not self.has_bending_stiffness)

    @property
    def is_supported(self) -> bool:
        """Whether a line has supports between its ends."""
        return any(line is not None and bool(line.supports) for line in self.lines.values())

    @property
    def is_airy(self) -> bool:
        """Whether the air pushes at lines, also where it stands still and they move, or blows at loads."""
        if self.wind is None:
            return False
        lines = any(line is not None and line.wind_drag for line in self.lines.values())
        return lines or (not self.wind.is_calm and any(_feels_air(load) for load in self.loads.values()))

    @property
    def has_bending_stiffness(self) -> bool:
        """Whether lines have bending stiffness or a bed, or there are overhead lines."""
        return bool(self.overhead) or any(
            line is not None and line.has_bending_stiffness for line in self.lines.values()
        )

    @property
    def runs_over_sheaves(self) -> bool:
        """Whether a line does."""
        return any(line is not None and bool(line.sheaves) for line in self.lines.values())

    @property
    def has_inextensible(self) -> bool:
        """Whether a line is inextensible."""
        return any(line is not None and isinstance(line.law, Inextensible) for line in self.lines.values())

    @property
    def has_profile(self) -> bool:
        """Whether wheels run over a profile of a line."""
        return any(line is not None and line.profile is not None for line in self.lines.values())

    @property
    def has_saddles(self) -> bool:
        """Whether a line lies on saddles."""
        return any(line is not None and bool(line.saddles) for line in self.lines.values())

    @property
    def has_segments(self) -> bool:
        """Whether a line has parts with another stiffness, mass or bed."""
        return any(line is not None and bool(line.segments) for line in self.lines.values())

    @property
    def has_cut(self) -> bool:
        """Whether a line is cut on the way."""
        return any(line is not None and line.cut is not None for line in self.lines.values())

    @property
    def has_hysteresis(self) -> bool:
        """Whether a line gives back less than it has taken."""
        return any(line is not None and line.hysteresis is not None for line in self.lines.values())

    @property
    def has_winch(self) -> bool:
        """Whether a winch pulls at the end of a line."""
        return any(line is not None and line.winches for line in self.lines.values())

    @property
    def is_for_the_system(self) -> bool:
        """Whether there is what no other engine knows."""
        kinds = self.has_profile, self.has_segments, self.has_saddles, self.has_cut, self.has_winch
        more = self.has_sprung_brake, self.has_hysteresis, self.has_carriages, self.has_hoists, bool(self.tracks)
        return any(kinds) or any(more) or self.has_crabs

    @property
    def has_sprung_brake(self) -> bool:
        """Whether a brake has another force than a constant one."""
        brakes = (getattr(getattr(load, "travel", None), "brake", None) for load in self.loads.values())
        return any(brake is not None and not brake.is_blocks for brake in brakes)

    @property
    def has_carriages(self) -> bool:
        """Whether there are carriages."""
        return any(getattr(load, "kind", "") == "carriage" for load in self.loads.values())

    @property
    def has_hoists(self) -> bool:
        """Whether ropes of payloads are taken in."""
        hoists = (getattr(getattr(load, "payload", None), "hoist", 0.0) for load in self.loads.values())
        return any(callable(hoist) or hoist != 0.0 for hoist in hoists)

    @property
    def has_crabs(self) -> bool:
        """Whether a load stands on several lines."""
        return any(bool(getattr(load, "also_on", ())) for load in self.loads.values())

    @property
    def is_auto(self) -> bool:
        """Whether the number of links of a line is to be found."""
        return any(line is not None and isinstance(line.elements, Auto) for line in self.lines.values())

    @property
    def on_a_mesh(self) -> Parts:
        """The same with numbers of links that are taken as they are: the accuracy is not that of the steps there."""
        run = self.run
        if not self.is_auto or run is None or isinstance(run, Linear) or run.accuracy is None:
            return self
        return replace(self, run=run.model_copy(update={"accuracy": None}))

    def complete(self) -> Iterator[tuple[str, AnyLoad, str, Line]]:
        """List the loads that are themselves right and stand on a line that is, too: name, load, line's name, line."""
        for name, load in self.loads.items():
            line = self.lines.get(load.on) if load is not None else None
            if load is not None and line is not None:
                yield name, load, load.on, line


def _feels_air(load: AnyLoad | None) -> bool:
    """Whether the air drags at a load, its payload or its cabin."""
    parts = (load, getattr(load, "payload", None), getattr(load, "cabin", None))
    return any(getattr(part, "air_drag", 0.0) for part in parts)
