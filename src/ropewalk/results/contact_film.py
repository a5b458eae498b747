"""Pictures for the film of a run below an overhead line: a window that follows the first pantograph, and its force."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ropewalk.model.overlap import course_of
from ropewalk.results import style
from ropewalk.results.axis_units import show_units
from ropewalk.results.contact_statistics import (
    CUTOFF,
    contact_statistics,
    filtered,
    interval_of,
    line_statistics,
    pantographs,
    samples,
    scenario_of,
)
from ropewalk.results.display_units import DisplayUnits
from ropewalk.results.frame import Array
from ropewalk.results.meter import Meter

if TYPE_CHECKING:
    import xarray as xr

Image = NDArray[np.uint8]

WIDTH, HEIGHT = 960, 640  # pixels
AROUND = 60.0  # m, seen on each side of the first pantograph
APART = 0.2  # m, by which the masses of a pantograph are drawn below each other
HEAD = 0.8  # m, drawn half length of its head
_SUPPORT: dict[str, Any] = {"colors": [style.FAINT], "linewidths": 1.0, "linestyles": [(0, (2, 2))]}


class ContactStage:
    """The picture, laid out once; for each frame only what moves is drawn again. It has the interface of `Stage`.

    Three panels over the distance from the first pantograph: the line with its droppers and the masses of the
    pantographs, heights exaggerated; how much the wires have risen since the start; and the contact force so far.

    Args:
        dataset: a result with pantographs and samples.
        frames: those to show, by number.
        timing: the scale of time, in words.
        pixels: width and height, if they are given.
        units: that forces are shown in.
    """

    def __init__(
        self,
        dataset: xr.Dataset,
        frames: NDArray[np.intp],
        timing: str,
        pixels: tuple[int, int] | None = None,
        units: DisplayUnits | None = None,
    ) -> None:
        self._dataset, self._frames = dataset, frames
        self._time: Array = dataset["time"].values[frames]
        every = pantographs(dataset, scenario_of(dataset))
        loads = dataset["load"].values.tolist()
        self._contacts = list(every)
        self._names = [loads[k] for k in self._contacts]
        first = self._first_line(every[self._contacts[0]])
        scenario = scenario_of(dataset)
        known = scenario is not None and first in scenario.overhead_lines
        self._ahead = course_of(scenario.overhead_lines, first) if scenario is not None and known else {first: 0.0}
        self._wires = {f"{line}.{wire}": nodes for line in self._ahead for wire, nodes in self._nodes_of(line).items()}
        self._x0 = float(dataset["position"][0].values[self._wires[f"{first}.contact"][0], 0])
        self._rest: Array = dataset["position"][0].values[:, -1]
        self._set_ties()
        lines = line_statistics(dataset, ties=False)
        stations = (
            support.station + ahead
            for line, ahead in self._ahead.items()
            for support in (lines[line].supports.values() if line in lines else ())
        )
        self._supports = np.array(sorted(stations))
        self._bodies: Array = dataset["body_position"].values[frames][..., [0, -1]]
        bodies = dataset["body"].values.tolist()
        self._own = [[i for i, b in enumerate(bodies) if b.rpartition(".")[0] == name] for name in self._names]
        self._set_forces()
        last = np.clip(np.searchsorted(self._instant, self._time + 1e-9, side="right") - 1, 0, None)
        xi = dataset["contact_xi"].values[frames][:, self._contacts]
        self._stations = self._filled(np.where(np.isfinite(xi), xi, self._along[last]))
        self._meter = Meter(self._names, self._force[last], units)
        self._set_up(
            pixels or (WIDTH, HEIGHT), units or DisplayUnits.read(None), str(dataset.attrs.get("title", "")), timing
        )

    def __len__(self) -> int:
        return len(self._frames)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        width, height = self._canvas.get_width_height()
        return width, height

    def picture(self, k: int) -> Image:
        """Draw the k-th frame shown, an array (height, width, 3)."""
        self._canvas.restore_region(self._ground)
        self._move(k)
        for axes, artist in self._artists:
            axes.draw_artist(artist)
        return np.asarray(self._canvas.buffer_rgba())[:, :, :3].copy()

    def _first_line(self, pantograph: Any) -> str:
        """Name of the line above the first pantograph."""
        if pantograph is not None:
            return str(pantograph.on)
        contact = (w for w in self._dataset["line"].values.tolist() if w.endswith(".contact"))
        return str(next(contact)).removesuffix(".contact")

    def _nodes_of(self, line: str) -> dict[str, NDArray[np.intp]]:
        """Nodes of the wires of a line."""
        names = self._dataset["line"].values
        wires = dict.fromkeys(n for n in names.tolist() if n.startswith(f"{line}."))
        return {wire.removeprefix(f"{line}."): np.flatnonzero(names == wire) for wire in wires}

    def _set_ties(self) -> None:
        """Droppers of the lines: their number, station, and the wires that each hangs from and holds."""
        ties = self._dataset["tie"].values.tolist() if "tie" in self._dataset.coords else []
        kept = {k: line for k, name in enumerate(ties) if ".arm." not in name
                if (line := name.partition(".")[0]) in self._ahead}  # fmt: skip
        self._ties = np.array(list(kept), dtype=np.intp)
        station = self._dataset["tie_station"].values[self._ties] if kept else np.zeros(0)
        self._tie_station = station + np.array([self._ahead[line] for line in kept.values()])
        x = self._dataset["position"][0].values[:, 0] - self._x0
        self._of = np.array([f"{line}.contact" for line in kept.values()], dtype=object)
        self._from = np.array([f"{line}.messenger" for line in kept.values()], dtype=object)
        for name, nodes in self._wires.items():
            if (line := name.partition(".stitch.")[0]) != name:
                inside = (self._tie_station >= x[nodes[0]]) & (self._tie_station <= x[nodes[-1]])
                self._from[inside & (self._of == f"{line}.contact")] = name

    def _filled(self, station: Array) -> Array:
        """Stations, the last known one after a pantograph has left."""
        out = station.copy()
        for i in range(1, len(out)):
            out[i] = np.where(np.isfinite(out[i]), out[i], out[i - 1])
        return out

    def _set_forces(self) -> None:
        flat = samples(self._dataset.drop_vars("sampled_tie_force", errors="ignore")).isel(contact=self._contacts)
        self._instant: Array = flat["time"].values
        self._along: Array = flat["station"].values
        self._raw: Array = np.where(np.isfinite(self._along), flat["force"].values, np.nan)
        self._force = np.stack([filtered(raw, interval_of(flat)) for raw in self._raw.T], axis=1)
        seen = self._raw[np.isfinite(self._raw)]
        self._largest = float(np.percentile(seen, 99.5)) if seen.size else 1.0

    def _set_up(self, pixels: tuple[int, int], units: DisplayUnits, title: str, timing: str) -> None:
        self._figure = Figure(figsize=(pixels[0] / 100, pixels[1] / 100), dpi=100, layout="constrained")
        self._canvas = _canvas(self._figure)
        line, rise, force = self._figure.subplots(3, 1, height_ratios=(1.7, 0.8, 1.0), sharex=True)
        for panel in (line, rise):
            panel.tick_params(labelbottom=False)
        line.set_xlim(-AROUND, AROUND)
        force.set_ylim(-0.03 * self._largest, 1.25 * self._largest)
        low, high = self._risen()
        rise.set_ylim(low - 5e-3, high + 5e-3)
        style.dress(line, title, "", "z (m)")
        line.set_title(timing, loc="right", fontsize=style.NOTE, color=style.FAINT)
        style.dress(rise, "", "", "rise (m)")
        style.dress(force, "", "distance from the pantograph (m)", "force (N)")
        self._artists: list[tuple[Any, Any]] = []
        posts = [self._add(panel, LineCollection([], **_SUPPORT)) for panel in (line, rise, force)]
        self._posts = list(zip(posts, (line, rise, force), strict=True))
        touched = [w for w in self._wires if w.endswith(".contact")]
        self._curves = {w: self._curve(line, style.INK, 1.8 if w in touched else 1.2) for w in self._wires}
        above = [w for w in self._wires if w.endswith(".messenger")]
        self._rises = {w: self._curve(rise, style.FAINT, 0.9) for w in above}
        self._rises |= {w: self._curve(rise, style.INK, 1.8) for w in touched}
        self._droppers = self._add(line, LineCollection([], linewidths=style.sized(1.2)))
        self._pantographs = []
        for i in range(len(self._contacts)):
            colour = style.CYCLE[i % len(style.CYCLE)]
            raw = self._curve(force, colour, 0.6)
            raw.set_alpha(0.45)
            body = self._curve(line, colour, 1.6)
            body.set(marker="s", markersize=style.sized(6))
            self._pantographs.append((self._curve(line, colour, 4.0), body, raw, self._curve(force, colour, 1.8)))
        note: dict[str, Any] = {"fontsize": style.LABEL, "color": style.INK, "family": "monospace", "animated": True}
        note["bbox"] = {"boxstyle": "square,pad=0.15", "facecolor": "white", "edgecolor": "none"}
        corner: dict[str, Any] = {"ha": "right", "va": "top"}
        self._clock = line.text(0.99, 0.97, "", transform=line.transAxes, **corner, **note)
        self._reading = force.text(0.99, 0.97, "", transform=force.transAxes, **corner, **note)
        self._artists += [(line, self._clock), (force, self._reading)]
        own = style.BLUE
        _legend(
            line, (("dropper", style.GREEN, 1.2), ("slack", style.RED, 1.2), ("pantograph, its masses apart", own, 4))
        )
        _legend(rise, (("contact wire", style.INK, 1.8), ("messenger", style.FAINT, 0.9)))
        _legend(force, (("as computed", own, 0.6), (f"up to {CUTOFF:g} Hz", own, 1.8)))
        show_units(self._figure, units)
        self._figure.align_ylabels([line, rise, force])
        self._canvas.draw()  # the layout is settled here, and the ground that all pictures share
        self._figure.set_layout_engine("none")
        self._exaggerate(line)
        self._canvas.draw()
        self._ground = self._canvas.copy_from_bbox(self._figure.bbox)

    def _add(self, panel: Any, artist: Any) -> Any:
        artist.set_animated(True)
        panel.add_collection(artist, autolim=False)
        self._artists.append((panel, artist))
        return artist

    def _curve(self, panel: Any, colour: str, width: float) -> Any:
        (curve,) = panel.plot([], [], color=colour, linewidth=width, animated=True)
        self._artists.append((panel, curve))
        return curve

    def _exaggerate(self, panel: Any) -> None:
        """Draw heights a round number of times as high as lengths, so that all fits, and say so."""
        most = max((len(own) for own in self._own), default=1)
        own = np.concatenate([self._wires[w] for w in self._wires])
        low, high = float(self._rest[own].min()) - APART * (most - 0.5), float(self._rest[own].max())
        box = panel.get_window_extent()
        per_metre = box.width / (2.0 * AROUND)
        fits = box.height / (1.15 * (high - low) * per_metre)
        factor = 0.5 * style.nice(fits) * int(fits / (0.5 * style.nice(fits)))
        middle, half = 0.5 * (low + high), 0.5 * box.height / (factor * per_metre)
        panel.set_ylim(middle - 0.9 * half, middle + 1.1 * half)  # room for the legend
        panel.set_ylabel(f"z (m), drawn {factor:g} times as high", fontsize=style.LABEL, color=style.INK)

    def _risen(self) -> tuple[float, float]:
        """Least and largest rise of the contact wire in view, m, of some of the frames."""
        nodes = np.concatenate([nodes for w, nodes in self._wires.items() if w.endswith(".contact")])
        low, high = 0.0, 0.01
        for k in style.thinned(len(self), 40):
            z = self._dataset["position"][int(self._frames[k])].values
            near = np.abs(z[nodes, 0] - self._x0 - self._stations[k, 0]) < AROUND
            if near.any():
                rise = (z[nodes, -1] - self._rest[nodes])[near]
                low, high = min(low, float(rise.min())), max(high, float(rise.max()))
        return low, high

    def _move(self, k: int) -> None:
        frame = int(self._frames[k])
        here = float(np.nan_to_num(self._stations[k, 0]))
        position = self._dataset["position"][frame].values
        x, z = position[:, 0] - self._x0 - here, position[:, -1]
        for wire, curve in self._curves.items():
            nodes = self._wires[wire]
            nodes = nodes[np.abs(x[nodes]) < 1.1 * AROUND]
            curve.set_data(x[nodes], z[nodes])
            if wire in self._rises:
                self._rises[wire].set_data(x[nodes], (z - self._rest)[nodes])
        self._hang(frame, here, x, z)
        near = self._supports[np.abs(self._supports - here) < AROUND] - here
        for post, panel in self._posts:
            post.set_segments([[(s, panel.get_ylim()[0]), (s, panel.get_ylim()[1])] for s in near])
        for i, (head, body, raw, force) in enumerate(self._pantographs):
            own = self._own[i]
            there = self._bodies[k, own]
            drawn = there[:, 1] - APART * np.arange(len(own))[::-1]
            body.set_data(there[:, 0] - self._x0 - here, drawn)
            if len(own):
                middle = there[-1, 0] - self._x0 - here
                head.set_data([middle - HEAD, middle + HEAD], [drawn[-1]] * 2)
            seen = (self._instant <= self._time[k] + 1e-9) & (np.abs(self._along[:, i] - here) < AROUND)
            raw.set_data(self._along[seen, i] - here, self._raw[seen, i])
            force.set_data(self._along[seen, i] - here, self._force[seen, i])
        self._clock.set_text(f"time {self._time[k]:.2f} s   at {here:6.1f} m")
        self._reading.set_text(self._meter.label(k))

    def _hang(self, frame: int, here: float, x: Array, z: Array) -> None:
        """Droppers in view, slack ones in another colour."""
        near = np.abs(self._tie_station - here) < AROUND
        pull = self._dataset["tie_force"][frame].values[self._ties[near]] if near.any() else np.zeros(0)
        at, high = self._tie_station[near] - here, np.full(int(near.sum()), np.nan)
        low = high.copy()
        for end, wires in ((low, self._of[near]), (high, self._from[near])):
            for wire in dict.fromkeys(wires.tolist()):
                chosen, nodes = wires == wire, self._wires[wire]
                end[chosen] = np.interp(at[chosen], x[nodes], z[nodes])
        ends = np.stack([np.stack([at, low], axis=1), np.stack([at, high], axis=1)], axis=1)
        self._droppers.set_segments(list(ends))
        self._droppers.set_color([style.RED if force <= 0.0 else style.GREEN for force in pull])


def _legend(panel: Any, entries: tuple[tuple[str, str, float], ...]) -> None:
    handles = [panel.plot([], [], color=colour, linewidth=width, label=name)[0] for name, colour, width in entries]
    panel.legend(handles=handles, fontsize=style.NOTE, frameon=False, loc="upper left", ncols=len(entries))


def _canvas(figure: Figure) -> Any:
    return FigureCanvasAgg(figure)  # its methods carry no types


def is_filmed_here(dataset: xr.Dataset) -> bool:
    """Whether a result has pantographs below an overhead line, and samples."""
    return bool(contact_statistics(dataset))
