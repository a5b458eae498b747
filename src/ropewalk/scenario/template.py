"""The files that `ropewalk new` writes: a first example to change, or the example of a trade under an own name."""

from __future__ import annotations

import json

from ropewalk.errors import Problem, ScenarioError, did_you_mean
from ropewalk.scenario.examples import TITLE, examples, title_of

_TEMPLATE = """\
# A scenario of ropewalk: lines, the loads that travel on them, and the analysis.
#   ropewalk check FILE.yaml     finds every mistake before anything is computed
#   ropewalk run FILE.yaml       computes the result and writes it as NetCDF
# A quantity is a number in SI units, or text with a unit: 100 kN, 72 km/h, 1.35 kg/m.

title: @TITLE@
gravity: 9.81 m/s^2               # acts along -z

lines:
  rope:                           # the name is yours
    start: [0 m, 0 m]             # [x, z] or [x, y, z]; x along the span, z up, y sideways
    end: [19.5 m, 0 m]
    length: 20 m                  # unstrained; or  tension: 2 kN  (mean tension in equilibrium) instead
    mass: 1 kg/m
    axial_stiffness: 100 kN       # EA
    # law: {kind: tension_only}   # default: {kind: hooke}
    axial_damping: 50 N*s         # Kelvin-Voigt: T = EA eps + c eps_t
    elements: 100                 # number of links

loads:
  walker:
    kind: force
    on: rope                      # the name of the line
    force: [0 N, -800 N]          # [Fx, Fz] or [Fx, Fy, Fz]; or a table {time: [...], value: [...]}
    travel:
      speed: 10 m/s               # or a table {time: [0 s, 1 s], value: [0 m/s, 10 m/s]}
      measured: slip              # material | slip | arc | horizontal
      from: 0 m
      # at_end: leave             # at the end of the line: refuse (default) | leave | stay

run:
  kind: dynamic                   # dynamic | quasistatic (with positions: 201) | equilibrium
  until: 1.5 s
  every: 10 ms                    # interval of output
"""


FIRST = "rope"
TRADES = {
    "ropeway": "ropeway-saddle",
    "tramway": "ropeway-tower-brake",
    "cable-crane": "cable-crane-crab",
    "zip-line": "zip-line",
    "highline": "highline-walker",
    "leash-fall": "leash-fall",
    "tightrope": "tightrope",
    "net": "trampoline-net",
    "overhead-line": "overhead-line-limits",
    "overlap": "overhead-line-overlap",
    "bridge": "bridge-biggs",
    "train": "bridge-hslm",
    "continuous-bridge": "continuous-bridge",
    "footbridge": "footbridge-crowd",
    "suspension-bridge": "suspension-footbridge",
    "string": "whirling-string",
}
"""Templates by trade, each one of the examples that come with the package."""


def trades() -> dict[str, str]:
    """Names of all templates, and what each is about."""
    titles = {trade: title_of(examples().get(example, "")) for trade, example in TRADES.items()}
    known = {trade: title for trade, title in titles.items() if title}
    return {FIRST: "A force moves along a slack rope: all keys of a first file", **known}


def template(name: str = "Moving force on a slack rope", trade: str = FIRST) -> str:
    """Write a commented scenario that runs as it is, with `name` as its title.

    Args:
        name: its title.
        trade: one of `trades`.

    Raises:
        ScenarioError: unknown template.
    """
    if trade not in trades():
        advice = did_you_mean(trade, trades(), otherwise=f"there are {', '.join(trades())}")
        raise ScenarioError([Problem("--template", "unknown template", trade, advice)])
    title = " ".join("".join(sign if sign.isprintable() else " " for sign in name).split())
    quoted = json.dumps(title or "untitled", ensure_ascii=False)
    if trade == FIRST:
        return _TEMPLATE.replace("@TITLE@", quoted)
    return TITLE.sub(lambda _: f"title: {quoted}", examples()[TRADES[trade]], count=1)
