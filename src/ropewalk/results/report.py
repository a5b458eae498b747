"""A report of one run: a single HTML page that prints on A4, with a summary, figures, tables and the scenario."""

from __future__ import annotations

import base64
import html
import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from datetime import date
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.errors import ScenarioError
from ropewalk.model.writing import brief
from ropewalk.results.contact_statistics import analysed_stations, scenario_of
from ropewalk.results.display_units import Column, DisplayUnits, Row, number
from ropewalk.results.dropper_lengths import equal_spans
from ropewalk.results.extremes import Summary
from ropewalk.results.figures import figure, rows_of_panels
from ropewalk.results.statistics import summary
from ropewalk.results.table import rows

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from ropewalk.model import Line, Scenario
    from ropewalk.model.overhead import OverheadLine
    from ropewalk.model.overhead_wire import OverheadWire
    from ropewalk.model.pantograph import Pantograph

DPI = 150
MOST_LINES, MOST_KEY_ROWS = 12, 10
_PAGE = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$title</title>
<style>
@page { size: A4; margin: 18mm 20mm 16mm 20mm; @bottom-right { content: counter(page); font-size: 8pt; } }
body { font: 10.5pt/1.35 system-ui, sans-serif; color: #222; max-width: 17cm; margin: 1cm auto; padding: 0 0.5cm; }
h1 { font-size: 16pt; margin: 0 0 0.1cm; }
h2 { font-size: 12pt; margin: 0.6cm 0 0.1cm; border-bottom: 1px solid #bbb; break-after: avoid; }
table { border-collapse: collapse; width: 100%; margin: 0.1cm 0 0.25cm; }
table { font-size: 8pt; line-height: 1.25; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 0.04cm 0.3cm 0.04cm 0; border-bottom: 1px solid #e3e3e3; vertical-align: top; }
tbody, figure, tr, p { break-inside: avoid; }
thead { display: table-header-group; }
th.block { padding-top: 0.2cm; font-size: 9pt; }
.quantities { table-layout: fixed; overflow-wrap: anywhere; }
.quantities td:nth-child(2) { text-align: right; }
td.outside { color: #b03000; font-weight: 600; }
.faint { color: #555; font-size: 8.5pt; margin: 0.1cm 0; }
.warning, .doubt { background: #fff4e0; padding: 0.15cm 0.3cm; margin: 0.15cm 0; font-size: 9pt; }
.doubt { background: #fde4e1; border-left: 4px solid #b3261e; }
figure { margin: 0.15cm 0; }
img { max-width: 100%; max-height: 24cm; }
pre { background: #f6f6f6; padding: 0.1cm; font-size: 6.5pt; line-height: 1.25; white-space: pre-wrap; margin: 0; }
@media print { body { max-width: none; margin: 0; padding: 0; } }
</style>
</head>
<body>
<h1>$title</h1>
<p class="faint">$subtitle</p>
$body
</body>
</html>
""")

Cells = Sequence[str]
Block = tuple[str, Sequence[Row]]
_KEY_ROWS = (
    "largest deflection", "largest acceleration", "largest bending moment", "largest tension", "largest sag",
    "largest tension over strength", "largest tension per width", "largest wheel load", "sway along the line",
    "pull of the hauling rope", "mean contact force Fm", "sigma, 0-20 Hz", "largest force", "smallest force",
    "loss of contact", "largest uplift of a support", "inside", "verdict", "largest contact force",
    "largest unloading", "contact force, mean", "lowest place", "largest load on the line", "load on the line, mean",
    "estimated error", "largest energy residual",
)  # fmt: skip
_NOTES = {
    "acceptance": "[F]: found in a public secondary source; [R]: recalled, not seen in the standard's own text.",
    "filter": "Forces up to {limit:g} Hz: {kind}, order {order}, run forwards and backwards, -6 dB at its limit. The "
    "order of the filter changes sigma by up to 3 N; the standards leave it open.",
}


def html_report(dataset: xr.Dataset, *, units: DisplayUnits | None = None) -> str:
    """Write a report as HTML that prints on A4: summary, figures, structure, all numbers, method and scenario.

    Args:
        dataset: a result.
        units: that numbers are shown in (default: of engineering, by their size).
    """
    found, scenario = summary(dataset), scenario_of(dataset)
    blocks = list(_blocks(found, units))
    method = [row for title, body in blocks if title == "Method" for row in body]
    blocks = [(title, body) for title, body in blocks if title != "Method"]
    fields = dataset.attrs
    method += [("version", f"ropewalk {fields.get('ropewalk_version', '')}", f"engine {fields.get('engine_number')}")]
    method += [("SHA-256 of the scenario", "", str(fields.get("scenario_sha256", "")))]
    body = [*_warnings(found), _section("Summary"), _quantities([("", _key_rows(found, blocks))])]
    body += [_section("Figures"), *_figures(dataset, units)]
    if scenario is not None and (structure := list(_structure(scenario, found, units))):
        body += [_section("Structure"), *structure]
    body += [_section("Results"), _quantities(blocks), *_notes(found)]
    body += [_section("Method"), _quantities([("", method)])]
    body += [_section("Scenario"), f"<pre>{_text(_scenario_file(dataset, scenario))}</pre>"]
    simulated = found["simulated"]
    length = f"{number(simulated['value'])} {simulated['unit']}"
    parts = (found["outcome"] or "unknown outcome", length, fields.get("source"), f"report of {date.today()}")
    title, subtitle = _text(found["title"] or "Result"), _text("; ".join(map(str, parts)))
    return _PAGE.substitute(title=title, subtitle=subtitle, body="\n".join(body))


def _text(value: object) -> str:
    return html.escape(str(value))


def _section(title: str) -> str:
    return f"<h2>{title}</h2>"


def _row(cells: Cells) -> str:
    kinds = [' class="outside"' if cell.startswith(("OUTSIDE", "FAIL")) else "" for cell in cells]
    parts = [f"<td{kind}>{_text(cell.replace('  ', '; '))}</td>" for cell, kind in zip(cells, kinds, strict=True)]
    return f"<tr>{''.join(parts)}</tr>"


def _quantities(blocks: Iterable[Block]) -> str:
    """A table of quantities with value, place and instant, in blocks that stay together on a page."""
    widths = ("5.6cm", "3.2cm", "auto")
    out = ['<table class="quantities">', *(f'<col style="width: {width}">' for width in widths)]
    for title, body in blocks:
        head = [f'<tr><th class="block" colspan="3">{_text(title)}</th></tr>'] if title else []
        out += ["<tbody>", *head, *map(_row, body), "</tbody>"]
    return "\n".join([*out, "</table>"])


def _table(body: Iterable[Cells], head: Cells) -> str:
    """A table with a head, which is repeated on every page."""
    out = ["<table><thead><tr>", *(f"<th>{_text(cell)}</th>" for cell in head), "</tr></thead>"]
    return "\n".join([*out, *map(_row, body), "</table>"])


def _blocks(found: Summary, units: DisplayUnits | None) -> Iterator[Block]:
    """Yield headings of the table of the command line with their rows, without those of the wheels of carriages."""
    wheels = {name for name in found["contacts"] if name.partition(".")[0] in found["carriages"]}
    title, body = "", list[Row]()
    for row in [*rows(found, units), ("", "", "")]:
        if row[1]:
            if row[0].partition(":")[0] not in wheels:
                body.append(row)
            continue
        if body and title.removeprefix("Load ") not in wheels:
            yield title, body
        title, body = row[0], []


def _key_rows(found: Summary, blocks: Sequence[Block]) -> list[Row]:
    """Return about ten rows: of each block the quantities in `_KEY_ROWS`, and the support with the largest force."""
    chosen = list[Row]()
    forces = {name: force["value"] or 0.0 for name, force in found["supports"].items()}
    strongest = max(forces, key=lambda name: forces[name], default="")
    responds = any(title.startswith("Line ") for title, _ in blocks)
    skipped = ("Place ", "Without the start-up", *(("Lines", "Supports") if found["pantographs"] else ()))
    for title, body in blocks:
        if title.startswith(skipped):
            continue
        own = {row[0]: row for row in sorted(body, key=_size) if row[0] in _KEY_ROWS}  # the largest of equal names
        name = title.partition(" ")[2] if title.startswith(_NAMED) else title if title.startswith("Payload") else ""
        picked = [row for row in body if own.get(row[0]) is row or (title == "Supports" and row[0] == strongest)]
        if not name:  # of ranges of standards the verdict only; a line that responds has its deflection
            picked = [row for row in picked if row[0] not in _OF_LOADS and not (responds and row[0] == "largest sag")]
        chosen += [(f"{name}: {what}" if name else what, value, where) for what, value, where in picked]
    return [*chosen[: MOST_KEY_ROWS - 1], *chosen[MOST_KEY_ROWS - 1 :][-1:]]


_OF_LOADS = ("largest force", "smallest force", "loss of contact")
_NAMED = ("Line ", "Load ", "Carriage ", "Train ", "Net ", "Pantograph ", "Crowd ")


def _size(row: Row) -> float:
    number = re.match(r"[\d.]+", row[1])
    return float(number[0]) if number else 0.0


def _warnings(found: Summary) -> Iterator[str]:
    notes = [("warning", found["advice"])] if found["advice"] else []
    notes += [("doubt", f"The results are unreliable: {doubt}") for doubt in found["doubts"]]
    notes += [("warning", f"Warning: {warning}") for warning in found["warnings"]]
    return (f'<p class="{kind}">{_text(note)}</p>' for kind, note in notes)


def _figures(dataset: xr.Dataset, units: DisplayUnits | None) -> Iterator[str]:
    """Rows of panels as pictures of their own, so that none is split between pages."""
    for panels in rows_of_panels(dataset, "report"):
        drawn: Figure = figure(dataset, panels=panels, size="report", units=units)
        drawn.savefig(stream := io.BytesIO(), format="png", dpi=DPI)
        data = base64.b64encode(stream.getvalue()).decode("ascii")
        label = _text(", ".join(panels).replace("_", " "))
        yield f'<figure><img alt="{label}" src="data:image/png;base64,{data}"></figure>'


def _structure(scenario: Scenario, found: Summary, units: DisplayUnits | None) -> Iterator[str]:
    """Lines with their spans and towers, overhead lines with their spans, and pantographs, in tables."""
    from ropewalk.model.pantograph import Pantograph

    if scenario.lines:
        head = ("line", "span", "rise", "length", "mass", "axial stiffness", "bending stiffness", "tension")
        yield _table([_of_line(name, line) for name, line in list(scenario.lines.items())[:MOST_LINES]], head)
        if (more := len(scenario.lines) - MOST_LINES) > 0:
            yield f'<p class="faint">{more} more lines are in the scenario.</p>'
    say = Column(units or DisplayUnits.read(None), *found["supports"].values())
    for name, line in scenario.lines.items():
        if body := list(_towers(name, line, found["supports"], say)):
            yield _table(body, (f"support of {name}", "kind", "x", "z", "span from the previous", "largest force"))
    for name, overhead in scenario.overhead_lines.items():
        yield _quantities([(f"Overhead line {name}", list(_of_overhead_line(overhead)))])
        head = ("span", "from", "length", "uplift at its end", "droppers", "least force", "largest force", "slack")
        yield _table(_spans(name, overhead, found), head)
        if lengths := _dropper_lengths(found["overhead_lines"][name]["droppers"]):
            yield _table(lengths, ("spans", "lengths of their droppers, m"))
    for name, load in scenario.loads.items():
        if isinstance(load, Pantograph):
            yield _quantities([(f"Pantograph {name}", list(_of_pantograph(load)))])


def _of_line(name: str, line: Line) -> Cells:
    rise, span = line.end[-1] - line.start[-1], abs(line.end[0] - line.start[0])
    given = ((line.length, "m"), (line.mass, "kg/m"), (line.axial_stiffness, "N"), (line.bending_stiffness, "N m²"))
    values = (_with_unit(value, unit) for value, unit in (*given, (line.tension, "N")))
    return (name, f"{span:g} m", f"{rise:g} m", *values)


def _with_unit(value: float | None, unit: str) -> str:
    if not value:
        return "–"
    for size, sign in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if unit[0] == "N" and value >= size:
            return f"{value / size:.4g} {sign}{unit}"
    return f"{value:.4g} {unit}"


def _towers(name: str, line: Line, supports: Mapping[str, Any], say: Column) -> Iterator[Cells]:
    """Supports of a line in their order with their spans; none where it has its ends alone."""
    start, end = np.array(line.start), np.array(line.end)
    inner: list[tuple[str, str, Any]] = [
        (key, one.kind, one.position or start + (end - start) * one.at / (line.length or np.inf))
        for key, one in line.supports.items()
    ]
    inner += [(key, "saddle", one.at) for key, one in line.saddles.items()]
    inner += [(key, "sheave", one.at) for key, one in line.sheaves.items()]
    if not inner:
        return
    inner.sort(key=lambda one: one[2][0])
    stands = [("start", line.start_support.kind, start), *inner, ("end", line.end_support.kind, end)]
    for before, (key, kind, place) in zip([None, *stands], stands, strict=False):
        force = supports.get(f"{name}.{key}", {}).get("value")
        span = "" if before is None else f"{abs(place[0] - before[2][0]):.4g} m"
        x, z = f"{place[0]:.4g} m", f"{place[-1]:.4g} m"
        yield key, kind, x, z, span, "–" if force is None else say(force, "N")


def _spans(name: str, line: OverheadLine, found: Summary) -> Iterator[Cells]:
    """A row for each span: its support, and the extremes of its droppers; those that are analysed are marked."""
    droppers, supports = found["overhead_lines"][name]["droppers"], found["overhead_lines"][name]["supports"]
    first, last = line.analysed
    ends = [0.0]
    for k, length in enumerate(line.span_lengths, 1):
        own = [one for label, one in droppers.items() if label.split(".")[1] == str(k)]
        least, most, slack = (
            extreme((one[key] for one in own if one[key] is not None), default=None)
            for key, extreme in (("smallest", min), ("largest", max), ("slack", max))
        )
        uplift = supports.get(f"{name}.support.{k}", {}).get("uplift")
        yield (
            f"{k}{' *' if first <= k <= last else ''}", f"{ends[-1]:g} m", f"{length:g} m",
            "–" if uplift is None else f"{1e3 * uplift:.3g} mm", str(len(own)),
            *("–" if force is None else f"{number(force, 3)} N" for force in (least, most)),
            "–" if slack is None else f"{number(100 * slack, 2)} %",
        )  # fmt: skip
        ends.append(ends[-1] + length)


def _dropper_lengths(droppers: Summary) -> list[Cells]:
    """Lengths of droppers in their order, m, a row for each group of adjacent spans with the same ones."""
    groups = equal_spans(droppers, lambda length: "–" if length is None else f"{length:.3f}")
    return [(" to ".join(dict.fromkeys((first, last))), text) for first, last, text in groups if "–" not in text]


def _of_overhead_line(line: OverheadLine) -> Iterator[Row]:
    low, high = analysed_stations(line)
    yield "analysed spans *", "", f"{line.analysed[0]} to {line.analysed[1]}, {low:g} to {high:g} m"
    wires = {"contact": line.contact_wire, "messenger": line.messenger_wire, "stitch": line.stitch_wire}
    yield from ((f"{what} wire", "", _of_wire(wire)) for what, wire in wires.items() if wire is not None)
    sag = 1e3 * max((sag for row in line.sags for sag in row), default=0.0)
    yield "system height, largest pre-sag", "", f"{line.system_height:g} m, {sag:g} mm"
    d, arms = line.droppers, line.steady_arms
    yield "droppers", "", f"{d.stiffness:g} N/m in tension, {d.pushes:g} N/m in compression"
    yield "steady arms", "", f"{arms.moving_mass:.4g} kg move with the wire{', hanging free' if arms.free else ''}"
    if (own := line.condition) is not None:
        lost = ", ".join(f"{span}.{number}" for span, number in own.missing_droppers) or "none"
        yield "condition", "", f"missing droppers: {lost}; wear {100 * own.wear:g} %; {own.temperature_rise:+g} K"


def _of_wire(wire: OverheadWire) -> str:
    damping = (
        f", Rayleigh damping {wire.drag:g} 1/s and {wire.retardation:g} s" if wire.drag or wire.retardation else ""
    )
    return f"{wire.mass:g} kg/m, {wire.tension:g} N, EI {wire.bending_stiffness:g} N m²{damping}"


def _of_pantograph(load: Pantograph) -> Iterator[Row]:
    parts, speed = load.parts, load.travel.speed
    yield "model", "", f"{load.model}: {parts.source}" if load.model else "user-defined"
    yield "masses, from the base to the head", "", f"{_several(parts.masses)} kg"
    yield "springs, dampers below each mass", "", f"{_several(parts.stiffness)} N/m, {_several(parts.damping)} N s/m"
    strips = " of each strip" if len(load.strips) > 1 else ""
    yield "contact stiffness", "", f"{load.contact_stiffness:g} N/m{strips}"
    if load.wanted_mean is not None:
        yield "target of the mean force", "", f"{load.wanted_mean}{'' if isinstance(load.wanted_mean, str) else ' N'}"
    else:
        yield "static force", "", f"{load.pressed_with:g} N, aerodynamic {load.aerodynamic or 0.0:g} kg/m v²"
    yield "speed", "", f"{3.6 * speed:g} km/h" if isinstance(speed, float) else "see the scenario"


def _several(values: float | Iterable[float]) -> str:
    return f"{values:g}" if isinstance(values, int | float) else ", ".join(f"{value:g}" for value in values)


def _notes(found: Summary) -> Iterator[str]:
    """Sentences on ranges of standards and on the filter of contact forces."""
    fields = list(found["pantographs"].values())
    notes = [_NOTES["acceptance"]] if any(one["acceptance"] for one in fields) else []
    notes += [_NOTES["filter"].format(**one["filter"]) for one in fields[:1]]
    return (f'<p class="faint">{_text(note)}</p>' for note in notes)


def _scenario_file(dataset: xr.Dataset, scenario: Scenario | None) -> str:
    """The scenario as its user wrote it, else as short YAML, else (callables of the Python API) as JSON."""
    fields = dataset.attrs
    with suppress(ScenarioError):
        return str(fields.get("scenario_file") or (brief(scenario) if scenario is not None else fields["scenario"]))
    return str(fields["scenario"])
