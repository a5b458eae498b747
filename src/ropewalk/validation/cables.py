"""Cables under their weight and under loads at rest, and their small motions."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.theory import bead, cable, highline, locus, rope
from ropewalk.validation.known_case import KnownCase, frequencies
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.publication import Publication

G = 9.81
IRVINE_1974 = Publication(
    "H. M. Irvine and T. K. Caughey, The linear theory of free vibrations of a suspended cable, Proc. R. Soc. Lond. A "
    "341 (1974), 299-315",
    "authors and subject, in later papers that cite it; volume and pages from memory",
)
IRVINE = Publication("H. M. Irvine, Cable Structures, MIT Press, 1981: the elastic catenary")
ELASTIC: dict[str, Any] = {"span": 200.0, "height": 20.0, "length": 205.0, "weight": 3.0 * G, "axial_stiffness": 20e6}
ROPE = """
lines:
  rope: {start: [0, 0], end: [200, 20], length: 205, mass: 3, axial_stiffness: 20e6, elements: 100}
"""
LOADED = """
loads:
  cabin: {kind: force, on: rope, force: [0, -8000], contact: clamped, travel: {speed: 0, measured: material, from: 80}}
"""
REST = "run: {kind: equilibrium}\n"


def exact(*loads: tuple[float, tuple[float, float]]) -> rope.RestingRope:
    """The elastic catenary with these loads."""
    return rope.elastic_catenary(**ELASTIC, loads=loads)


def heights(result: Any) -> Any:
    """Of the nodes at last, m."""
    return result.position.sel(axis="z").to_numpy()[-1]


def below_the_chord(result: Any) -> float:
    """Largest depth of a node below the straight line between the ends, m."""
    x, z = result.position.sel(axis="x").to_numpy()[-1], heights(result)
    return float(np.max(z[0] + (z[-1] - z[0]) * (x - x[0]) / (x[-1] - x[0]) - z))


def reaction(result: Any, end: int, axis: str) -> float:
    """Of a support at last, N."""
    return float(result.reaction.sel(axis=axis).to_numpy()[-1, end])


SHALLOW: dict[str, Any] = {"span": 100.0, "mass": 5.0, "axial_stiffness": 2e6, "horizontal_tension": 20e3}
"""lambda^2 = 6.0: the first symmetric mode is well above that of a string."""


def shallow(elements: int = 200) -> str:
    """A level cable with that horizontal tension."""
    tension, weight = SHALLOW["horizontal_tension"], SHALLOW["mass"] * G
    # Unstrained length of the elastic catenary with that horizontal tension: x = H L/EA + 2 (H/w) asinh(w L/(2 H)).
    length = 100.0
    for _ in range(60):
        length -= tension * length / 2e6 + 2.0 * tension / weight * np.arcsinh(0.5 * weight * length / tension) - 100.0
    return f"""
lines:
  cable:
    {{start: [0, 0], end: [100, 0], length: {float(length)!r}, mass: 5, axial_stiffness: 2.0e+6, elements: {elements}}}
run: {{kind: equilibrium}}
"""


def by_shape(spectrum: Any, kind: str) -> float:
    """First frequency of the modes across the plane, or of symmetric or antisymmetric ones in it, rad/s."""
    for omega, shape in zip(spectrum.modes.frequency, spectrum.modes.shape, strict=True):
        y, z = shape[:, 1], shape[:, 2]
        if np.abs(y).max() > 0.5:
            found = "out_of_plane"
        else:
            found = "symmetric" if np.abs(z + z[::-1]).max() > np.abs(z - z[::-1]).max() else "antisymmetric"
        if found == kind:
            return float(omega)
    raise RuntimeError(f"there is no mode that is {kind}")


def irvine(kind: str) -> float:
    """First frequency of the linear theory, rad/s."""
    found = cable.natural_frequencies(modes=1, gravity=G, **SHALLOW)
    return float(getattr(found, kind)[0])


STANCE = highline.stand(span=40.0, standing_tension=1500.0, stiffness=55e3, mass=57.0)
HIGHLINE = """
lines:
  webbing:
    {start: [0, 0], end: [40, 0], length: 38.93805309734513, mass: 1.0e-6, axial_stiffness: 55e3, elements: 20}
loads:
  person: {kind: mass, on: webbing, mass: 57, travel: {speed: 0, measured: material, from: 19.469026548672566}}
run: {kind: equilibrium}
"""
INEXTENSIBLE = """
lines: {rope: {start: [0, 0], end: [20, 0], length: 22, mass: 1, law: {kind: inextensible}, elements: 110}}
run: {kind: equilibrium}
"""
CATENARY = rope.catenary(span=20.0, length=22.0, weight=G)
ON_ELLIPSE = """
gravity: 0
lines: {rope: {start: [0, 0], end: [20, 0], length: 22, mass: 1, law: {kind: inextensible}, elements: 22}}
loads:
  bead: {kind: force, on: rope, force: [0, -700], contact: frictionless, travel: {speed: 0, from: 6.6}}
run: {kind: equilibrium}
"""


def ellipse_at(x: float) -> locus.Locus:
    """The bead on its ellipse."""
    return locus.ellipse(span=20.0, length=22.0, load=700.0, x=x)


def off_the_ellipse(result: Any) -> float:
    """How far above the ellipse the bead stands, m."""
    x, z = result.contact_position.to_numpy()[-1, 0]
    return float(z - ellipse_at(x).z)


def hold_over_theory(result: Any) -> float:
    """Hold force over load and slope of the ellipse there."""
    x = float(result.contact_position.to_numpy()[-1, 0, 0])
    return float(result.hold_force.to_numpy()[-1].ravel()[0] / ellipse_at(x).hold)


TAUT = 22.0 / (1.0 + 105.0 / 1e6)
"""Unstrained length of the bead's rope: the tension is 105 N, give or take 15."""
START = (22.0**2 - 20.0**2 + 2.0 * 20.0 * 4.0) / (2.0 * 22.0) * TAUT / 22.0
SLIDING = f"""
lines:
  rope:
    start: [0, 0]
    end: [20, 0]
    length: {TAUT!r}
    mass: 1.0e-3
    axial_stiffness: 1.0e+6
    elements: 25
    law: {{kind: tension_only}}
loads:
  bead: {{kind: mass, on: rope, mass: 10, travel: {{kind: free, from: {START!r}}}}}
run: {{kind: dynamic, until: 5, every: 0.02, start: {{with_loads: true}}}}
"""


def fastest(result: Any) -> float:
    """Largest speed of the bead, m/s, from its places."""
    place, t = result.contact_position.to_numpy()[:, 0], result.time.to_numpy()
    return float(np.hypot(*((place[2:] - place[:-2]) / (t[2:] - t[:-2])[:, None]).T).max())


def turns_back(result: Any) -> float:
    """Instant at which the bead stands at the far end of its way, s: half a period, by a parabola."""
    x, t = result.contact_position.to_numpy()[:, 0, 0], result.time.to_numpy()
    k = int(x.argmax())
    a, b, _ = np.polyfit(t[k - 1 : k + 2] - t[k], x[k - 1 : k + 2], 2)
    return float(t[k] - 0.5 * b / a)


CASES = (
    KnownCase(
        "cable-elastic-catenary", "A rope between unlike heights under its weight", IRVINE, ROPE + REST,
        (
            KnownNumber("sag", "largest depth below the chord", "m", "closed form",
                lambda: exact().sag, below_the_chord,
                "second order of 100 links, and the nodes next to the lowest place", relative=2e-4),
            KnownNumber("horizontal", "horizontal tension", "N", "closed form", lambda: exact().horizontal_tension,
                lambda r: reaction(r, 1, "x"), "second order of 100 links", relative=2e-4, order=1.8),
            KnownNumber("lifted", "vertical reaction at the upper end", "N", "closed form",
                lambda: float(exact().end_reaction[1]), lambda r: reaction(r, 1, "z"), "second order of 100 links",
                relative=2e-4),
        ),
        fault=("lines.rope.length=205.2",), coarser=("lines.rope.elements=50",), quick=True,
    ),
    KnownCase(
        "cable-loaded", "The same rope under a load of 8 kN", IRVINE, ROPE + LOADED + REST,
        (
            KnownNumber("depth", "depth of the load", "m", "closed form",
                lambda: -float(exact((80.0, (0.0, -8000.0))).load_positions[0, 1]),
                lambda r: -float(r.contact_position.to_numpy()[-1, 0, 1]), "second order of 100 links", relative=1e-4),
            KnownNumber("ahead", "tension ahead of the load", "N", "closed form",
                lambda: float(exact((80.0, (0.0, -8000.0))).load_tensions[0, 1]),
                lambda r: float(r.contact_tension.to_numpy()[-1].ravel()[1]), "half a link of weight", relative=3e-4),
        ),
        fault=("loads.cabin.force=[0, -8100]",), quick=True,
    ),
    KnownCase(
        "cable-catenary", "An inextensible rope hangs in a catenary",
        Publication("Johann Bernoulli, Chr. Huygens and G. W. Leibniz, Acta Eruditorum, 1691; in every textbook of "
                    "statics"),
        INEXTENSIBLE,
        (
            KnownNumber("sag", "sag", "m", "closed form", lambda: CATENARY.sag, below_the_chord, "second order of "
                                                                                                 "110 links",
                relative=1e-4, order=1.9),
            KnownNumber("horizontal", "horizontal tension", "N", "closed form", lambda: CATENARY.horizontal_tension,
                lambda r: reaction(r, 1, "x"), "second order of 110 links", relative=2e-4, order=1.9),
        ),
        fault=("lines.rope.length=22.05",), coarser=("lines.rope.elements=54",), ratio=110.0 / 54.0, quick=True,
    ),
    KnownCase(
        "cable-ellipse", "A load slides without friction on a weightless inextensible rope: on an ellipse",
        Publication("the gardener's construction of the ellipse: semi-axes L/2 and sqrt(L^2 - X^2)/2; the hold force "
               "derived "
               "in ropewalk.theory.locus", "elementary geometry"),
        ON_ELLIPSE,
        (
            KnownNumber("path", "height over the ellipse", "m", "closed form", lambda: 0.0, off_the_ellipse,
                "the links are straight as the rope is", absolute=1e-8),
            KnownNumber("hold", "force that holds the load, over load times slope", "", "closed form", lambda: 1.0,
                hold_over_theory, "as above", relative=1e-7),
        ),
        fault=("lines.rope.length=22.1",), quick=True,
    ),
    KnownCase(
        "cable-irvine", "Small vibrations of a shallow cable that stretches, lambda^2 = 6", IRVINE_1974, shallow(),
        (
            KnownNumber("out-of-plane", "first frequency out of the plane", "rad/s", "closed form",
                lambda: irvine("out_of_plane"), lambda s: by_shape(s, "out_of_plane"),
                "the theory is that of a shallow parabola, sag/span = 0.03: five times its square", relative=6e-3),
            KnownNumber("antisymmetric", "first antisymmetric frequency", "rad/s", "closed form",
                lambda: irvine("antisymmetric"), lambda s: by_shape(s, "antisymmetric"), "as above", relative=5e-3),
            KnownNumber("symmetric", "first symmetric frequency", "rad/s", "closed form", lambda: irvine("symmetric"),
                lambda s: by_shape(s, "symmetric"), "as above", relative=1e-2),
        ),
        fault=("lines.cable.mass=5.5",), answer=frequencies, quick=True,
    ),
    KnownCase(
        "highline-stance", "A person stands in the middle of a highline",
        Publication("two straight springs, derived in ropewalk.theory.highline", "elementary statics"),
        HIGHLINE,
        (
            KnownNumber("sag", "depth of the feet", "m", "closed form", lambda: STANCE.sag,
                lambda r: -float(r.contact_position.to_numpy()[-1, 0, 1]), "its mass is 0.04 g", relative=1e-5),
            KnownNumber("tension", "tension", "N", "closed form", lambda: float(STANCE.tensions[0]),
                lambda r: float(r.tension.to_numpy()[-1].max()), "its mass is 0.04 g", relative=1e-5),
        ),
        fault=("loads.person.mass=58",), quick=True,
    ),
    KnownCase(
        "highline-frequencies", "The same person bounces and sways",
        Publication("two straight springs, linearised in ropewalk.theory.highline", "elementary statics"),
        HIGHLINE,
        (
            KnownNumber("sway", "frequency to the side", "Hz", "closed form", lambda: STANCE.sway_frequency,
                lambda s: float(s.modes.frequency[0]) / (2.0 * np.pi), "its mass is 0.04 g", relative=1e-5),
            KnownNumber("bounce", "frequency up and down", "Hz", "closed form", lambda: STANCE.bounce_frequency,
                lambda s: float(s.modes.frequency[1]) / (2.0 * np.pi), "its mass is 0.04 g", relative=1e-5),
        ),
        fault=("loads.person.mass=58",), answer=frequencies, quick=True,
    ),
    KnownCase(
        "cable-bead", "A bead of 10 kg slides without friction along a light rope, released 4 m from its end",
        Publication("conservation of energy on the ellipse, solved in ropewalk.theory.bead", "elementary mechanics"),
        SLIDING,
        (
            KnownNumber("speed", "largest speed", "m/s", "closed form",
                lambda: float(np.sqrt(2.0 * G * (ellipse_at(4.0).z - ellipse_at(10.0).z))), fastest,
                "the rope weighs 22 g and stretches by 0.1 mm per m; differences over 40 ms", relative=2e-3),
            KnownNumber("half-period", "time to the far end", "s", "closed form",
                lambda: 0.5 * float(bead.period(4.0, span=20.0, length=22.0, gravity=G)), turns_back,
                "as above; a rope that weighs something is not quite an ellipse", relative=3e-3),
        ),
        fault=("lines.rope.length=22.3",),
    ),
)  # fmt: skip
