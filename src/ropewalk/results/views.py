"""Views: single panels of a result on given axes, drawn without pyplot's global state."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results import style
from ropewalk.results.audit import AUDIT, rounding, turnover
from ropewalk.results.contact_statistics import scenario_of
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import number
from ropewalk.results.frame import ENERGY_FORMS, Array
from ropewalk.results.nets import net_names
from ropewalk.results.shape_views import POINTS, SHAPES, colour_of, instants_bar, shapes, word
from ropewalk.results.statistics import blocks, lines
from ropewalk.results.strength import strengths
from ropewalk.results.table import ENERGY_LABELS, LARGEST, percent
from ropewalk.results.trains import grouped_contacts

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CURVES = 7  # more than these make a view unreadable
SEEN = 0.005  # of the largest value in a panel: what is no larger cannot be told from zero
REACH = 2.0  # times the largest value: limits beyond this are named only
LIMIT: Any = {"color": style.RED, "linewidth": 1.2, "linestyle": (0, (6, 2)), "zorder": 1}  # look of a limit
Curve = tuple[str, Array, dict[str, Any]]  # label, values (instant,), look


def tension(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the largest tension, the tensions at the ends of the lines, behind and ahead of the loads, and strengths."""
    curves, names = list[Curve](), lines(dataset)
    if dataset.sizes["link"]:
        largest = np.concatenate([_row_max(block["tension"].values) for block in blocks(dataset)])
        curves.append(("largest", largest, {"color": style.INK}))
    if len(names) > LARGEST:  # more lines than these make the view unreadable
        curves += _most_pulled(dataset, names)
    for line in names if len(names) <= LARGEST else ():
        here = np.flatnonzero(dataset["link_line"].values == line)
        for index, end, colour in ((0, "start", style.BLUE), (-1, "end", style.SKY)):
            label = f"{end} of {line}" if len(names) > 1 else f"at the {end}"
            values = dataset["tension"].isel(link=here[index]).values
            curves.append((label, values, {"color": colour, "linewidth": style.THIN}))
    near = _near_loads(dataset)
    if len(curves) + len(near) > CURVES:
        band(dataset, ax, [values for _, values, _ in near], "next to the loads, least to largest")
        near = []
    draw_curves(dataset, ax, curves + near)
    _draw_strengths(dataset, ax)
    style.dress(ax, "Tension", path_label(dataset), "tension (N)")
    style.legend(ax)


def _near_loads(dataset: xr.Dataset) -> list[Curve]:
    """Return the tensions behind and ahead of the loads; those on nets have no two sides."""
    out, alone, groups = list[Curve](), dataset.sizes["contact"] == 1, grouped_contacts(dataset)
    for k, load in enumerate(dataset["load"].values.tolist()):
        for index, side, own, dashes in ((0, "behind", style.RED, "-"), (1, "ahead of", style.ORANGE, "--")):
            values = dataset["contact_tension"][:, k, index].values
            if k not in groups and np.isfinite(values).any():
                # several loads have a colour each, and each side its dashes
                out.append((f"{side} {load}", values, {"color": own if alone else colour_of(k), "linestyle": dashes}))
    return out


def _draw_strengths(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the strengths of lines that are in reach of the tensions, and name the others."""
    scenario, (low, high) = scenario_of(dataset), ax.get_ylim()
    found = strengths(scenario) if scenario is not None else {}
    for name, strength in found.items():
        if strength < REACH * high:
            ax.axhline(strength, **LIMIT, label=f"strength of {name}")
            high = max(high, 1.05 * strength)
    far = [f"strength of {name} {value / 1e3:.4g} kN" for name, value in found.items() if value >= REACH * high]
    if len(far) == 1:
        style.remark(ax, far[0])
    ax.set_ylim(low, high)


def _most_pulled(dataset: xr.Dataset, names: list[str]) -> list[Curve]:
    """Return the largest tension in each of the lines that are pulled most."""
    owner = np.array([names.index(line) for line in dataset["link_line"].values.tolist()])
    largest = np.full((dataset.sizes[path_name(dataset)], len(names)), -np.inf)
    for k in range(len(names)):
        largest[:, k] = _row_max(dataset["tension"].isel(link=np.flatnonzero(owner == k)).values)
    most = np.argsort(-np.nan_to_num(largest).max(axis=0), kind="stable")[:LARGEST]
    looks = ({"color": colour, "linewidth": style.THIN} for colour in (style.BLUE, style.SKY, style.GREEN))
    return [(f"largest in {names[k]}", largest[:, k], look) for look, k in zip(looks, most, strict=False)]


def net_tension(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the largest and the smallest tension per width of every net."""
    path = dataset[path_name(dataset)].values
    for k, net in enumerate(net_names(dataset)):
        here = np.flatnonzero(dataset["cell_net"].values == net)
        segments = [
            block["cell_tension"].isel(cell=here).values.reshape(-1, 2 * len(here)) for block in blocks(dataset)
        ]
        extremes = [("largest", np.fmax, "-"), ("smallest", np.fmin, (0, (4, 1.5)))]
        for name, pick, dashes in extremes:
            values = np.concatenate([pick.reduce(piece, axis=1) for piece in segments])
            ax.plot(path, values, color=colour_of(k), linestyle=dashes, linewidth=style.LINE, label=f"{name}, {net}")
    style.dress(ax, "Tension of the net", path_label(dataset), "per width (N/m)")
    style.legend(ax)


_OF_LOADS = {
    "contact_height": ("Height of the load", "z (m)"),
    "contact_sideways": ("Place of the load sideways", "y (m)"),
    "contact_force": ("Contact force on the line", "force (N)"),
    "hold_force": ("Hold force on the line", "force (N)"),
    "contact_speed": ("Speed of the load", "speed (m/s)"),
    "friction_power": ("Power lost to friction", "power (W)"),
}


def _loads(dataset: xr.Dataset, ax: Axes, *, view: str) -> None:
    """Draw a quantity of every load, and of its bodies, over the path; forces by component."""
    title, label = _OF_LOADS[view]
    if label[0] in "yz":
        _places(dataset, ax, label[0])
    elif label == "force (N)":
        _components(dataset, ax, dataset[view], dataset["load"].values.tolist())
    else:
        _of_contacts(dataset, ax, view)
    style.dress(ax, title, path_label(dataset), label)
    finish_loads(dataset, ax)


def _places(dataset: xr.Dataset, ax: Axes, axis: str) -> None:
    """Draw a coordinate of contacts and bodies, if there is such an axis."""
    if axis not in dataset["axis"].values:
        return
    curves, groups = list[Curve](), grouped_contacts(dataset)
    for kind, name, dashes in (("contact", "load", "-"), ("body", "body", (0, (4, 1.5)))):
        for k, label in enumerate(dataset[name].values.tolist() if name in dataset.coords else ()):
            values = dataset[f"{kind}_position"][:, k].sel(axis=axis).values
            if kind == "body" or k not in groups:
                curves.append((label, values, {"color": colour_of(len(curves)), "linestyle": dashes}))
    draw_curves(dataset, ax, curves)


def contact_friction(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the friction coefficient that every contact needs at least, to stand as it does."""
    _of_contacts(dataset, ax, "contact_friction")
    style.dress(ax, "Friction needed", path_label(dataset), "coefficient (1)")
    if ax.lines:
        ax.set_ylim(bottom=0.0, top=1.1 * max(float(np.nanmax(line.get_ydata())) for line in ax.lines))
    finish_loads(dataset, ax)


def reactions(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the forces of the supports on the lines by component."""
    _components(dataset, ax, dataset["reaction"], dataset["support"].values.tolist())
    style.dress(ax, "Support forces on the line", path_label(dataset), "force (N)")
    style.legend(ax)


def energy(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the change of every form of energy since the start; forms whose changes could not be seen are left out."""
    change = dataset["energy"].values - dataset["energy"].values[:1]
    sizes = np.nanmax(np.abs(change), axis=0, initial=0.0)
    seen = [k for k, form in enumerate(ENERGY_FORMS) if form != AUDIT and sizes[k] > SEEN * sizes.max()]
    curves = list[Curve]()
    for k in sorted(sorted(seen, key=lambda k: -sizes[k])[:CURVES]):
        dashes: Any = "-" if ENERGY_FORMS[k] in ("kinetic", "elastic", "gravitational") else (0, (4, 1.5))
        look = {"color": style.CYCLE[len(curves) % len(style.CYCLE)], "linestyle": dashes}
        curves.append((ENERGY_LABELS[ENERGY_FORMS[k]], change[:, k], look))
    draw_curves(dataset, ax, curves)
    style.dress(ax, "Energy since the start", path_label(dataset), "energy (J)")
    style.legend(ax)


def imbalance(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the energy residual, and compare it with the energy throughput."""
    path, values = dataset[path_name(dataset)].values, dataset["energy"].values
    missed = values[:, ENERGY_FORMS.index(AUDIT)]
    ax.plot(path, missed, color=style.INK, linewidth=style.THIN, label="_energy residual")
    moved, worst = float(np.max(turnover(values))), float(np.nanmax(np.abs(missed), initial=0.0))
    style.dress(ax, "Energy residual", path_label(dataset), "energy (J)")
    if moved > 0.0 and worst > rounding(scenario_of(dataset), values):
        note = f"{percent(worst / moved)} of the energy throughput"
        style.remark(ax, note if note.startswith("less") else f"at most {note}")


def tension_along(dataset: xr.Dataset, ax: Axes, instants: int = SHAPES) -> None:
    """Draw the tension along the material coordinate at several instants, early to late."""
    name = path_name(dataset)
    frames = style.thinned(dataset.sizes[name], instants)
    colours = style.colours(style.INSTANTS)(np.linspace(0.0, 1.0, max(len(frames), 2)))
    for line in lines(dataset):
        here = np.flatnonzero(dataset["link_line"].values == line)
        here = here[style.thinned(len(here), POINTS)]
        values = dataset["tension"].isel({name: frames, "link": here}).values
        for k in range(len(frames)):
            when = f"{word(dataset)} {number(float(dataset[name].values[frames[k]]))} {dataset[name].attrs['units']}"
            curve = {"color": colours[k], "linewidth": style.LINE, "label": f"_{line} at {when}"}
            ax.plot(dataset["link_xi"].values[here], values[k], **curve)
    style.dress(ax, "Tension along the line", "material coordinate xi (m)", "tension (N)")
    if len(frames) > 1:
        label = f"{word(dataset)} ({dataset[name].attrs['units']})"
        instants_bar(ax, dataset[name].values[frames], label)


VIEWS: Mapping[str, Callable[[xr.Dataset, Axes], None]] = {
    "shapes": shapes,
    "tension": tension,
    "tension_along": tension_along,
    "net_tension": net_tension,
    **{view: partial(_loads, view=view) for view in _OF_LOADS},
    "contact_friction": contact_friction,
    "reactions": reactions,
    "energy": energy,
    "imbalance": imbalance,
}


def headline(fig: Figure, dataset: xr.Dataset) -> None:
    """Write the title of a result above a figure, and how it ended if it did not complete."""
    outcome = dataset.attrs.get("outcome", "")
    note = "" if outcome == "completed" else f"  ({outcome})"
    title = f"{dataset.attrs.get('title', '')}{note}"
    fig.suptitle(title, fontsize=style.TITLE + 2, color=style.INK, fontweight="bold", x=0.01, ha="left")


def path_label(dataset: xr.Dataset) -> str:
    """The label of axes of the leading dimension."""
    return f"{word(dataset)} ({dataset[path_name(dataset)].attrs['units']})"


def any_of(dataset: xr.Dataset, name: str) -> bool:
    """Whether a quantity is anything but zero anywhere."""
    return bool((np.nan_to_num(dataset[name].values) != 0.0).any())


def _of_contacts(dataset: xr.Dataset, ax: Axes, name: str) -> None:
    """Draw a quantity of every contact, if it is anything but zero."""
    values, loads = dataset[name].values, dataset["load"].values.tolist()
    kept = [k for k in range(len(loads)) if np.nan_to_num(values[:, k]).any()]
    draw_curves(dataset, ax, [(loads[k], np.where(np.isfinite(values[:, k]), values[:, k], np.nan), {}) for k in kept])


def draw_curves(dataset: xr.Dataset, ax: Axes, curves: Sequence[Curve]) -> None:
    """Draw curves over the path; of more than seven the three largest, and a band from the least to the largest of all.

    Args:
        dataset: a result.
        ax: axes to draw on.
        curves: label, values (instant,) and look of each; without a colour they take those of several things.
    """
    path = dataset[path_name(dataset)].values
    if len(curves) > CURVES:
        band(dataset, ax, [values for _, values, _ in curves], f"least to largest of {len(curves)}")
        sizes = [-np.nanmax(np.abs(values), initial=0.0) for _, values, _ in curves]
        curves = [(curves[k][0], curves[k][1], {}) for k in np.argsort(sizes, kind="stable")[:LARGEST]]
    for n, (label, values, look) in enumerate(curves):
        plain = {"color": colour_of(n), "linewidth": style.LINE, **style.marks(n, len(curves), path.size)}
        ax.plot(path, values, label=label, **{**plain, **look})


def band(dataset: xr.Dataset, ax: Axes, curves: Sequence[Array], label: str) -> None:
    """Fill between the least and the largest of curves (instant,)."""
    path, every = dataset[path_name(dataset)].values, np.array(curves)
    low, high = np.fmin.reduce(every), np.fmax.reduce(every)
    ax.fill_between(path, low, high, color=style.FAINT, alpha=0.35, linewidth=0.0, label=label, zorder=1)
    for values, name in ((low, "_least"), (high, "_largest")):
        ax.plot(path, values, color=style.FAINT, linewidth=0.5, label=name, zorder=1)


def _row_max(values: Array) -> Array:
    out: Array = np.fmax.reduce(values, axis=1)
    return out


def _components(dataset: xr.Dataset, ax: Axes, force: xr.DataArray, names: list[str]) -> None:
    """Draw the components of forces (frame, name, axis), those that matter; of many forces their sizes."""
    values, axes = force.values, dataset["axis"].values.tolist()
    seen = np.nanmax(np.abs(values), axis=0, initial=0.0) > SEEN * np.nanmax(np.abs(values), initial=0.0)
    dashes: dict[str, Any] = {"x": "-", "y": (0, (1, 1)), "z": (0, (5, 1.5))}
    if seen.sum() <= CURVES:
        alone = seen.any(axis=0).sum() == 1
        draw_curves(dataset, ax, [
            (f"{names[k]}, {axes[i]}", values[:, k, i],
             {"color": colour_of(k), "linestyle": "-" if alone else dashes[axes[i]]})
            for k, i in np.argwhere(seen).tolist()
        ])  # fmt: skip
    else:
        sizes = np.linalg.norm(values, axis=2)
        draw_curves(dataset, ax, [(f"size of {names[k]}", sizes[:, k], {}) for k in np.flatnonzero(seen.any(axis=1))])


def finish_loads(dataset: xr.Dataset, ax: Axes) -> None:
    """Say why a panel of loads is empty, if it is, and give it a legend."""
    note = "" if ax.lines else "zero throughout" if dataset.sizes["contact"] else "no loads"
    if note:
        place: dict[str, Any] = {"ha": "center", "va": "center", "transform": ax.transAxes}
        ax.text(0.5, 0.5, note, **place, fontsize=style.LABEL, color=style.FAINT)
        ax.set_yticks([])
    style.legend(ax)
