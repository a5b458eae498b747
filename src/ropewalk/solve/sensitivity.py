"""Rests beside a rest: what equilibria become where numbers of their scenario change a little, not solved anew.

A run notes the equilibria that it finds, each with its stiffness K factorised there. The same run of a scenario beside
it puts in the place of each the shape that follows from the residual R of the changed equations alone,

    z <- z - K^-1 R(z, p + h),

a chord step of Newton's method. The first one is direct differentiation, dz/dp = -K^-1 dR/dp (the same derivative as by
the adjoint K^-T dq/dz: Haftka and Gürdal, Elements of Structural Optimization, 1992, section 7.2); each further one
multiplies what is left by a number of the size of h, or tells that K is not the stiffness.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.mechanics.chain import Array

if TYPE_CHECKING:
    import scipy.sparse

STEPS = 3
"""Chord steps: what is left of a shape's change after so many is the third power of the change itself."""
CONTRACTS = 0.01
"""Part of a first chord step that the second may be: a larger one speaks of another stiffness, or of a large change."""
_ROUNDING = 1e-12  # of unknowns
_ROOT = 1e-6  # of an unknown, by which its root function is differenced

Solve = Callable[[Array], Array]


class NotBesideError(Exception):
    """Equilibria that do not follow from those of the run beside."""


@dataclass(frozen=True)
class Noted:
    """An equilibrium: its unknowns, and what solves with its stiffness."""

    unknowns: Array
    solve: Solve
    left: float  # changes of unknowns so small are none: what rounding and the search for them have left


class Rests:
    """The equilibria of a run in their order."""

    def __init__(self) -> None:
        self.noted = list[Noted]()
        self._next = 0
        self._again = False

    @contextmanager
    def running(self, *, again: bool) -> Iterator[None]:
        """Let a run note its equilibria, or one beside it put its own in their places.

        Raises:
            NotBesideError: there are fewer of them.
        """
        self._next, self._again = 0, again
        token = _PRESENT.set(self)
        try:
            yield
            if again and self._next < len(self.noted):
                raise NotBesideError("fewer equilibria are found than in the reference run")
        finally:
            _PRESENT.reset(token)

    def settle(
        self, found: Callable[[], Array], residual: Callable[[Array], Array], factorised: Callable[[Array], Solve]
    ) -> Array:
        """The unknowns of an equilibrium.

        Args:
            found: solves for them.
            residual: what is out of balance at any, the force towards rest or the miss of a gap.
            factorised: solves with the change of what is out of balance, with its sign turned, at the solution.

        Raises:
            NotBesideError: chord steps from those of the run beside do not lead there.
        """
        if not self._again:
            unknowns = found()
            solve = factorised(unknowns)
            left = 10.0 * _largest(solve(residual(unknowns))) + _ROUNDING * _largest(unknowns)
            self.noted.append(Noted(unknowns.copy(), solve, left))
            return unknowns
        if self._next == len(self.noted):
            raise NotBesideError("more equilibria are found than in the reference run")
        at, self._next = self.noted[self._next], self._next + 1
        x, first = at.unknowns.copy(), 0.0
        if residual(x).shape != x.shape:
            raise NotBesideError("the unknowns differ from those of the reference run")
        for k in range(STEPS):
            step = at.solve(residual(x))
            size = _largest(step)
            if k == 0:
                first = size
            elif not size <= CONTRACTS * first + at.left:
                raise NotBesideError("the stiffness does not determine the change of equilibria")
            x = x + step
        return x

    def root(self, found: Callable[[], float], miss: Callable[[float], float]) -> float:
        """A number found by equilibria for which some function of them is zero.

        Args:
            found: searches for it.
            miss: is zero there.

        Raises:
            NotBesideError: see `settle`.
        """
        if not self._again:
            with not_noted():
                x = found()
                step = _ROOT * x
                slope = (miss(x + step) - miss(x - step)) / (2.0 * step)
            if not slope != 0.0:
                raise NotBesideError("a root does not follow from its slope")
            self.noted.append(Noted(np.array([x]), lambda out: -out / slope, _ROUNDING * abs(x)))
            miss(x)  # whose equilibria are noted
            return x
        start = self._next
        if start == len(self.noted) or self.noted[start].unknowns.size != 1:
            raise NotBesideError("a root is required that the reference run does not have")

        def out(x: Array) -> Array:
            self._next = start + 1
            return np.array([miss(float(x[0]))])

        there = self.settle(lambda: np.zeros(1), out, lambda _: lambda out: out)
        out(there)  # whose equilibria are those that follow
        return float(there[0])


_PRESENT: ContextVar[Rests | None] = ContextVar("rests", default=None)


@contextmanager
def not_noted() -> Iterator[None]:
    """Solve for equilibria that are neither noted nor taken from another run: those of other structures on the way."""
    token = _PRESENT.set(None)
    try:
        yield
    finally:
        _PRESENT.reset(token)


def present() -> Rests | None:
    """Where equilibria are noted or come from at present; None: they are solved for, as usual."""
    return _PRESENT.get()


def by_factors(K: scipy.sparse.csc_matrix) -> Solve:
    """What solves with a sparse stiffness.

    Raises:
        NotBesideError: it is singular.
    """
    from scipy.sparse.linalg import splu  # lazy: plain ropes have no sparse stiffness

    try:
        factors = splu(K.tocsc())
    except RuntimeError:
        raise NotBesideError("the stiffness is singular") from None
    return lambda out: np.asarray(factors.solve(out))


def _largest(x: Array) -> float:
    return float(np.abs(x).max(initial=0.0))
