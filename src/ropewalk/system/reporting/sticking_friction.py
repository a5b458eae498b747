"""Friction that holds lines on saddles and at sheaves in small motion: what it bears, and what it is asked for."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.system.elements.sheaves_at_rest import turned_at
from ropewalk.system.elements.structure import Sheaves, Structure


class StickingFriction:
    """What friction bears that holds a structure about its rest.

    Args:
        structure: with all its geometry.
        rest: (axis, node) m.
    """

    def __init__(self, structure: Structure, rest: Array) -> None:
        self._saddles, self._stuck = structure.saddles, structure.saddles.stuck(rest) if structure.saddles else []
        self._pressed = {} if self._saddles is None else self._saddles.pressing(rest)  # N, of nodes on saddles
        self._axes, self._ratio = rest.shape[0], np.zeros(0)
        if structure.sheaves is not None:  # larger over smaller tension, from which on lines slip
            turned = turned_at(structure.sheaves, structure.runs, rest)
            self._ratio = np.where(
                structure.sheaves.friction > 0.0, np.exp(structure.sheaves.friction * turned), np.inf
            )  # fmt: skip

    def rubbed(self, force: Array, x: Array) -> tuple[Array, bool]:
        """Forces on all places with those of the friction on saddles, N, and whether it bears less than that asks for.

        Args:
            force: of all else, with inertia.
            x: (place,) m, from rest.
        """
        left, slips, n = force.reshape(self._axes, -1).copy(), False, force.size // self._axes
        for e, i, way in self._stuck:
            assert self._saddles is not None
            along = left[:, i] - way * float(way @ left[:, i])
            deep = x.reshape(self._axes, n)[:, [i, int(self._saddles.node[e])]]
            pressed = self._pressed[i] + float(self._saddles.k[e]) * float(way @ (deep[:, 0] - deep[:, 1]))
            slips = slips or float(np.linalg.norm(along)) > float(self._saddles.friction[e]) * max(pressed, 0.0)
            left[:, i] -= along
            left[:, int(self._saddles.node[e])] += along
        return left.ravel(), slips

    def slips_over(self, sheaves: Sheaves | None) -> bool:
        """Whether tensions beside sheaves, which are known, differ by more than their friction bears."""
        if sheaves is None:
            return False
        behind, ahead = sheaves.tension.T
        return bool((np.maximum(behind, ahead) > np.minimum(behind, ahead) * self._ratio).any())
