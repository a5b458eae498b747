"""Small structures for tests of the core. Their numbers come from sums, products and quotients alone, so that they have
the same bits everywhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, ContactProperties, FreePlayProperties, RunProperties, SpringProperties

Array = NDArray[np.float64]
ROPE = RunProperties(link_length=0.5, line_mass=1.0, axial_stiffness=1e4)


def parabola(begin: float, end: float, links: int, sag: float, axes: int = 2) -> Array:
    """Points of a parabola in the vertical plane, or askew in space."""
    part = np.arange(links + 1) / links
    x, z = begin + (end - begin) * part, -4.0 * sag * part * (1.0 - part)
    return np.array([x, z]) if axes == 2 else np.array([x, 0.3 * z * (1.0 - 2.0 * part), z])


def rope(links: int = 40, axes: int = 2, run: RunProperties = ROPE, sag: float = 0.8) -> Bound:
    """A rope that hangs between two held nodes, 1 % shorter than its links are long."""
    builder = Builder(axes)
    builder.fix(*builder.add_run(parabola(0.0, 0.99 * links * run.link_length, links, sag, axes), run))
    if run.taut:
        builder.fix(*range(links + 1), axes=range(axes - 1))
    return Bound(*builder.build())


def bridge(axes: int = 2, damping: float = 0.0, ties: bool = True, force: float = 0.0) -> Bound:
    """A cable with clamps, a deck with bending stiffness in two joined runs, and hangers, which push unless `ties`."""
    builder, span = Builder(axes), 24.0
    cable, _ = (ends := builder.add_run(parabola(0.0, span, 24, 2.0, axes), RunProperties(1.02, 2.0, 3e5, damping)))
    builder.fix(*ends)
    flat = parabola(0.0, span, 24, 0.0, axes)
    flat[-1] -= 3.0
    deck = RunProperties(1.0, 5.0, 8e5, damping, 4e3, tension_only=False)
    first, middle = builder.add_run(flat[:, :13], deck)
    again, last = builder.add_run(flat[:, 12:], deck)
    builder.fix(first, last)
    builder.join(again, middle)
    if force:
        builder.add_force(1, [*[0.0] * (axes - 1), force], 2.0, 30.0)
    hanger = SpringProperties(2e4, 1.5, damping, tension_only=ties)
    for k in range(3, 24, 3):
        builder.add_mass(cable + k, 4.0)
        builder.add_spring(cable + k, first + k if k < 12 else again + k - 12, hanger)
    return Bound(*builder.build())


def tripod(axes: int = 3, damping: float = 0.0, ties: bool = True) -> Bound:
    """Three runs of straight links that meet in a node with a mass, which hangs on a spring from a held one."""
    builder = Builder(axes)
    top, knot = builder.add_node([0.0] * (axes - 1) + [2.0], 0.0), builder.add_node([0.0] * axes, 3.0)
    builder.fix(top)
    builder.add_spring(top, knot, SpringProperties(500.0, 1.9, damping))
    corners = ([4.0, 0.0, 0.5], [-2.0, 3.0, 0.3], [-2.0, -3.0, 0.0])
    for corner, links in zip(corners, (9, 6, 4), strict=True):
        end = np.array([*corner[: axes - 1], corner[-1]])
        points = end.reshape(-1, 1) * (np.arange(links + 1) / links)
        length = float(np.sqrt(sum(float(x) * float(x) for x in end))) / links
        run = RunProperties(length * 1.001, 0.5, 2e4, damping, curved=False, tension_only=ties)
        begin, held = builder.add_run(points, run)
        builder.fix(held)
        builder.join(begin, knot)
    return Bound(*builder.build())


def taut_lines(axes: int = 2, damping: float = 0.0) -> Bound:
    """Two taut lines above each other, which move upwards only: droppers, masses, inner supports."""
    builder, links = Builder(axes), 267
    along = np.zeros((axes, links + 1))
    along[0] = 0.5 * np.arange(links + 1)
    run = RunProperties(0.5, 1.2, 0.0, bending_stiffness=20.0, tension=2e4, taut=True)
    low, _ = builder.add_run(along, run)
    along[-1] += 1.0
    high, _ = builder.add_run(along, replace(run, tension=1.6e4))
    builder.fix(*range(high + links + 1), axes=range(axes - 1))
    builder.fix(low, low + links, high, high + 129, high + links - 1, high + links)
    for k in range(10, links, 13):
        builder.add_spring(low + k, high + k, SpringProperties(1e5, 0.997, damping, tension_only=True))
        builder.add_mass(low + k, 0.2 * (k % 2))
    return Bound(*builder.build())


def loaded(axes: int = 2, run: RunProperties = ROPE, place: float = 17.2) -> Bound:
    """A rope in two runs under a force, a clamped mass that comes to the joint, and a head that is pushed against the
    rope from below. A force at 22.2 links shares links with the mass."""
    builder, places = Builder(axes), parabola(0.0, 19.8, 40, 0.8, axes)
    first, _ = (left := builder.add_run(places[:, :25], replace(run, continues=True)))
    again, last = builder.add_run(places[:, 24:], run)
    builder.fix(first, last)
    builder.join(again, left[1])
    mass, head = builder.add_node(places[:, 23], 5.0), builder.add_node(places[:, 32], 2.0)
    builder.fix(head, axes=range(axes - 1))
    builder.push(head, [*[0.0] * (axes - 1), 60.0])
    builder.add_force(0, [*[0.0] * (axes - 1), -150.0], place * run.link_length, 6.0)
    builder.add_contact(0, mass, 23.0 * run.link_length, 12.0)
    builder.add_contact(1, head, 8.0 * run.link_length, 0.0, ContactProperties(2e4, "below", True))
    model, state = builder.build(step=2.0**-13)
    state.velocity[0, mass] = 12.0
    return Bound(model, state)


def loose(axes: int = 2, damping: float = 0.0) -> Bound:
    """A rope with a mass on each of three springs with free play: taut, inside their play, and pushed."""
    builder = Builder(axes)
    run = RunProperties(0.5, 1.0, 1e4, damping)
    points = parabola(0.0, 5.94, 12, 0.4, axes)
    builder.fix(*builder.add_run(points, run))
    for node, drop in ((3, 1.3), (6, 1.0), (9, 0.7)):
        bob = builder.add_node(points[:, node] - np.array([*[0.0] * (axes - 1), drop]), 2.0)
        builder.add_free_play(node, bob, FreePlayProperties(3000.0, 0.9, 0.2))
    return Bound(*builder.build())


def net(
    cells: tuple[int, int] = (5, 4),
    pull: float = 20.0,
    damping: float = 0.0,
    free: bool = False,
    force: float = 0.0,
    EA: float = 2e3,
    side: float = 1.0,
    parts: int = 1,
) -> Bound:
    """A square net of straight threads under a tension, sagged by an eighth; its rim is held unless `free`,
    when it pushes, too.

    Args:
        cells: along the threads and across them.
        pull: tension of a thread, N.
        damping: EA times the retardation time, N s.
        free: no rim is held, and there is no gravity.
        force: down, on a thread in the middle, N.
        EA: of a thread, N.
        side: of a cell, m.
        parts: that threads may share.
    """
    builder, (across, rows) = Builder(3, gravity=0.0 if free else 9.81), cells
    h = side / (1.0 + pull / EA)
    thread = RunProperties(h, 0.4, EA, damping, tension_only=not free, curved=False)
    link = SpringProperties(EA / h, h, damping / h, tension_only=not free)
    y, firsts = np.arange(across + 1) / across, list[int]()
    for row in range(rows + 1):
        z = -2.0 * side * y * (1.0 - y) * row / rows * (1.0 - row / rows)
        first, last = builder.add_run(np.array([across * side * y, np.full(across + 1, row * side), z]), thread)
        if not free:
            builder.fix(*(range(first, last + 1) if row in (0, rows) else (first, last)))
        for node in range(first + 1, last):  # threads across, of the same mass
            builder.add_mass(node, 0.4 * h)
        firsts.append(first)
    for row in range(rows):  # one of them from its end to its beginning
        sides = firsts[row : row + 2] if row else firsts[1::-1]
        builder.add_band(sides[0] + 1, sides[1] + 1, across - 1, link)
    if force:
        builder.add_force(rows // 2, [0.0, 0.0, -force], 0.3 * side, 2.0)
    return Bound(*builder.build(parts))


def over_sheaves(axes: int = 2, damping: float = 0.0, friction: float = 0.0, speed: float = 5.0) -> Bound:
    """A rope that runs over two sheaves, of which the second hangs on a spring, between two masses."""
    builder, run = Builder(axes), RunProperties(0.5, 1.0, 1e4, damping)
    along = np.array([1.0, 0.0] if axes == 2 else [0.8, 0.6, 0.0])[:, None]
    up = np.array([0.0] * (axes - 1) + [1.0])[:, None]
    corner = 3.0 * along
    begin, block, top = (builder.add_node(at[:, 0], 2.0) for at in (0.0 * up, corner, corner + 1.5 * up))
    builder.fix(begin, top)
    builder.add_spring(block, top, SpringProperties(2e3, 1.4, damping))
    first, _ = builder.add_run(up * (0.5 * np.arange(-6, 1) - 0.3), run)
    builder.add_run(along * (0.7 + 0.5 * np.arange(5)), run)
    builder.add_sheave(begin, friction, 0.3)
    _, last = builder.add_run(corner - up * (0.7 + 0.5 * np.arange(6)), run)
    builder.add_sheave(block, friction, 0.3)
    builder.add_mass(first, 2.0)
    builder.add_mass(last, 3.0)
    model, state = builder.build()
    state.velocity[0, model.sheave_split] = -speed
    for number, way in enumerate((up, along, -up)):
        begin = state.run_first[number]
        state.velocity[:, begin : begin + state.run_links[number] + 1] = speed * way
    return Bound(model, state)


def collected(kind: str = "taut", inner: int = 1, links: int = 40) -> Bound:
    """Two taut strings of 10 m above each other, with springs between them and a body that presses on the lower one."""
    builder, h = Builder(inner_steps=inner, samples=64, watched=[12]), 10.0 / links
    for height in (0.0, 1.0):
        if kind == "taut":
            run = RunProperties(h, 0.5, 0.0, bending_stiffness=3.0, curved=False, tension=1000.0, taut=True)
        else:
            run = RunProperties(h / 1.01, 0.5, 1e5, bending_stiffness=3.0, curved=False)
        first, last = builder.add_run(np.array([h * np.arange(links + 1), np.full(links + 1, height)]), run)
        builder.fix(first, last)
        builder.fix(*range(first, last + 1) if kind == "taut" else (), axes=[0])
    for node in range(4, links, 8):
        builder.add_spring(node, links + 1 + node, SpringProperties(800.0, 0.8))
    ground, body = builder.add_node([2.1, -1.0], 0.0), builder.add_node([2.1, 0.02], 0.7)
    builder.fix(ground)
    builder.fix(body, axes=[0])
    builder.add_spring(ground, body, SpringProperties(300.0, 1.1, 2.0))
    builder.add_collector(0, body, 3000.0)
    bound = Bound(*builder.build())
    bound.state.velocity[0, [ground, body]] = bound.state.predicted[0, [ground, body]] = 12.0
    return bound


STRUCTURES = {
    "rope": rope, "rope in space": lambda: rope(axes=3, links=300),
    "straight links": lambda: rope(run=RunProperties(0.5, 1.0, 1e4, curved=False), links=133),
    "damped": lambda: rope(run=RunProperties(0.5, 1.0, 1e4, 20.0, 2.0), links=131),
    "tension only": lambda: rope(run=RunProperties(0.5, 1.0, 1e4, tension_only=True), links=257),
    "bridge": bridge, "damped bridge in space": lambda: bridge(3, 30.0),
    "bridge under a force": lambda: bridge(force=-500.0), "tripod": tripod, "damped tripod": lambda: tripod(2, 5.0),
    "over sheaves": over_sheaves, "damped over sheaves in space": lambda: over_sheaves(3, 10.0),
    "plain bending": lambda: rope(run=RunProperties(0.5, 1.0, 1e4, 0.0, 30.0, curved=False), links=131),
    "damped plain bending": lambda: rope(axes=3, run=RunProperties(0.5, 1.0, 1e4, 9.0, 30.0, curved=False)),
    "taut lines": taut_lines, "collector": collected, "collector on plain links": lambda: collected("plain"),
    "damped droppers in space": lambda: taut_lines(3, 40.0),
    "loads": loaded, "loads in space": lambda: loaded(3, RunProperties(0.5, 1.0, 1e4, 20.0, 40.0)),
    "loads on straight links": lambda: loaded(2, RunProperties(0.5, 1.0, 1e4, tension_only=True, curved=False)),
    "loads that share links": lambda: loaded(place=22.2),
    "free play": loose, "damped free play in space": lambda: loose(3, 20.0),
    "net under a force": lambda: net((9, 4), force=50.0),
    "damped free net": lambda: net((142, 3), damping=0.7, free=True, side=0.25),
}  # fmt: skip
"""One of each kind: both dimensions, links of both kinds, damped or not, joints, springs, blocks that end anywhere."""


def step_of(bound: Bound) -> float:
    """Return a third of the largest stable step, s, from a bound by the rows of K."""
    rows = np.abs(bound.linearise().stiffness).sum(axis=1)
    return float(0.6 / np.sqrt((np.asarray(rows).ravel() * bound.model.mobility.ravel()).max()))
