"""What pages of the documentation take for granted, and which of their blocks a test does not do, with the reason."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path

from blocks import Part  # of this folder: see conftest.py

ROPE = "moving-force"
STRING = """\
lines:
  string: {start: [0 m, 0 m], end: [10 m, 0 m], tension: 2 kN, mass: 1.15 kg/m, axial_stiffness: 100 kN, elements: 4}
loads:
  man: {kind: force, on: string, force: [0 N, -100 N], travel: {speed: 1 m/s, from: 5 m, measured: horizontal}}
run: {kind: equilibrium}
"""
LOADED = """\
lines:
  string: {start: [0 m, 0 m], end: [10 m, 0 m], tension: 2 kN, mass: 1 kg/m, axial_stiffness: 1 MN, elements: 20}
loads:
  man: {kind: force, on: string, force: [0 N, -100 N], travel: {speed: 10 m/s, measured: horizontal}}
run: {kind: dynamic, until: crossing, every: 20 ms}
"""
FREE_ROPE = """\
lines:
  rope: {start: [0 m, 0 m], end: [30 m, 0 m], length: 30.1 m, mass: 1 kg/m, axial_stiffness: 1 MN, elements: 60}
run: {kind: dynamic, until: 1 s, every: 10 ms}
"""
HIGHLINE = FREE_ROPE.replace("rope:", "highline:")
STEPPER = "loads: {her: {kind: stepper, on: highline, model: 'careful.py:Careful'}}\n"
BEAM = """\
lines:
  beam:
    start: [0 m, 0 m]
    end: [100 m, 0 m]
    length: 100 m
    mass: 10 t/m
    bending_stiffness: 16 GN*m^2
    axial_stiffness: 10 GN
    elements: 100
run: {kind: dynamic, until: 1 s, every: 10 ms}
"""
TRACK_ROPE = """\
lines:
  track:
    start: [0 m, 0 m]
    end: [500 m, 60 m]
    end_support: {kind: guided, along: [1, 0], force: 400 kN, mass: 1 t}
    length: 503.5 m
    mass: 11.7 kg/m
    axial_stiffness: 220 MN
    elements: 1000
run: {kind: dynamic, until: 30 s, every: 50 ms, start: {with_loads: true}}
"""
WEBBING = """\
lines:
  main: {start: [0 m, 0 m], end: [63 m, 0 m], tension: 1.5 kN, mass: 60 g/m, elements: 12}
run: {kind: dynamic, until: 1 s, every: 50 ms}
"""
WALK = """\
lines:
  rope:
    start: [0 m, 0 m]
    end: [19.5 m, 0 m]
    length: 20 m
    mass: 1 kg/m
    axial_stiffness: 100 kN
    axial_damping: 1 kN*s
    law: {kind: tension_only}
    elements: 20
loads:
  walker: {kind: force, on: rope, force: [0 N, -800 N], travel: {speed: 10 m/s}}
run: {kind: dynamic, until: 1.5 s, every: 50 ms}
"""
BRIDGE = """\
gravity: 0 m/s^2
lines:
  deck:
    start: [0 m, 0 m]
    end: [20 m, 0 m]
    length: 20 m
    mass: 7 t/m
    bending_stiffness: 16 GN*m^2
    axial_stiffness: 10 GN
    elements: 10
loads:
  train: {kind: axles, on: deck, forces: 150 kN, at: [0 m, 5 m], travel: {speed: 200 km/h}}
run: {kind: dynamic, geometry: linearised, until: crossing, every: 4 ms}
"""
ROUGH = "x, z\n0, 0\n50, 0.002\n100, 0\n"
STAY = """\
gravity: 0 m/s^2
lines:
  stay: {start: [0 m, 0 m], end: [10 m, 0 m], tension: 1 kN, mass: 1.15 kg/m, axial_stiffness: 100 kN, elements: 20}
run: {kind: equilibrium}
"""
MEASURED = "quantity, value, deviation\nfrequency 1, 2.08 Hz, 0.01 Hz\nfrequency 2, 4.14 Hz, 0.01 Hz\n"
TWO_SPANS = """\
overhead_lines:
  line:
    spans: {count: 2, length: 55 m}
    contact_wire: {mass: 1.07 kg/m, tension: 15 kN}
    messenger_wire: {mass: 0.6 kg/m, tension: 10 kN}
    droppers: {per_span: 7}
    system_height: 1.4 m
    analysed_spans: [1, 2]
loads: {front: {kind: pantograph, on: line, model: en50318-2002, static_force: 100 N, travel: {speed: 20 m/s}}}
run: {kind: dynamic, geometry: linearised, until: 1 s, every: 50 ms}
"""
NETWORK = """\
lines:
  left: {mass: 1 kg/m, axial_stiffness: 1 MN, elements: 54}
  hanger: {end: [5 m, -2 m], length: 4.3 m, mass: 1 kg/m, axial_stiffness: 1 MN, elements: 20}
  hoist: {length: 15 m, mass: 1 kg/m, axial_stiffness: 1 MN, elements: 60}
run: {kind: equilibrium}
"""


def fmu(variables: dict[str, tuple[str, str]]) -> bytes:
    """A file that is described as an FMU, and has no code: of variables their attributes and type."""
    described = "".join(
        f'<ScalarVariable name="{name}" valueReference="{k}" {kind[0]}><{kind[1]}/></ScalarVariable>'
        for k, (name, kind) in enumerate(variables.items())
    )
    with zipfile.ZipFile(buffer := io.BytesIO(), "w") as archive:
        archive.writestr(
            "modelDescription.xml",
            '<fmiModelDescription fmiVersion="2.0" modelName="coach" guid="coach">'
            '<CoSimulation modelIdentifier="coach"/>'
            f"<ModelVariables>{described}</ModelVariables><ModelStructure/></fmiModelDescription>",
        )
        for folder in ("linux64/coach.so", "win64/coach.dll", "darwin64/coach.dylib"):
            archive.writestr(f"binaries/{folder}", "")
    return buffer.getvalue()


TUNABLE = 'causality="parameter" variability="tunable"'
OUTPUT, INPUT, STATE = (f'causality="{kind}"' for kind in ("output", "input", 'local" initial="exact'))
AXLE = {"N": (OUTPUT, "Real"), "z": (INPUT, "Real"), "vz": (INPUT, "Real")}
COACH = {f"{axle}.{name}": kind for axle in ("frontAxle", "rearAxle") for name, kind in AXLE.items()} | {
    "bodyMass": (TUNABLE, "Real"),
    "frontAxle.linear": (TUNABLE, "Boolean"),
    "bodySpeed": (STATE, "Real"),
}

FILES: dict[str, dict[str, str | bytes]] = {
    "adequacy.md": {"string.yaml": LOADED},
    "design.md": {"string.yaml": STRING},
    "fit.md": {"stay.yaml": STAY, "measured.csv": MEASURED},
    "file/lines.md": {"measured.csv": ROUGH},
    "fmi.md": {"coach.fmu": fmu(COACH)},
    "overhead-lines.md": {"rough.csv": ROUGH},
    "sweep.md": {"rope.yaml": WALK, "bridge.yaml": BRIDGE},
}
"""What files hold of which a page only says the name; a word alone is an example."""

CAPTIONS = {"README.md": {"title: Moving force": "rope.yaml"}}
"""Names of files that other programs, which show the page, would not show."""

OVERHEAD = Part("overhead-line-limits", "overhead_lines.line")
PARTS = {
    "bridges.md": {
        "lines:": Part("bridge-ballasted-track"),
        "loads:": Part("bridge.yaml"),
        "sweep:": Part("bridge.yaml"),
    },
    "file/lines.md": {
        "segments:": Part(BEAM, "lines.beam"),
        "lines:\n": Part("highline-backup-cut"),
        "profile:": Part(BEAM, "lines.beam"),
    },
    "file/loads.md": {"loads:": Part(FREE_ROPE)},
    "file/nets.md": {"nets:": Part("run: {kind: equilibrium}\n")},
    "file/networks.md": {"joints:": Part(NETWORK), "hangers:": Part("suspension-bridge")},
    "file/ropeways.md": {"kind: carriage": Part(TRACK_ROPE + "loads: {car: {}}\n", "loads.car")},
    "file/supports.md": {
        "end_support:": Part(FREE_ROPE, "lines.rope"),
        "supports:": Part(BEAM, "lines.beam"),
        "saddles:": Part("ropeway-saddle", "lines.track"),
    },
    "file/tracks.md": {"tracks:": Part("bridge-ballasted-track")},
    "file/wind.md": {
        "wind:": Part(FREE_ROPE.replace("0 m]", "0 m, 0 m]").replace("elements: 60", "elements: 60, wind_drag: 20 mm"))
    },
    "fmi.md": {"loads:": Part(BEAM.replace("beam", "bridge"))},
    "highlines.md": {"law:": Part(WEBBING, "lines.main")},
    "overhead-lines.md": {
        "overhead_lines:": Part("overhead-line-overlap"),
        "radius:": Part(TWO_SPANS, "overhead_lines.line"),
        "droppers:": Part("overhead-line-dropper-failure", "overhead_lines.line"),
        "ends:": OVERHEAD,
        "irregularity:": Part("overhead-line-limits", "loads.front"),
        "head:": Part("overhead-line-head", "loads.front"),
        "limits:": OVERHEAD,
        "sweep:": Part("overhead-line-limits"),
        "loads:": Part(TWO_SPANS.replace("count: 2", "count: 10")),
    },
    "ropeways.md": {
        "loads:": Part(TRACK_ROPE),
        "haul:": Part("ropeway-counter-rope", "loads.car"),
        "end_support:": Part(FREE_ROPE, "lines.rope"),
    },
    "steppers.md": {"loads:": Part(HIGHLINE), "every:": Part(HIGHLINE + STEPPER, "loads.her")},
    "sweep.md": {"sweep:": Part("rope.yaml")},
    "tutorials/overhead-line.md": {"loads:": Part("line.yaml")},
    "tutorials/own-fmu.md": {"loads:": Part("bridge.yaml")},
}
"""What parts of scenarios are parts of, by how the block begins."""

COARSE = '["loads.walker.friction=null", "loads.walker.travel.speed=5", "lines.rope.elements=20", "run.positions=21"]'
SHORTER = {
    "adequacy.md": {
        "0.1:0.9:9": "0.3:0.5:2", "0.003:0.3:9:log": "0.03:0.3:2:log",
        "0.1, 0.9, 9": "0.3, 0.5, 2", "0.003, 0.3, 9": "0.03, 0.3, 2",
    },
    "compare.md": {'["loads.walker.friction=null"]': COARSE},
    "overhead-lines.md": {"until: 5.9 s": "until: 0.1 s"},
    "steppers.md": {'until="10 s"': 'until="1 s"'},
    "sweep.md": {"2:10:1 m/s": "2:10:8 m/s", "--count 128": "--count 2"},
}  # fmt: skip
"""What a test does with fewer cases, or coarser, by the text that stands for it."""

RECORDED = "by tests/docs/test_benchmarks_page.py"
MACHINE = "sets up a machine"
OTHERS = "a file of the reader's"
TOLD = "told of an FMU that is broken so, in tests/external"
FILM = "a film takes long"


def _recorded() -> list[str]:
    """First lines of the tables that benchmarks have printed."""
    tables = Path(__file__).parents[2] / "benchmarks" / "tables"
    return [json.loads(kept.read_text(encoding="utf-8"))["texts"][0].split("\n")[0] for kept in tables.glob("*.json")]


UNSEEN = {
    "README.md": {"make demo": MACHINE},
    "benchmarks.md": dict.fromkeys(_recorded(), RECORDED),
    "bridges.md": {"ropewalk sweep": "takes minutes; tests/sweeps have its kind"},
    "compare.md": {
        "$ ropewalk compare my.yaml": OTHERS,
        "$ ropewalk compare examples/tightrope.yaml": "takes 13 s of CPU",
        "linear  quasi-static    full": "what these 13 s print",
    },
    "design.md": {
        "ropewalk design line.yaml": "31 runs of an overhead line",
        "ropewalk design ropeway.yaml": "25 runs over a saddle",
    },
    "fit.md": {"quantity, value, deviation              time": "two files beside one another"},
    "fmi-export.md": {"pip": MACHINE},
    "fmi.md": {"loads.coach.contacts": TOLD, "load coach: its FMU": TOLD},
    "footbridges.md": {"N = 8 pi": "a formula"},
    "models.md": {"$ ropewalk compare my.yaml": OTHERS},
    "overhead-lines.md": {
        "ropewalk show line.nc": FILM,
        "ropewalk sweep examples": "three runs of an overhead line",
        "from first to second": "of the example, in tests/test_examples.py",
    },
    "resume.md": {"ropewalk resume OUT.nc": OTHERS},
    "ropeways.md": {"ropewalk design tower.yaml": "24 runs over a saddle"},
    "start.md": {"$ python3 -m venv": MACHINE},
    "studio.md": {"pip": MACHINE, "import ropewalk": "needs the built page of the studio; tests/studio have it"},
    "tutorials/highline.md": {"$ ropewalk show fall.nc -o fall.gif": FILM},
    "tutorials/own-fmu.md": {"$ pip": MACHINE},
    "tutorials/ropeway.md": {"$ ropewalk show stop.nc -o stop.gif": FILM},
}
"""Blocks that are read and not done, by how they begin, with the reason."""
