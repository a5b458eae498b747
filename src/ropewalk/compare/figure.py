"""The picture of a model hierarchy: what every model says under the load, where it is wrong, and by how much."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from ropewalk.compare.quantities import QUANTITIES
from ropewalk.compare.simpler_models import CUT, FORCE, FULL, LINEAR, MASS, MODELS, QUASISTATIC
from ropewalk.results import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ropewalk.compare.result import LevelResult, ModelHierarchy

COLOURS = {
    LINEAR: style.RED, QUASISTATIC: style.ORANGE, FORCE: style.GREEN, MASS: style.PURPLE, FULL: style.INK,
    CUT: style.BLUE,
}  # fmt: skip
DASHES: dict[str, Any] = {
    LINEAR: (0, (5, 1.6)),
    QUASISTATIC: (0, (1.2, 1.2)),
    FORCE: "-",
    MASS: "-.",
    FULL: "-",
    CUT: (0, (3, 1.5)),
}
LEAST, MOST = 1e-4, 1e2  # relative errors that are drawn
DEEPEST = 2.2  # times the largest deflection of the full scenario: what goes further is cut off
LABELS = {
    "deflection": "largest\ndeflection", "path": "deflection\nunder load", "tension": "largest\ntension",
    "support force": "support\nforce", "contact force": "contact\nforce", "speed": "last\nspeed",
    "hold force": "hold\nforce",
}  # fmt: skip


def figure(model_hierarchy: ModelHierarchy) -> Figure:
    """Draw the deflection under the load over its place for all models, the local error below, and all distances.

    Args:
        model_hierarchy: as compared; of several wheels, the one is drawn under which the line yields most.
    """
    fig = Figure(figsize=(11.0, 9.2), dpi=style.DPI, layout="constrained")
    upper, middle, lower = fig.subplots(3, 1, height_ratios=(1.25, 1.0, 0.95))
    fig.suptitle(
        model_hierarchy.title, x=0.01, ha="left", fontsize=style.TITLE + 1.5, color=style.INK, fontweight="bold"
    )
    fig.get_layout_engine().set(h_pad=0.06)  # type: ignore[union-attr,call-arg]
    wheel = _deepest(model_hierarchy)
    _deflections(model_hierarchy, wheel, upper)
    _errors(model_hierarchy, wheel, middle)
    middle.sharex(upper)
    upper.set_xlabel("")
    upper.tick_params(labelbottom=False)
    _bars(model_hierarchy, lower)
    fig.supxlabel(_recommended(model_hierarchy), fontsize=style.LABEL, color=style.INK, x=0.01, ha="left")
    return fig


def _deepest(model_hierarchy: ModelHierarchy) -> str:
    traces = model_hierarchy.models[FULL].traces
    scale = {name: float(np.nanmax(np.abs(t.depth), initial=0.0)) for name, t in traces.items()}
    return max(scale, key=lambda name: scale[name])


def _run(model_hierarchy: ModelHierarchy) -> list[LevelResult]:
    return [model_hierarchy.models[name] for name in MODELS if model_hierarchy.models[name].quantities is not None]


def _named(model_hierarchy: ModelHierarchy, name: str) -> str:
    """The name of a model with those that coincide with it."""
    others = [
        other for other in MODELS if model_hierarchy.models[other].same_as and model_hierarchy.of(other).name == name
    ]
    return " = ".join([name, *others])


def _deflections(model_hierarchy: ModelHierarchy, wheel: str, ax: Axes) -> None:
    style.dress(ax, "Deflection of the line under the load", "place of the load along the line (m)", "deflection (m)")
    full = model_hierarchy.models[FULL].traces[wheel]
    scale = float(np.nanmax(np.abs(full.depth))) or 1.0
    beyond = []
    for step in _run(model_hierarchy):
        trace = step.traces.get(wheel)
        if trace is None:
            continue
        is_full = step.name == FULL
        ax.plot(
            trace.xi, trace.depth, color=COLOURS[step.name], ls=DASHES[step.name], zorder=2.0 if is_full else 3.0,
            lw=3.2 if is_full else style.LINE, alpha=0.45 if is_full else 1.0, label=_named(model_hierarchy, step.name),
        )  # fmt: skip
        if np.nanmax(np.abs(trace.depth), initial=0.0) > DEEPEST * scale:
            beyond.append(step.name)
    low, high = (float(v) for v in ax.get_ylim())
    limits = max(low, -DEEPEST * scale), min(high, DEEPEST * scale)
    ax.set_ylim(*(limits if np.nansum(full.force[:, -1]) > 0.0 else limits[::-1]))  # downwards is down
    if beyond:
        style.remark(ax, f"{', '.join(beyond)}: beyond the axis")
    elif len(model_hierarchy.models[FULL].traces) > 1:
        style.remark(ax, f"under {wheel}")
    style.legend(ax)


def _errors(model_hierarchy: ModelHierarchy, wheel: str, ax: Axes) -> None:
    style.dress(ax, "Its error in each place", "place of the load along the line (m)", "error (% of the full one)")
    allowed = model_hierarchy.allowed.get("path", 0.05)
    for step in _run(model_hierarchy):
        way = step.ways.get(wheel)
        if way is None or step.name == FULL:
            continue
        local = np.clip(way.local, LEAST, MOST)
        ax.plot(way.xi, 100.0 * local, color=COLOURS[step.name], ls=DASHES[step.name], lw=style.THIN + 0.2)
    linear = model_hierarchy.assumptions.linear.get(wheel)
    for begin, end in linear.beyond if linear is not None else ():
        ax.axvspan(begin, end, ymin=0.0, ymax=0.03, color=COLOURS[LINEAR], lw=0.0, alpha=0.55)
    ax.axhline(100.0 * allowed, color=style.INK, lw=style.THIN, ls=(0, (4, 2)))
    ax.annotate(f"allowed: {100.0 * allowed:.3g} %", (1.0, 100.0 * allowed), (-2, 3), xycoords=ax.get_yaxis_transform(),
                textcoords="offset points", ha="right", fontsize=style.NOTE, color=style.INK)  # fmt: skip
    _percent_axis(
        ax,
        [100.0 * np.clip(s.ways[wheel].local, LEAST, MOST) for s in _run(model_hierarchy) if wheel in s.ways],
        allowed,
    )
    if linear is not None and linear.beyond:
        style.remark(ax, "at the bottom: where the linear theory fails")


def _percent_axis(ax: Axes, values: list[Any], allowed: float) -> None:
    kept = np.concatenate([*map(np.ravel, values), [100.0 * allowed]])
    kept = kept[kept > 100.0 * LEAST * 1.01]
    ax.set_yscale("log")
    ax.set_ylim(max(10.0 ** np.floor(np.log10(np.percentile(kept, 2))), 100.0 * LEAST), 2.0 * float(kept.max()))
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.grid(visible=False, which="minor")


def _bars(model_hierarchy: ModelHierarchy, ax: Axes) -> None:
    style.dress(ax, "Distance from the full scenario", "", "distance (%)")
    steps = [step for step in _run(model_hierarchy) if step.name != FULL]
    displayed = [q for q in QUANTITIES if any((step.errors.get(q) or 0.0) > 0.0 for step in steps)]
    width = 0.8 / max(len(steps), 1)
    least = 100.0 * 1e-3
    for i, step in enumerate(steps):
        for j, quantity in enumerate(displayed):
            error = step.errors.get(quantity)
            if error is None:
                continue
            at, height = j + (i - 0.5 * (len(steps) - 1)) * width, max(100.0 * error, least)
            good = quantity not in model_hierarchy.allowed or error <= model_hierarchy.allowed[quantity]
            ax.bar(at, height, 0.9 * width, color=COLOURS[step.name], alpha=0.45 if good else 1.0, lw=0.0,
                   label=_named(model_hierarchy, step.name) if j == 0 else None)  # fmt: skip
            text = "0" if error < 1e-3 * 1e-3 else f"{100.0 * error:.2g}" if error < 1.0 else f"{100.0 * error:.0f}"
            ax.annotate(text, (at, height), (0, 1.5), textcoords="offset points", ha="center", va="bottom",
                        fontsize=style.NOTE - 1.0, color=style.INK)  # fmt: skip
    for j, quantity in enumerate(displayed):
        if quantity in model_hierarchy.allowed:
            ax.hlines(100.0 * model_hierarchy.allowed[quantity], j - 0.45, j + 0.45, color=style.INK, lw=style.THIN,
                      ls=(0, (4, 2)))  # fmt: skip
    ax.set_yscale("log")
    tops = [100.0 * (step.errors.get(q) or 0.0) for step in steps for q in displayed]
    ax.set_ylim(least, 4.0 * max([100.0 * max(model_hierarchy.allowed.values()), *tops]))
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.set_xticks(
        range(len(displayed)), [LABELS[quantity] for quantity in displayed], fontsize=style.LABEL, color=style.INK
    )
    ax.set_xlim(-0.6, max(len(displayed), 1) - 0.4)
    ax.grid(visible=False, axis="x")
    style.remark(ax, "dashed: allowed; pale: within it")


def _recommended(model_hierarchy: ModelHierarchy) -> str:
    return model_hierarchy.verdict.splitlines()[-1]
