"""Figures: an overview of a result, or the panels that are asked for, on Figure objects without pyplot's state."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from ropewalk.errors import did_you_mean
from ropewalk.results import style
from ropewalk.results.audit import AUDIT
from ropewalk.results.axis_units import displayed_size, show_units
from ropewalk.results.contact_figure import FORCE, Collection, is_of_overhead_line
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import NOTHING, DisplayUnits
from ropewalk.results.files import ResultError
from ropewalk.results.frame import Array
from ropewalk.results.nets import is_spatial
from ropewalk.results.response_views import (
    VIEWS_OF_CARRIAGES,
    VIEWS_OF_PLACES,
    seen_at_places,
    seen_of_carriages,
    with_first_axles,
)
from ropewalk.results.scene import is_long, space
from ropewalk.results.shape_views import plan
from ropewalk.results.style import Page
from ropewalk.results.table import ROUND_OFF
from ropewalk.results.trains import grouped_contacts
from ropewalk.results.views import VIEWS, any_of, headline

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

ALL_VIEWS = (*VIEWS, *VIEWS_OF_PLACES, *VIEWS_OF_CARRIAGES, "space", "plan")
WHOLE_ROW = ("shapes", "space", "pantograph_height", "droppers")  # panels that need all of the width
TALL = {"shapes": 1.4, "space": 2.3, FORCE: 1.3, "plan": 1.5}  # heights of panels beside that of others
SLIM = 0.7  # and of the plan of what is long
ROW, HEAD = 2.1, 0.3  # in: on a screen, of a panel and of the title
COLUMN = 5.5  # in: width of a panel on a screen
GRID = 2  # parts of the width
SCENE = (1.75, 1.0)  # widths of a view in space and the plan beside it


def figure(
    dataset: xr.Dataset,
    *,
    panels: Sequence[str] | None = None,
    size: str | None = None,
    units: DisplayUnits | None = None,
) -> Figure:
    """Draw panels of a result, all axes with units; in an overview those in which there is something to see.

    Args:
        dataset: a result.
        panels: names of the panels in order: of those that `panels_of` lists, or any of `ALL_VIEWS`; without them an
            overview.
        size: `screen`, `report` or `journal` (16 and 8.8 cm wide), or as "16x9cm"; on paper the title is left to the
            caption.
        units: that axes are labelled in (default: of engineering, by the size of the numbers).

    Raises:
        ResultError: there is no such panel in this result.
        Refused: (a ValueError) `size` cannot be read.
    """
    return _draw(dataset, panels, Page.of(size), units)[0]


def single(dataset: xr.Dataset, view: str) -> Figure:
    """Draw one panel on a figure of its own.

    Raises:
        ResultError: there is no such panel in this result.
    """
    return figure(dataset, panels=[view], size="8x4.5in")


def figure_data(
    dataset: xr.Dataset, *, panels: Sequence[str] | None = None, units: DisplayUnits | None = None
) -> dict[str, pd.DataFrame]:
    """Give what the panels of a figure show as tables: of each panel the curve, and both coordinates with their units.

    Args:
        dataset: a result.
        panels: see `figure`; views in three dimensions have no table.
        units: see `figure`.

    Raises:
        ResultError: there is no such panel in this result.
    """
    import pandas as pd

    _, drawn = _draw(dataset, panels, Page.of(None), units)
    found = {}
    for name, ax in drawn.items():
        parts = [pd.DataFrame(columns=["curve", _head(ax.get_xlabel()), _head(ax.get_ylabel())])]
        sizes = displayed_size(ax.xaxis), displayed_size(ax.yaxis)
        for line in ax.lines:
            label, points = str(line.get_label()), np.asarray(line.get_xydata())
            if not re.match(r"_child\d", label) and len(points):
                named = {"curve": label.removeprefix("_")}
                values = zip(parts[0].columns[1:], points.T / np.array([sizes]).T, strict=True)
                parts.append(pd.DataFrame(named | dict(values)))
        if name != "space":
            found[name] = pd.concat(parts[1:] or parts, ignore_index=True)
    return found


def _head(label: str) -> str:
    """The label of an axis as the head of a column."""
    return re.sub(r"\((.+)\).*", r"[\1]", label).replace("²", "^2").replace("·", "*")


def panels_of(dataset: xr.Dataset) -> list[str]:
    """Names of the panels of the overview: those in which there is something to see.

    Args:
        dataset: a result.
    """
    if is_of_overhead_line(dataset):
        return Collection.of(dataset).panels
    frames = dataset.sizes[path_name(dataset)]
    first = ["space", "plan"] if frames and is_spatial(dataset) else ["shapes"]
    if frames < 2:
        return [*first, *(["tension_along"] if frames and any_of(dataset, "tension") else [])]
    force = "hold_force" if _matters(dataset, "hold_force", "contact_force") else "contact_force"
    single = dataset.sizes["contact"] > len(grouped_contacts(dataset))
    aside = "y" in dataset["axis"].values and _moves(dataset["contact_position"].sel(axis="y").values)
    in_time = path_name(dataset) == "time"
    wanted = {
        "tension": any_of(dataset, "tension"),
        "net_tension": "cell_tension" in dataset and any_of(dataset, "cell_tension"),
        "contact_height": single,
        "contact_sideways": single and aside,
        "energy": any_of(dataset, "energy"),
        force: any_of(dataset, force) and _moves(dataset[force].values),
        "contact_speed": any_of(dataset, "friction_power"),
        "friction_power": any_of(dataset, "friction_power"),
        "imbalance": in_time and any_of(dataset.sel(form=AUDIT), "energy"),
        "contact_friction": not in_time and any_of(dataset, "contact_friction"),
        "reactions": any_of(dataset, "reaction"),
    }
    seen = [*seen_at_places(dataset), *seen_of_carriages(dataset)]
    return [*first, *seen, *(view for view, there in wanted.items() if there)]


def rows_of_panels(dataset: xr.Dataset, size: str) -> list[list[str]]:
    """Names of the panels of the overview, those in one list side by side on a page of this size."""
    long = bool(dataset.sizes[path_name(dataset)] and is_spatial(dataset) and is_long(dataset))
    return _rows(panels_of(with_first_axles(dataset)), Page.of(size).columns, long)


def _moves(places: Array) -> bool:
    """Whether coordinates (frame, ...) in m, or forces in N, change at all."""
    kept = places[:, np.isfinite(places).any(axis=0)]
    return bool((np.nanmax(kept, axis=0) - np.nanmin(kept, axis=0) > ROUND_OFF).any()) if kept.size else False


def _matters(dataset: xr.Dataset, name: str, beside: str) -> bool:
    """Whether a quantity is more than rounding beside another."""
    here, there = (float(np.nanmax(np.abs(dataset[each].values), initial=0.0)) for each in (name, beside))
    return here > NOTHING * there


def _rows(names: Sequence[str], columns: int, long: bool) -> list[list[str]]:
    """Rows of panels in their order, side by side where there is room."""
    rows: list[list[str]] = []
    for name in names:
        whole = columns == 1 or name in WHOLE_ROW or name.startswith(FORCE) or (name == "plan" and long)
        last = rows[-1] if rows else []
        if name == "plan" and last == ["space"] and not whole:
            last.append(name)
        elif whole or not last or len(last) == columns or last[0] in WHOLE_ROW or last[0].startswith(FORCE):
            rows.append([name])
        else:
            last.append(name)
    return rows


def _draw(
    dataset: xr.Dataset, panels: Sequence[str] | None, page: Page, units: DisplayUnits | None
) -> tuple[Figure, dict[str, Axes]]:
    """The figure, and its panels by name."""
    dataset = with_first_axles(dataset)
    collection = Collection.of(dataset) if is_of_overhead_line(dataset) else None
    names = panels_of(dataset) if panels is None else _known(panels, collection)
    spatial = {"space", "plan"} & set(names)
    long = bool(spatial and dataset.sizes[path_name(dataset)] and is_long(dataset))
    rows = _rows(names, page.columns, long)
    tallness = {**TALL, "plan": SLIM} if long else TALL
    heights = [max(tallness.get(name.partition(".")[0], 1.0) for name in row) for row in rows]
    share = 0.35 + 0.65 * page.width / page.columns / COLUMN
    titled = panels is None and page == Page.of(None)
    with style.scaled(page.scale):
        tall = page.tall(ROW * share * sum(heights) + HEAD)
        fig = Figure(figsize=(page.width, tall), dpi=page.dpi, layout="constrained")
        if titled:
            headline(fig, dataset)
        drawn: dict[str, Axes] = {}
        scenes = []
        for name, ax in _stand(fig, rows, heights):
            drawn[name] = ax
            if not dataset.sizes[path_name(dataset)]:
                style.dress(ax, name)
            elif name == "space":
                scenes.append(space(dataset, ax))
            elif collection is not None and name in collection.panels:
                collection.draw(name, ax)
            else:
                views = {**VIEWS, **VIEWS_OF_PLACES, **VIEWS_OF_CARRIAGES, "plan": plan}
                views[name](dataset, ax)
        show_units(fig, units or DisplayUnits.read(None))
        _share_labels(rows, drawn)
        placed = [[drawn[name] for name in row] for row in rows]
        for ax in drawn.values():
            if (legend := ax.get_legend()) is not None:
                legend.set_in_layout(False)
        fig.draw_without_rendering()
        style.settle(placed)
        if page.height is None:
            lines = sum(max(style.legend_rows(row) - 1, 0) for row in placed)
            fig.set_figheight(page.tall(tall + lines * style.LINE_HEIGHT * style.NOTE / 72.0))
        for k in range(GRID):
            fig.align_ylabels([drawn[row[k]] for row in rows if len(row) > k and row[0] != "space"])
        for scene in scenes:
            scene.settle()
    return fig, drawn


def _stand(fig: Figure, rows: Sequence[Sequence[str]], heights: Sequence[float]) -> Iterator[tuple[str, Axes]]:
    """Panels with their empty axes; views in space and plans have a grid of their own above the others."""
    head = sum(all(name in ("space", "plan") for name in row) for row in rows)
    blocks = [(a, b) for a, b in ((0, head), (head, len(rows))) if b > a]
    outer = fig.add_gridspec(len(blocks), 1, height_ratios=[sum(heights[a:b]) for a, b in blocks])
    for k, (a, b) in enumerate(blocks):
        aside = any(len(row) > 1 for row in rows[a:b])
        widths = SCENE if aside and b == head else (1.0,) * GRID
        grid = outer[k].subgridspec(b - a, len(widths), height_ratios=heights[a:b], width_ratios=widths)
        for r, row in enumerate(rows[a:b]):
            for c, name in enumerate(row):
                part = slice(GRID * c // len(row), GRID * (c + 1) // len(row))
                yield name, fig.add_subplot(grid[r, part] if aside else grid[r, :])


def _known(panels: Sequence[str], collection: Collection | None) -> list[str]:
    """The panels asked for, those of pantographs each on its own."""
    own = collection.panels if collection is not None else []
    out = []
    for name in panels:
        each = [panel for panel in own if panel.startswith(f"{FORCE}.")] if name == FORCE else [name]
        if not each or not set(each) <= {*own, *ALL_VIEWS}:
            remedy = did_you_mean(name, [*own, *ALL_VIEWS], otherwise=f"there are {', '.join([*own, *ALL_VIEWS])}")
            raise ResultError(f"no panel {name!r} in this result; {remedy}")
        out += each
    return list(dict.fromkeys(out))


def _share_labels(rows: Sequence[Sequence[str]], drawn: dict[str, Axes]) -> None:
    """Panels over the same quantity share its axis, and only the lowest of those above each other has its label."""
    labels = {name: ax.get_xlabel() for name, ax in drawn.items()}
    first: dict[str, Axes] = {}
    for name, ax in drawn.items():
        if not labels[name] or labels[name].startswith("x ("):  # shapes and plans have scales of their own
            continue
        if (leader := first.setdefault(labels[name], ax)) is not ax:
            ax.sharex(leader)
    for row, below in pairwise(rows):
        for k, name in enumerate(row):
            under = [below[k]] if len(row) == len(below) else below
            if {labels[other] for other in under} == {labels[name]} and not labels[name].startswith("x ("):
                drawn[name].set_xlabel("")
                drawn[name].tick_params(labelbottom=False)
