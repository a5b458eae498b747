"""Closed forms and semi-analytic solutions, the references that the simulation is checked against.

==================  =====================================================================================
``string``          constant force moving on a taut string between two supports: exact and modal
``rope``            ropes at rest: catenary, elastic catenary with point loads, weightless elastic rope
``selfsimilar``     nonlinear string without ends: transverse impact, force that starts to move
``chain``           natural frequencies of the straight chain of links
==================  =====================================================================================

The wing depends on NumPy and SciPy only and knows nothing of the rest of the package. SI units; arrays
broadcast; arguments outside the range of a formula raise `ValueError`.
"""

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ropewalk.theory import chain, rope, selfsimilar, string

__all__ = ["chain", "rope", "selfsimilar", "string"]


def __getattr__(name: str) -> ModuleType:
    """Import a submodule when it is first asked for: two of them load SciPy's root finders, 0.4 s."""
    if name in __all__:
        return import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
