"""Tracks: rails on pads, sleepers and ballast, over bridges and on the ground before and behind them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from pydantic import Field

from ropewalk.errors import did_you_mean
from ropewalk.model._base import Declaration, Finding
from ropewalk.model.line import Line, spatial
from ropewalk.model.missing import missing
from ropewalk.model.quantity import Mass, Offset, PositiveLength, PositiveMass, PositiveStiffness, Viscosity

_SAME = 1e-9  # of a length
_MOST = 10_000  # sleepers


class Pads(Declaration):
    """Rail pads: a spring with a damper between the rail and each sleeper."""

    stiffness: PositiveStiffness = Field(default=65e6, description="vertical, of both rails of a sleeper together")
    damping: Viscosity = Field(default=75e3, description="of the damper parallel to it")


class Sleepers(Declaration):
    """Sleepers: masses at equal distances under the rail."""

    mass: PositiveMass = Field(default=251.0, description="of each")
    spacing: PositiveLength = Field(default=0.6, description="distance of neighbours along the rail")
    first: Offset = Field(default=0.0, description="unstrained length from the start of the rail to the first one")


class Ballast(Declaration):
    """Ballast under each sleeper: a spring with a damper, and a mass below it.

    On the ground the mass stands on the subgrade; on a bridge it moves with the bridge.
    """

    mass: Mass = Field(default=531.4, description="vibrating mass below each sleeper")
    stiffness: PositiveStiffness = Field(default=137.75e6, description="vertical, of each sleeper")
    damping: Viscosity = Field(default=58.8e3, description="of the damper parallel to it")


class Subgrade(Declaration):
    """The ground below the ballast of each sleeper: a spring with a damper."""

    stiffness: PositiveStiffness = Field(default=77.5e6, description="vertical, of each sleeper")
    damping: Viscosity = Field(default=31.15e3, description="of the damper parallel to it")


class Track(Declaration):
    """A track: a rail on pads, sleepers and ballast, over bridges, and on the ground where no bridge is below.

    All springs bear pressure and tension. At rest without loads the track is levelled: its rail lies as it is drawn, in
    whatever way bridges bend under their own weight and that of the track. Loads run on the rail. Data that are left
    out are those of Zhai, Wang and Lin (2004), as TTB-2D has them for a track of two rails.
    """

    rail: str = Field(description="name of the line that is the rail, or both rails together")
    over: tuple[str, ...] = Field(default=(), description="names of the lines that are bridges")
    pads: Pads = Field(default=Pads.as_written(), description="between rail and sleepers")
    sleepers: Sleepers = Field(default=Sleepers.as_written(), description="their mass, and where they are")
    ballast: Ballast = Field(default=Ballast.as_written(), description="below sleepers on the ground")
    on_bridge: Ballast | None = Field(
        default=None,
        description="below sleepers on bridges (default: as on the ground); without ballast: their pads, mass 0",
    )
    subgrade: Subgrade = Field(default=Subgrade.as_written(), description="below the ballast on the ground")

    def places(self, length: float) -> list[float]:
        """Where sleepers are on a rail of an unstrained length in m, from its start, m."""
        first, spacing = self.sleepers.first, self.sleepers.spacing
        count = int((length - first) / spacing * (1.0 + _SAME) + _SAME) + 1
        return [min(first + i * spacing, length) for i in range(count)]

    def under(self, rail: Line, place: float, length: float, lines: Mapping[str, Line]) -> BridgePoint | None:
        """What bears the ballast of a sleeper.

        Args:
            rail: of this track.
            place: of the sleeper, m from the start of the rail.
            length: of the rail, m.
            lines: of the scenario.

        Returns:
            The bridge; None: the ground.
        """
        x = level(rail, place / length)
        for name in self.over:
            start, end = lines[name].start[0], lines[name].end[0]
            part = (x - start) / (end - start)
            if -_SAME <= part <= 1.0 + _SAME:
                return BridgePoint(name, min(max(part, 0.0), 1.0))
        return None


class BridgePoint(NamedTuple):
    """A point of a bridge."""

    line: str
    part: float  # of its length, from its start


def level(line: Line, part: float) -> float:
    """Where a part of the way from the start of a line to its end is along x, m."""
    return float(line.start[0] + part * (line.end[0] - line.start[0]))


def check_tracks(parts: Any) -> Iterator[Finding]:
    """Find tracks whose rails and bridges are not there, or do not fit together."""
    taken: dict[str, str] = {}
    for name, track in parts.tracks.items():
        if track is None:
            continue
        path, wrong = ("tracks", name), False
        named = [(("rail",), track.rail), *((("over", i), line) for i, line in enumerate(track.over))]
        for key, line in named:
            if line not in parts.lines:
                remedy = did_you_mean(line, [*parts.lines], otherwise=f"lines here: {', '.join(parts.lines)}")
                yield Finding((*path, *key), "no such line", repr(line), remedy)
                wrong = True
        for i, line in enumerate(track.over):
            if line == track.rail or line in track.over[:i]:
                what = "is the rail" if line == track.rail else "is named twice"
                yield Finding((*path, "over", i), what, repr(line), "name the bridges below the rail, each once")
                wrong = True
        if track.rail in taken:
            remedy = "give each track a rail of its own"
            yield Finding((*path, "rail"), f"is the rail of track {taken[track.rail]}", repr(track.rail), remedy)
            wrong = True
        taken.setdefault(track.rail, name)
        if not wrong and None not in [parts.lines[line] for _, line in named]:
            findings = list(_lines(path, track, parts.lines))
            yield from findings
            if not findings:
                yield from _sleepers(path, track, parts.lines)


def _lines(path: tuple[str, ...], track: Track, lines: Mapping[str, Line]) -> Iterator[Finding]:
    """Rails and bridges that no sleepers can be put between."""
    rail = lines[track.rail]
    if not rail.bending_stiffness:
        remedy = f"give lines.{track.rail} a bending_stiffness"
        yield Finding((*path, "rail"), "must have bending stiffness between sleepers", repr(track.rail), remedy)
    for key, name in ((("rail",), track.rail), *((("over", i), one) for i, one in enumerate(track.over))):
        line, feature, remedy = lines[name], "", "name a line between two supports"
        if line.sheaves or line.saddles or (line.is_joined and key == ("rail",)):
            feature = "a joined line, or one over sheaves or saddles,"
        elif line.tension is not None and key == ("rail",):
            feature, remedy = "a rail that is given by its tension", f"give lines.{name} a length"
        elif spatial(line.start)[1] or spatial(line.end)[1]:
            feature, remedy = "a line outside the x-z plane", f"write start and end of lines.{name} as [x, z]"
        elif abs(line.end[0] - line.start[0]) <= _SAME * line.distance:
            feature, remedy = "a vertical line", "name a line that extends along x"
        if feature:
            yield missing((*path, *key), "tracks", repr(name), remedy, feature=feature)


def _sleepers(path: tuple[str, ...], track: Track, lines: Mapping[str, Line]) -> Iterator[Finding]:
    """Rows of sleepers that are not on their rail, are too many, or of which none is on a bridge."""
    rail = lines[track.rail]
    assert rail.length is not None
    if track.sleepers.first > rail.length * (1.0 + _SAME):
        given, remedy = f"{track.sleepers.first:g} m", f"stay within its {rail.length:g} m"
        yield Finding((*path, "sleepers", "first"), f"is beyond the end of {track.rail}", given, remedy)
        return
    if (count := (rail.length - track.sleepers.first) / track.sleepers.spacing) > _MOST:
        given, remedy = f"{track.sleepers.spacing:g} m", f"write more than {rail.length / _MOST:.3g} m"
        yield Finding((*path, "sleepers", "spacing"), f"makes {count:.4g} sleepers, of {_MOST} at most", given, remedy)
        return
    on = [track.under(rail, place, rail.length, lines) for place in track.places(rail.length)]
    if None in on and not track.ballast.mass:
        remedy, feature = "give it a mass, or bridges below all of the rail", "ballast on the ground that has no mass"
        yield missing((*path, "ballast", "mass"), "tracks", "0 kg", remedy, feature=feature)
    for i, name in enumerate(track.over):
        if not any(spot is not None and spot.line == name for spot in on):
            wrong, remedy = "bears none of the sleepers", f"let {track.rail} run over it, or leave it out"
            yield Finding((*path, "over", i), wrong, repr(name), remedy)
