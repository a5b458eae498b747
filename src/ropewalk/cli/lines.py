"""Commands that tell of a line before anything runs along it."""

from __future__ import annotations

from importlib import import_module
from typing import Annotated, Any

import typer

from ropewalk.cli.console import fail, load_scenario, print_columns, print_json, quantity_of, reported
from ropewalk.cli.options import Json, ScenarioFile, Settings


def elasticity(
    file: ScenarioFile,
    force: Annotated[str, typer.Option("--force", help="Upward force on the contact wire.")] = "100 N",
    span: Annotated[int | None, typer.Option("--span", help="Its number [default: the first analysed].")] = None,
    side_load: Annotated[
        str, typer.Option("--side-load", metavar="N/m", help="Lateral wind force on the contact wire, per length.")
    ] = "0 N/m",
    settings: Settings = None,
    as_json: Json = False,
) -> None:
    """Elasticity and wave speeds of overhead lines. Also reflection, Doppler factor, amplification and wind."""
    with reported():
        scenario = load_scenario(file, settings)
        if not scenario.overhead_lines:
            fail(f"{file}: has no overhead line; use ropewalk spectrum for other lines")
        push, load = quantity_of(force, "N"), quantity_of(side_load, "N/m")
        if push <= 0.0:
            fail(f"--force {force}: write a force above 0 N")
        if load < 0.0:
            fail(f"--side-load {side_load}: write 0 N/m or more; both directions are evaluated")
        for name, line in scenario.overhead_lines.items():
            if span is not None and not 1 <= span <= len(line.span_lengths):
                fail(f"--span {span}: overhead line {name} has spans 1 to {len(line.span_lengths)}")
        found = import_module("ropewalk.overhead.properties").properties(scenario, push, span, load)
        if as_json:
            print_json(found)
            return
        for name, values in found.items():
            print_columns(_rows(name, values))


def _rows(name: str, found: dict[str, Any]) -> list[tuple[str, ...]]:
    own, waves, pulls = found["elasticity"], found["wave_speed"], found["tension"]
    rows: list[tuple[str, ...]] = [
        (f"overhead line {name}", ""),
        (f"elasticity under {own['force']:g} N", f"{1e3 * own['least']:.3f} to {1e3 * own['largest']:.3f} mm/N"),
        ("non-uniformity of elasticity", f"{100 * own['non_uniformity']:.1f} %"),
        (
            "tensions, contact wire and messenger",
            f"{1e-3 * pulls['contact']:.2f} and {1e-3 * pulls['messenger']:.2f} kN",
        ),
        ("wave speed of the contact wire", f"{3.6 * waves['contact']:.1f} km/h"),
        ("wave speed of the messenger", f"{3.6 * waves['messenger']:.1f} km/h"),
        ("reflection at droppers", f"{found['reflection']:.3f}"),
    ]
    for key, factors in found["pantographs"].items():
        gain = factors["amplification"]
        rows += [
            (f"Doppler factor of {key}", f"{factors['doppler']:.3f} at {3.6 * factors['speed']:.1f} km/h"),
            (f"amplification of {key}", "it is faster than the waves" if gain is None else f"{gain:.2f}"),
        ]
    load, value = found["wind_deflection"]["load"], found["wind_deflection"]["value"]
    if load or value:
        rows.append((f"lateral deflection of the contact wire under {load:g} N/m", f"at most {1e3 * value:.0f} mm"))
    forces, strip = [abs(force) for force in found["arms"].values()], found["strip"]
    if any(forces):
        rows.append(("lateral force of the steady arms", f"{min(forces):.0f} to {max(forces):.0f} N"))
        for begin, end, share in zip(strip["edges"], strip["edges"][1:], strip["share"], strict=False):
            rows.append((f"contact on the head, {1e3 * begin:.0f} to {1e3 * end:.0f} mm", f"{100 * share:.1f} %"))
    return rows
