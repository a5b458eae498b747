"""Chains whose spectrum several tests look at."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Strands
from ropewalk.solve.end_conditions import EndConditions
from ropewalk.solve.equilibrium import at_rest
from ropewalk.theory import chain

CHAIN = {"length": 20.0, "axial_stiffness": 1e4, "mass": 0.1, "stretch": 1.02}
NO_FLOOR = -1e300
LAWS = {"hooke": [0.0, NO_FLOOR, 1e4, 0.0, 0.0], "second_piola_kirchhoff": [0.0, NO_FLOOR, 1e4, 1e4, 0.0]}
TENSION_ONLY = [0.0, 0.0, 1e4, 0.0, 0.0]


def strand(links, *, length=20.0, rho=0.1, law=LAWS["hooke"], c=0.0, drag=0.0, dim=2):
    return Strands(
        first=np.array([0]), links=np.array([links]), h=np.array([length / links]), rho=np.array([rho]),
        law=np.array([law]), damping=np.array([c]), drag=np.array([drag]), gravity=np.zeros(dim),
    )  # fmt: skip


def straight(links, stretch=1.02, length=20.0, dim=2):
    X = np.linspace(0.0, length, links + 1)
    r = np.zeros((dim, links + 1))
    r[0] = stretch * X
    return r, X


def hanging(links, length, span, rho, EA, dim=2, g=9.81, rise=0.0, **damping):
    strands = strand(links, length=length, rho=rho, law=[0.0, NO_FLOOR, EA, 0.0, 0.0], dim=dim, **damping)
    f, start, end = np.zeros((dim, links + 1)), np.zeros(dim), np.zeros(dim)
    f[-1, 1:-1] = -rho * length / links * g
    end[0], end[-1] = span, rise
    rest = at_rest(strands.law[0], np.full(links, length / links), f, EndConditions.fast(start, end))
    return strands, (rest.position, np.linspace(0.0, length, links + 1))


def wavy(links, seed=0, dim=2):
    """A strained chain in no special position, with a node that rides 0.4 of a link away from its place."""
    r, X = straight(links, stretch=1.1, dim=dim)
    r += 0.04 * np.random.default_rng(seed).standard_normal(r.shape)
    moving_load = links // 2
    X[moving_load] += 0.4 * (X[1] - X[0])
    r[0, moving_load] += 0.4 * (X[1] - X[0])
    return r, X, moving_load


def closed_form(links, law="hooke"):
    across = chain.transverse_frequencies(links=links, **CHAIN, law=law)
    return across, chain.longitudinal_frequencies(links=links, **CHAIN, law=law)
