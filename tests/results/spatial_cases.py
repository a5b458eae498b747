"""Results in space made from formulas: a whirling string, a small suspension bridge, nets with and without ropes."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import travelling_wave as wave

from ropewalk.results import Frame, Layout, Recorder, RunInfo
from ropewalk.results.frame import ENERGY_FORMS

TIMES = np.linspace(0.0, 2.0, 21)


def frame(plan: Layout, time: float, position: np.ndarray, **given: object) -> Frame:
    """A frame with these entries and zeros for the rest, or NaN where nothing can be known."""
    axes, contacts, links = len(plan.axes), len(plan.contact_load), len(plan.link_line)
    values: dict[str, object] = {
        "velocity": np.zeros_like(position),
        "tension": np.zeros(links),
        "strain": np.zeros(links),
        "contact_position": np.full((contacts, axes), np.nan),
        "contact_force": np.zeros((contacts, axes)),
        "hold_force": np.zeros((contacts, axes)),
        "contact_xi": np.full(contacts, np.nan),
        "contact_speed": np.zeros(contacts),
        "contact_tension": np.full((contacts, 2), np.nan),
        "contact_friction": np.full(contacts, np.nan),
        "contact_state": np.full(contacts, 3.0),
        "contact_in_air": np.zeros(contacts),
        "friction_power": np.zeros(contacts),
        "body_position": np.full((len(plan.body), axes), np.nan),
        "body_velocity": np.zeros((len(plan.body), axes)),
        "reaction": np.zeros((len(plan.support), axes)),
        "energy": np.zeros(len(ENERGY_FORMS)),
        **({"cell_tension": np.full((len(plan.cell), 2), np.nan)} if plan.cell else {}),
        **given,
    }
    return Frame(path=time, position=position, **{name: np.asarray(value) for name, value in values.items()})


def energy(time: float) -> np.ndarray:
    """Something stored, damped and done, and little missing."""
    message = {"kinetic": 20.0, "elastic": 60.0, "gravitational": -50.0, "line_damping": 5.0, "load_work": 35.0}
    swing = {"kinetic": np.sin(np.pi * time) ** 2, "line_damping": time, "load_work": time}
    out = [message.get(form, 0.0) * swing.get(form, np.sin(0.5 * np.pi * time)) for form in ENERGY_FORMS]
    out[ENERGY_FORMS.index("imbalance")] = 0.01 * np.sin(9.0 * time)
    return np.array(out)


def record(plan: Layout, frames: Iterable[Frame], title: str, file=None):
    with Recorder(plan, wave.scenario(title), RunInfo(method="verlet", reason="made up"), file) as recorder:
        for entry in frames:
            recorder.append(entry)
    return recorder.close()


def layout(lines: dict[str, int], nodes: int = 0, net: str = "net", axes: str = "xyz", **more: object) -> Layout:
    """Lines with so many links of 1 m each, then the nodes of a net."""
    empty = np.zeros(0)
    return Layout(
        axes=tuple(axes),
        node_line=tuple(name for name, n in lines.items() for _ in range(n + 1)) + (net,) * nodes,
        node_xi=np.concatenate([empty, *(np.arange(n + 1.0) for n in lines.values()), np.full(nodes, np.nan)]),
        link_line=tuple(name for name, n in lines.items() for _ in range(n)),
        link_xi=np.concatenate([empty, *(np.arange(n) + 0.5 for n in lines.values())]),
        contact_load=more.pop("loads", ()),
        support=more.pop("supports", ()),
        **more,
    )


def whirl(times=TIMES, file=None, links: int = 30):
    """A string of 12 m between its supports that goes round with an amplitude of 0.8 m, sagging by 0.3 m."""
    plan = layout({"string": links}, supports=("string.start", "string.end"))
    x = np.linspace(0.0, 12.0, links + 1)
    form = np.sin(np.pi * x / 12.0)

    def at(time: float) -> Frame:
        turn = np.pi * time
        place = np.stack((x, 0.8 * np.cos(turn) * form, 0.8 * np.sin(turn) * form - 0.3 * form), axis=1)
        pull = np.full(links, 400.0) + 30.0 * np.sin(turn) * np.cos(np.pi * plan.link_xi / links)
        energy = np.zeros(len(ENERGY_FORMS))
        energy[:3] = 20.0, 5.0 * np.sin(turn) ** 2, 9.0 * np.sin(turn)
        side = np.array([[-400.0, 40 * np.cos(turn), 60.0], [400.0, 40 * np.cos(turn), 60.0]])
        return frame(plan, float(time), place, tension=pull, strain=pull / 1e5, reaction=side, energy=energy)

    return record(plan, map(at, times), "Whirling string", file)


def bridge(times=TIMES, file=None, path: str = "time"):
    """Two cables of 60 m with hangers that carry a deck, whose middle a walker pushes sideways."""
    span, hung, links = 60.0, 11, 24
    hangers = {f"hanger {side}{k}": 1 for side in "ab" for k in range(hung)}
    plan = layout(
        {"cable a": links, "cable b": links, "deck": links, **hangers},
        loads=("walker",), body=("walker.body",), path=path,
        supports=tuple(f"{line}.{end}" for line in ("cable a", "cable b", "deck") for end in ("start", "end")),
    )  # fmt: skip
    x = np.linspace(0.0, span, links + 1)
    at_hanger = np.linspace(0, links, hung + 2).round().astype(int)[1:-1]

    def at(time: float) -> Frame:
        here = 3.0 + 27.0 * time
        push = 0.25 * np.sin(3.0 * time) * np.sin(np.pi * x / span)
        dip = 0.8 * np.exp(-(((x - here) / 9.0) ** 2)) * np.sin(np.pi * x / span)
        cables = [
            np.stack((x, y + push, 6.0 - 24.0 * x * (span - x) / span**2 + 0.2 - dip), axis=1) for y in (-1.5, 1.5)
        ]
        deck = np.stack((x, push, -1.0 + 3.0 * x * (span - x) / span**2 - dip), axis=1)
        hanging = [np.stack((cable[k], deck[k])) for cable in cables for k in at_hanger]
        spot = np.array([[np.interp(here, x, deck[:, a]) for a in range(3)]])
        pull = np.concatenate(
            (
                *(2000.0 + 40 * np.abs(x[1:] - 30.0) for _ in "ab"),
                np.full(links, 150.0),
                80.0 + 50.0 * np.sin(np.arange(2 * hung)),
            )
        )
        return frame(
            plan, float(time), np.concatenate((*cables, deck, *hanging)), tension=pull, strain=pull / 1e6,
            contact_position=spot, contact_force=[[0.0, 60.0 * np.sin(9.0 * time), -800.0]], contact_xi=[here],
            contact_speed=[27.0], contact_tension=[[150.0, 140.0]], body_position=spot + np.array([0.0, 0.0, 1.1]),
            reaction=np.tile([1500.0, 10.0 * time, 700.0], (6, 1)), energy=energy(time),
        )  # fmt: skip

    return record(plan, map(at, times), "Suspension footbridge with a walker", file)


def grid(side: int) -> tuple[tuple[int, int, int], ...]:
    """Triangles of a square grid of side x side nodes."""
    return tuple(
        corner
        for i in range(side - 1)
        for j in range(side - 1)
        for a in [i * side + j]
        for corner in ((a, a + 1, a + side), (a + 1, a + side + 1, a + side))
    )


def net(times=TIMES, file=None, side: int = 13, ropes: bool = False, length: float = 6.0, known: bool = True):
    """A square net clamped at its edge that a mass crosses; with ropes, its corners hang from masts."""
    masts = {f"rope {k}": 4 for k in range(4)} if ropes else {}
    before = sum(n + 1 for n in masts.values())
    cells = tuple(tuple(before + n for n in cell) for cell in grid(side))
    plan = layout(
        masts, side * side, "net", loads=("person",), cell=cells, cell_net=("net",) * len(cells),
        supports=tuple(f"{rope}.start" for rope in masts),
    )  # fmt: skip
    u = np.linspace(0.0, length, side)
    x, y = (part.ravel() for part in np.meshgrid(u, u, indexing="ij"))
    edge = np.sin(np.pi * x / length) * np.sin(np.pi * y / length)

    def height(x, y, time):
        near = np.hypot(x - length * (0.1 + 0.4 * time), y - length * (0.2 + 0.3 * time))
        return -0.15 - np.exp(-((near / (0.18 * length)) ** 2)) * 0.2 * length

    def at(time: float) -> Frame:
        place = np.stack((x, y, edge * height(x, y, time)), axis=1)
        spot = np.array([length * (0.1 + 0.4 * time), length * (0.2 + 0.3 * time)])
        deep = np.prod(np.sin(np.pi * spot / length)) * height(*spot, time)
        corners = place[[0, side - 1, side * side - side, side * side - 1]]
        tips = corners + (np.sign(corners - place.mean(axis=0)) * [0.4, 0.4, 0.0] + [0, 0, 0.3]) * length
        hanging = [np.linspace(tip, corner, 5) for tip, corner in zip(tips, corners, strict=True)] if ropes else []
        nodes = np.concatenate([*hanging, place])
        middle = nodes[np.array(cells)].mean(axis=1)
        far = np.hypot(middle[:, 0] - spot[0], middle[:, 1] - spot[1])
        pull = 300.0 + 1500.0 * np.exp(-((far / (0.2 * length)) ** 2))
        given = {"cell_tension": np.stack((pull, 0.6 * pull * np.cos(middle[:, 0]) - 200.0), axis=1)} if known else {}
        return frame(
            plan, float(time), nodes, contact_position=[[*spot, deep]], contact_force=[[0.0, 20.0, -700.0]],
            tension=np.repeat(np.linspace(800, 1500, 4), 4) if ropes else [], contact_speed=[1.0],
            reaction=np.tile([100.0, 50.0, 300.0 + time], (len(plan.support), 1)),
            energy=energy(time), **given,
        )  # fmt: skip

    return record(plan, map(at, times), "A person crosses a net", file)
