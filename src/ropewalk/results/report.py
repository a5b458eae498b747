"""A report of one run: a single HTML page with tables, figures and the scenario, that needs nothing else."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Iterable, Iterator, Sequence
from string import Template
from typing import TYPE_CHECKING, Any

from ropewalk.results.contact_figure import is_of_overhead_line
from ropewalk.results.contact_statistics import analysed_stations, scenario_of
from ropewalk.results.display_units import DisplayUnits, number
from ropewalk.results.figures import figure
from ropewalk.results.statistics import Summary, summary
from ropewalk.results.table import rows

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from ropewalk.model import Scenario
    from ropewalk.model.head import PantographHead
    from ropewalk.model.overhead import OverheadLine
    from ropewalk.model.overhead_wire import OverheadWire
    from ropewalk.model.pantograph import Pantograph

DPI = 110
_PAGE = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$title</title>
<style>
body { font: 15px/1.45 system-ui, sans-serif; color: #222; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; margin-bottom: 0.2rem; }
h2 { font-size: 1.2rem; margin-top: 2.2rem; border-bottom: 1px solid #ccc; padding-bottom: 0.2rem; }
table { border-collapse: collapse; margin: 0.6rem 0; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 0.18rem 0.9rem 0.18rem 0; border-bottom: 1px solid #e3e3e3; vertical-align: top; }
th { font-weight: 600; }
td.value { text-align: right; white-space: nowrap; }
td.outside { color: #b03000; font-weight: 600; }
.faint { color: #666; }
.warning { background: #fff4e0; padding: 0.3rem 0.6rem; margin: 0.3rem 0; }
.doubt { background: #fde4e1; border-left: 4px solid #b3261e; padding: 0.3rem 0.6rem; margin: 0.3rem 0; }
img { max-width: 100%; height: auto; }
pre { background: #f6f6f6; padding: 0.8rem; font-size: 0.8rem; overflow-x: auto; }
.long { max-height: 32rem; overflow-y: auto; }
@media print { .long { max-height: none; } pre { white-space: pre-wrap; } h2 { break-after: avoid; } }
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


def html_report(dataset: xr.Dataset, *, units: DisplayUnits | None = None) -> str:
    """Write a report as HTML: data, statistics, figures, how it was computed, and the scenario that made it.

    Runs below overhead lines are told in full, with reference models beside the ranges that they should meet; other
    results in short.

    Args:
        dataset: a result.
        units: that numbers are shown in (default: of engineering, by their size).
    """
    found, scenario = summary(dataset), scenario_of(dataset)
    body = [*_warnings(found)]
    if scenario is not None and scenario.overhead_lines:
        body += [*_data(scenario)]
    if found["pantographs"]:
        body += [*_collection(found, units)]
    else:
        body += [_section("Summary"), *_tables(_blocks(found, units))]
    label = "Contact force, heights and droppers" if is_of_overhead_line(dataset) else "Overview"
    body += [_section("Figures"), _picture(figure(dataset, units=units), label)]
    body += [*_droppers(found), *_method(dataset, found, units), _section("Scenario"), _scenario_text(dataset)]
    simulated = found["simulated"]
    outcome = found["outcome"] or "unknown outcome"
    subtitle = f"{outcome}; {number(simulated['value'])} {simulated['unit']}; {dataset.attrs.get('source', 'ropewalk')}"
    return _PAGE.substitute(title=_text(found["title"] or "Result"), subtitle=_text(subtitle), body="\n".join(body))


def _text(value: object) -> str:
    return html.escape(str(value))


def _section(title: str) -> str:
    return f"<h2>{_text(title)}</h2>"


def _table(body: Iterable[Cells], head: Cells = (), values: Sequence[int] = (1,)) -> str:
    """A table; columns of `values` are set to the right, and what is OUTSIDE or a FAIL stands out."""
    out = ["<table>"]
    if head:
        out.append("<tr>" + "".join(f"<th>{_text(cell)}</th>" for cell in head) + "</tr>")
    for row in body:
        cells = []
        for i, cell in enumerate(row):
            kind = "value" if i in values else "outside" if cell.startswith(("OUTSIDE", "FAIL")) else ""
            cells.append(f'<td class="{kind}">{_text(cell)}</td>' if kind else f"<td>{_text(cell)}</td>")
        out.append("<tr>" + "".join(cells) + "</tr>")
    return "\n".join([*out, "</table>"])


def _picture(drawn: Figure, label: str) -> str:
    stream = io.BytesIO()
    drawn.savefig(stream, format="png", dpi=DPI)
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    return f'<img alt="{_text(label)}" src="data:image/png;base64,{data}">'


def _warnings(found: Summary) -> Iterator[str]:
    if found["advice"]:
        yield f'<p class="warning">{_text(found["advice"])}</p>'
    for doubt in found["doubts"]:
        yield f'<p class="doubt">The results are unreliable: {_text(doubt)}</p>'
    for warning in found["warnings"]:
        yield f'<p class="warning">{_text(warning)}</p>'


def _data(scenario: Scenario) -> Iterator[str]:
    """What was put in, in the words of the railway."""
    from ropewalk.model.pantograph import Pantograph

    for name, line in scenario.overhead_lines.items():
        yield _section(f"Overhead line {name}")
        yield _table(_of_line(line), values=())
    for name, load in scenario.loads.items():
        if isinstance(load, Pantograph):
            yield _section(f"Pantograph {name}")
            yield _table(_of_pantograph(load), values=())


def _of_line(line: OverheadLine) -> Iterator[Cells]:
    lengths = line.span_lengths
    spans = f"{len(lengths)} of {_range(lengths)} m, {line.length:g} m in all"
    first, last = line.analysed
    low, high = analysed_stations(line)
    yield "spans", spans
    yield "analysed", f"spans {first} to {last}, {low:g} to {high:g} m"
    yield "contact wire", _of_wire(line.contact_wire)
    yield "messenger wire", _of_wire(line.messenger_wire)
    if line.stitch_wire is not None:
        yield "stitch wire", f"{line.stitch_wire.length:g} m, {_of_wire(line.stitch_wire)}"
    yield "system height", f"{line.system_height:g} m"
    if line.heights is not None:
        yield "heights of registration", f"{_several([1e3 * rise for rise in line.heights])} mm"
    if line.overlap is not None:
        yield "overlaps with", line.overlap
    yield "largest pre-sag", f"{1e3 * max((sag for row in line.sags for sag in row), default=0.0):g} mm"
    d = line.droppers
    counts = [len(row) for row in line.dropper_places]
    pushes = "none in compression" if d.pushes == 0.0 else f"{d.pushes:g} N/m in compression"
    yield "droppers", f"{_range(counts)} in each span; {d.stiffness:g} N/m in tension, {pushes}"
    mass = f"{d.mass_per_length:g} kg/m" if d.mass_per_length is not None else f"{d.mass or 0.0:g} kg"
    yield (
        "masses of droppers",
        f"{mass}; clamps {d.contact_clamp:g} kg (contact wire), {d.messenger_clamp:g} kg (messenger)",
    )
    arms = line.steady_arms
    yield "steady arms", f"{arms.moving_mass:.4g} kg moving with the wire{', hanging free' if arms.free else ', level'}"
    if line.staggers is not None:
        yield "stagger", f"{_range([1e3 * aside for aside in line.staggers])} mm"
    if line.radius is not None:
        yield "radius of the track", f"{_several(line.radius)} m (positive: to the left; 0: straight)"
    if (own := line.condition) is not None:
        gone = ", ".join(f"{span}.{number}" for span, number in own.missing_droppers) or "none"
        yield "since fitting", f"missing droppers: {gone}; wear {100 * own.wear:g} %; {own.temperature_rise:+g} K"
    stiffness = line.messenger_supports.stiffness
    along = "swinging along the line" if line.messenger_supports.swings else "held along the line"
    kind = "rigid" if stiffness is None else f"{_several(stiffness)} N/m"
    yield "messenger supports", f"{kind}, {along}"


def _of_wire(wire: OverheadWire) -> str:
    fields = f"{wire.mass:g} kg/m, {wire.tension:g} N, EI {wire.bending_stiffness:g} N m²"
    if wire.drag or wire.retardation:
        fields += f", Rayleigh damping {wire.drag:g} 1/s and {wire.retardation:g} s"
    return fields


def _of_pantograph(load: Pantograph) -> Iterator[Cells]:
    parts, speed = load.parts, load.travel.speed
    yield "model", f"{load.model}: {parts.source}" if load.model else "own"
    yield "masses", f"{_several(parts.masses)} kg, from the base to the head"
    yield "springs", f"{_several(parts.stiffness)} N/m, below each mass"
    yield "dampers", f"{_several(parts.damping)} N s/m"
    yield "contact", f"{load.contact_stiffness:g} N/m" + (" of each strip" if len(load.strips) > 1 else "")
    if load.head is not None:
        yield "head", _head(load.head)
    if load.wanted_mean is not None:
        unit = "" if isinstance(load.wanted_mean, str) else " N"
        yield "target mean force", f"{load.wanted_mean}{unit}"
    else:
        yield "static force", f"{load.pressed_with:g} N"
        if load.aerodynamic:
            yield "aerodynamic uplift", f"{load.aerodynamic:g} kg/m times the square of the speed"
    if load.irregularity is not None:
        yield "irregularity", ", ".join(f"{file} on {line}" for line, file in load.irregularities.items())
    fields = f"{3.6 * speed:g} km/h" if isinstance(speed, float) else "changes, see the scenario"
    yield "speed", fields
    yield "start", f"{load.travel.start:g} m along the line, force ramped over {load.ramp:g} s"


def _head(head: PantographHead) -> str:
    parts = ["one strip" if head.spacing is None else f"two strips {head.spacing:g} m apart"]
    for name, one in (("pitches", head.pitch), ("rolls", head.roll)):
        if one is not None:
            parts.append(f"{name} with {one.inertia:g} kg m^2 on springs {one.spring_spacing:g} m apart")
    return ", ".join(parts)


def _several(values: float | Iterable[float]) -> str:
    return f"{values:g}" if isinstance(values, int | float) else ", ".join(f"{value:g}" for value in values)


def _range(values: Sequence[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _blocks(found: Summary, units: DisplayUnits | None) -> Iterator[tuple[str, list[Cells]]]:
    """Headings of the table of the command line, each with its rows."""
    title, body = "", list[Cells]()
    for row in rows(found, units):
        if row[1]:
            body.append(row)
            continue
        if body:
            yield title, body
        title, body = row[0], []
    if body:
        yield title, body


def _collection(found: Summary, units: DisplayUnits | None) -> Iterator[str]:
    """Statistics of pantographs and lines, and reference models beside their ranges."""
    yield _section("Current collection")
    titles = {fields["acceptance"]["title"] for fields in found["pantographs"].values() if fields["acceptance"]}
    judged = {f"{fields['limits']['title']}: {name}" for name, fields in found["pantographs"].items()
              if fields["limits"]}  # fmt: skip
    wanted = [f"Pantograph {name}" for name in found["pantographs"]]
    wanted += [f"Overhead line {name}" for name in found["overhead_lines"]]
    for title, body in _blocks(found, units):
        if title in wanted:
            yield f"<h3>{_text(title)}</h3>"
            yield _table(body)
        elif title in titles:
            yield from _acceptance(title, body)
        elif title in judged:
            yield from _limits(title, body)
    fields = next(iter(found["pantographs"].values()))["filter"]
    yield (
        f'<p class="faint">Forces up to {fields["limit"]:g} Hz: {_text(fields["kind"])}, order {fields["order"]}, '
        "run forwards and backwards, -6 dB at its limit. The order of the filter moves sigma by up to 3 N; the "
        "standards leave it open.</p>"
    )
    yield _section("Forces and energy")
    above = {*wanted, *titles, *judged}
    yield from _tables((title, body) for title, body in _blocks(found, units) if title not in above)


def _limits(title: str, body: list[Cells]) -> Iterator[str]:
    *checks, (_, verdict, remark) = body
    yield f"<h3>{_text(title)}</h3>"
    yield _table(checks, ("quantity", "value", "limit"))
    yield f"<p><strong>{_text(verdict)}.</strong> <span class='faint'>{_text(remark)}.</span></p>"


def _acceptance(title: str, body: list[Cells]) -> Iterator[str]:
    *checks, (_, inside, remark) = body
    yield f"<h3>{_text(title)}</h3>"
    yield _table(checks, ("quantity", "value", "range"))
    yield (
        f"<p><strong>{_text(inside)} inside.</strong> <span class='faint'>{_text(remark)}. [F]: found in a public"
        " secondary source; [R]: recalled, not seen in the standard's own text.</span></p>"
    )


def _tables(blocks: Iterable[tuple[str, list[Cells]]]) -> Iterator[str]:
    for title, body in blocks:
        if title != "Method":
            yield f"<h3>{_text(title)}</h3>"
            yield _table(body)


def _droppers(found: Summary) -> Iterator[str]:
    for name, line in found["overhead_lines"].items():
        if not line["droppers"]:
            continue
        yield _section(f"Droppers of {name}")
        head = (
            "dropper",
            "station (m)",
            "length (m)",
            "least (N)",
            "largest (N)",
            "slack (% of the time)",
            "slack (s)",
        )
        body = [_of_dropper(label, one) for label, one in line["droppers"].items()]
        yield '<p class="faint">Over the whole run; those of the analysed spans are marked *.</p>'
        yield f'<div class="long">{_table(body, head, values=range(1, 7))}</div>'


def _of_dropper(label: str, one: dict[str, Any]) -> Cells:
    length = "–" if one["length"] is None else f"{one['length']:.3f}"
    slack = number(None if one["slack"] is None else 100 * one["slack"], 2)
    return (
        f"{label}{' *' if one['analysed'] else ''}", number(one["station"]), length, number(one["smallest"]),
        number(one["largest"]), slack, number(one["slack_time"], 2),
    )  # fmt: skip


def _method(dataset: xr.Dataset, found: Summary, units: DisplayUnits | None) -> Iterator[str]:
    yield _section("Method")
    body = [row for title, block in _blocks(found, units) if title == "Method" for row in block]
    fields = dataset.attrs
    body.append(("version", f"ropewalk {fields.get('ropewalk_version', '')}", ""))
    body.append(("SHA-256 of the scenario", str(fields.get("scenario_sha256", ""))))
    yield _table(body, values=())


def _scenario_text(dataset: xr.Dataset) -> str:
    return f"<pre>{_text(dataset.attrs.get('scenario', ''))}</pre>"
