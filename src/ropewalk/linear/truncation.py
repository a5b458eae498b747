"""Truncation error of a sum of modes: static responses in the kept modes against those in many."""

from __future__ import annotations

import numpy as np

from ropewalk.linear.chord import Chord
from ropewalk.linear.reactions import pressed
from ropewalk.mechanics.chain import Array

_MANY, _INSTANTS = 480, 200  # modes that stand for all, and instants among those of a run
_LEAST = 0.05  # of the largest value of a line: smaller values are compared with this
_REPORTED = 0.02  # of a value: errors from which on they are reported


def truncation_errors(chord: Chord, links: int, modes: int, place: Array, force: Array) -> dict[str, float]:
    """Return by how much the missing modes change the largest static values anywhere on a line, as parts of these.

    Args:
        links: between its nodes, at which values are compared.
        place: (instant, load) m along the chord, NaN off the line.
        force: (instant, load) N across it.
    """
    on = np.isfinite(place)
    rows = np.flatnonzero(on.any(axis=1))
    rows = rows[:: max(1, rows.size // _INSTANTS)]
    x, F = np.where(on, place, 0.0)[rows], np.where(on, force, 0.0)[rows]
    k: Array = np.arange(1.0, max(_MANY, 4 * modes) + 1.0) * (np.pi / chord.length)
    follows = pressed(x, F[..., None], k)[:, 0] / (
        chord.bending_stiffness * k**4 + chord.tension * k**2 + chord.foundation
    )
    shape = np.sin(np.outer(k, np.linspace(0.0, chord.length, links + 1)))
    moment = shape * k[:, None] ** 2
    quantities = {"deflection": shape, "bending moment": moment, "shear": np.diff(moment, axis=1)}
    if chord.is_string:
        quantities = {"deflection": shape, "slope": np.diff(shape, axis=1)}
    found = dict[str, float]()
    for name, terms in quantities.items():
        whole, kept = (np.abs(follows[:, :n] @ terms[:n]).max(axis=0, initial=0.0) for n in (k.size, modes))
        least = _LEAST * whole.max(initial=0.0)
        found[name] = float((np.abs(kept - whole) / np.maximum(whole, least or 1.0)).max())
    return found


def truncation_warning(name: str, chord: Chord, links: int, modes: int, place: Array, force: Array) -> str:
    """Return a warning of a line whose modes are too few for some quantity; empty where there is none.

    Args:
        chord, links, modes, place, force: see `truncation_errors`.
    """
    errors = truncation_errors(chord, links, modes, place, force)
    if max(errors.values()) <= _REPORTED:
        return ""
    enough = 2 * modes
    while enough < _MANY and max(truncation_errors(chord, links, enough, place, force).values()) > _REPORTED:
        enough *= 2
    missed = ", ".join(f"{100.0 * e:.2g} % of the {what}" for what, e in errors.items() if e > _REPORTED)
    remedy = f"write run.modes: {enough}, or leave it out" if enough < _MANY else "leave run.modes out"
    return f"line {name}: {modes} modes miss up to {missed} under these loads applied statically; {remedy}"
