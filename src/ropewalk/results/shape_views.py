"""Side views and plans: lines at some instants, with the paths of loads and of what hangs below them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.markers import CARETUP
from mpl_toolkits.mplot3d.art3d import Line3DCollection
from numpy.typing import NDArray

from ropewalk.results import style
from ropewalk.results.contract import path_name
from ropewalk.results.declared import hanging_bodies, tied, ties
from ropewalk.results.display_units import number
from ropewalk.results.frame import Array
from ropewalk.results.nets import NetTriangles, in_space, line_ends, most_deflected, net_names, triangles
from ropewalk.results.picture import drawn_position
from ropewalk.results.statistics import lines

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

SHAPES = 7  # instants drawn
CROWD = 6  # more lines than these are drawn at one instant in space
POINTS = 2000  # most points drawn of one curve
CELLS = 12_000  # most triangles drawn in a still
FLATTEST, SLIMMEST = 0.14, 0.05  # flatter side views and slimmer plans (to their length) are drawn exaggerated
_SIDE: dict[str, Any] = {"fraction": 0.03, "pad": 0.01, "aspect": 25}


@dataclass(frozen=True)
class Chosen:
    """The instants that are drawn: several of a few lines, that of the largest displacement of nets and many lines."""

    frames: NDArray[np.intp]
    most: int  # frame of the largest displacement
    position: Array  # (frame, node, 3) m
    contacts: Array  # (frame of the result, contact, 3) m
    bodies: Array  # (frame of the result, body, 3) m

    @classmethod
    def of(cls, dataset: xr.Dataset, instants: int = SHAPES, crowd: float = CROWD) -> Chosen:
        """Choose and load them."""
        name, most = path_name(dataset), most_deflected(dataset)
        one = bool(net_names(dataset)) or len(lines(dataset)) > crowd
        several = np.union1d(style.thinned(dataset.sizes[name], instants - 1), [most])
        frames = np.array([most]) if one else several
        loads = dataset["contact_position"].values, hanging_bodies(dataset)
        return cls(frames, most, *map(in_space, (drawn_position(dataset.isel({name: frames})), *loads)))

    @property
    def points(self) -> Array:
        """All places that must be in view, (point, 3) m."""
        return np.concatenate([part.reshape(-1, 3) for part in (self.position, self.contacts, self.bodies)])

    @property
    def colours(self) -> Any:
        """A colour for each instant, early to late; one alone is dark."""
        if len(self.frames) == 1:
            return [style.INK]
        return style.colours(style.INSTANTS)(np.linspace(0.0, 1.0, len(self.frames)))


def paths(dataset: xr.Dataset, chosen: Chosen) -> list[tuple[str, Array, dict[str, Any]]]:
    """Return label, places (frame, 3) m and look of the paths of bodies and loads."""
    dashed: dict[str, Any] = {"linewidth": style.THIN, "linestyle": (0, (4, 1.5)), "color": style.FAINT, "zorder": 1}
    dotted: dict[str, Any] = {"linewidth": style.LINE, "linestyle": (0, (1, 1.2)), "zorder": 4}
    bodies, loads = dataset["body"].values.tolist(), dataset["load"].values.tolist()
    found = [(f"path of {body}", chosen.bodies[:, i], dashed) for i, body in enumerate(bodies)]
    found += [(f"path of {load}", chosen.contacts[:, k], {**dotted, "color": load_colour(dataset, k)})
              for k, load in enumerate(loads)]  # fmt: skip
    return [entry for entry in found if np.isfinite(entry[1]).all(axis=-1).any()]


def shapes(dataset: xr.Dataset, ax: Axes, instants: int = SHAPES) -> None:
    """Draw side views of the lines at several instants (early to late) with the paths of the loads and their bodies.

    Lengths and heights have one scale, unless the shape is so flat that nothing could be seen: then the heights
    are exaggerated by a round number, which the label states.
    """
    chosen, name = Chosen.of(dataset, instants, np.inf), path_name(dataset)
    factor = _draw(dataset, ax, chosen, 2, FLATTEST)
    values, unit = dataset[name].values, dataset[name].attrs["units"]
    if len(chosen.frames) > 2:
        label = f"largest displacement, at {word(dataset)} {number(float(values[chosen.most]))} {unit}"
        colour = chosen.colours[chosen.frames == chosen.most][0]
        ax.plot([], [], color=colour, linewidth=1.6 * style.LINE, label=label)
    style.dress(ax, "Shapes", "x (m)", "z (m)" if factor == 1.0 else f"z (m), drawn {factor:g} times as high")
    if len(chosen.frames) > 1:
        instants_bar(ax, values[chosen.frames], f"{word(dataset)} ({unit})")
    style.legend(ax)


def plan(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the same from above: nets shaded by height; widths are exaggerated if all is too slim, as the label says."""
    chosen = Chosen.of(dataset)
    if net_names(dataset):
        place = chosen.position[0]
        mesh = NetTriangles(triangles(dataset), place, CELLS)
        height = place[mesh.cells, 2].mean(axis=1)
        shade = shading(height, style.HEIGHT)
        options: dict[str, Any] = {"facecolors": height, "cmap": shade.cmap, "norm": shade.norm}
        ax.tripcolor(place[:, 0], place[:, 1], mesh.cells, **options, edgecolors="face", linewidth=0.6, zorder=1)
        bar(ax, shade, "z (m)")
        add_strokes(ax, place[mesh.edges][..., :2], colors=style.INK, linewidths=style.THIN, zorder=2)
    factor = _draw(dataset, ax, chosen, 1, SLIMMEST)
    style.dress(ax, "Plan", "x (m)", "y (m)")
    style.remark(ax, "true to scale" if factor == 1.0 else f"drawn {factor:g} times as wide")


def _draw(dataset: xr.Dataset, ax: Axes, chosen: Chosen, up: int, flattest: float) -> float:
    """Draw lines, supports, loads and bodies over x and y (`up` 1) or z (2), and return the exaggeration."""
    seen = [0, up]
    draw_lines(dataset, ax, chosen, seen)
    flat = draw_loads(dataset, ax, ax, chosen, seen)
    return set_scale(ax, chosen.position[..., seen], flat, flattest=flattest)


def draw_lines(dataset: xr.Dataset, ax: Any, chosen: Chosen, seen: list[int], shade: Any = None) -> None:
    """Draw lines at every instant, and their supports.

    Args:
        dataset: a result.
        ax: axes, in three dimensions if `seen` has three entries.
        chosen: instants and places.
        seen: the axes of the result that are seen, 0 for x.
        shade: colours of the tension at the only instant, instead of one for each instant.
    """
    ends, name = list[int](), path_name(dataset)
    for line in lines(dataset):
        nodes = np.flatnonzero(dataset["line"].values == line)
        kept = style.thinned(len(nodes), POINTS)
        for frame, place, colour in zip(chosen.frames, chosen.position[:, nodes[kept]], chosen.colours, strict=False):
            if shade is not None:
                links = np.flatnonzero(dataset["link_line"].values == line)[kept[:-1]]
                options: dict[str, Any] = {"linewidths": style.sized(2.5), "capstyle": "round", "zorder": 3}
                options["colors"] = shade.to_rgba(dataset["tension"][int(frame)].values[links])
                add_strokes(ax, np.stack((place[:-1, seen], place[1:, seen]), axis=1), **options)
                continue
            when = f"{word(dataset)} {number(float(dataset[name].values[frame]))} {dataset[name].attrs['units']}"
            width = style.LINE * (1.6 if frame == chosen.most and len(chosen.frames) > 2 else 1.0)
            ax.plot(*place[:, seen].T, color=colour, linewidth=width, label=f"_{line} at {when}", zorder=3)
        ends += line_ends(dataset, line).tolist()
    if ends:
        foot: dict[str, Any] = {"color": style.INK, "linestyle": "none", "zorder": 4, "clip_on": False}
        foot |= {"marker": CARETUP if 2 in seen else "s", "markersize": style.sized(8 if 2 in seen else 4)}
        ax.plot(*chosen.position[0][np.ix_(ends, seen)].T, **foot)


def draw_loads(dataset: xr.Dataset, ax: Any, panel: Axes, chosen: Chosen, seen: list[int]) -> list[Array]:
    """Draw loads, bodies and their ties at the instants, and return their paths, with labels on a panel."""
    found = paths(dataset, chosen) if len(chosen.contacts) > 1 or panel is ax else []
    for label, path, look in found:
        ax.plot(*path[:, seen].T, label=label, **look)
        if panel is not ax:
            panel.plot([], [], label=label, **look)
    for frame, colour in zip(chosen.frames, chosen.colours, strict=False):
        contacts, bodies = chosen.contacts[frame][:, seen], chosen.bodies[frame][:, seen]
        parts = tied(bodies, contacts, ties(dataset))
        if len(parts):
            add_strokes(ax, parts, colors=[colour], linewidths=style.THIN, zorder=5)
        dot: dict[str, Any] = {"linestyle": "none", "color": colour, "markeredgecolor": "white", "zorder": 8}
        for places, marker in ((contacts, "o"), (bodies, "s")):
            ax.plot(*places.T, marker=marker, markersize=style.sized(6), markeredgewidth=0.7, **dot)
    return [path[:, seen] for _, path, _ in found]


def add_strokes(ax: Any, strokes: Array, **options: Any) -> None:
    """Draw strokes (stroke, point, axis) m on axes in two or three dimensions."""
    if ax.name == "3d":
        ax.add_collection3d(Line3DCollection(strokes, **options))
    else:
        ax.add_collection(LineCollection(list(strokes), **options), autolim=False)


def set_scale(ax: Axes, position: Array, curves: list[Array], space: float = 0.08, flattest: float = FLATTEST) -> float:
    """Give both axes one scale, or exaggerate the second by a round number if all is too flat.

    Args:
        ax: axes to set.
        position: positions (frame, node, 2) in m that must be in view.
        curves: further curves (frame, 2) in m.
        space: free height above and below, in heights of the picture.
        flattest: least height to width that is left as it is.

    Returns:
        The exaggeration, 1 for a true picture.
    """
    points = np.concatenate([position.reshape(-1, 2), *curves])
    points = points[np.isfinite(points).all(axis=1)]
    width, height = np.ptp(points[:, 0]), np.ptp(points[:, 1])
    flat = height < flattest * width
    factor = style.nice(2 * flattest * width / height) if flat and height > 1e-9 * width else 1.0
    ax.update_datalim(points)
    ax.margins(0.03, space)
    ax.autoscale_view()
    ax.set_aspect(max(factor, 1.0), adjustable="datalim")
    return max(factor, 1.0)


def word(dataset: xr.Dataset) -> str:
    """Return the name of the leading dimension."""
    return path_name(dataset).replace("_", " ")


def colour_of(k: int) -> str:
    """Return the colour of the k-th of several things."""
    return style.CYCLE[(k + 1) % len(style.CYCLE)]


def load_colour(dataset: xr.Dataset, k: int) -> str:
    """Return the colour of the path of a load: that of loads where it is alone."""
    return style.LOAD if dataset.sizes["contact"] == 1 else colour_of(k)


def instants_bar(ax: Axes, values: Array, label: str) -> None:
    """Draw a bar that tells the colours of the instants."""
    bar(ax, ScalarMappable(Normalize(float(values[0]), float(values[-1])), style.colours(style.INSTANTS)), label)


def shading(values: Array, name: str) -> ScalarMappable:
    """Return colours for values (NaN is light grey), without rare spikes; the bar says where there is more."""
    low, high, beyond = style.colour_range(values)
    colours: Any = style.colours(name).with_extremes(bad="#DDDDDD")
    colours.colorbar_extend = beyond
    return ScalarMappable(Normalize(low, high), colours)


def bar(panel: Axes, shade: ScalarMappable, label: str) -> Axes:
    """Draw a bar next to a panel that tells the colours, and return its axes."""
    text = panel.figure.colorbar(shade, ax=panel, **_SIDE)
    text.set_label(label, fontsize=style.LABEL, color=style.INK)
    text.ax.tick_params(labelsize=style.TICK, colors=style.INK, width=0.6, length=3)
    text.outline.set_visible(False)
    return text.ax
