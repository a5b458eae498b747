"""Closed forms and semi-analytic solutions, the references that the simulation is checked against.

==================  =====================================================================================
``string``          a taut string under a moving force (exact, modal), mass and oscillator
``rope``            ropes at rest under clamped point loads, heavy or weightless, elastic or inextensible
``shooting``        the same ropes by integration from the start and walking the miss to zero
``locus``           ellipse of a slowly moved frictionless load
``friction``        friction that a load needs: capstan and point block
``bead``            bead that slides on a weightless rope, with and without friction, until it rests
``cable``           natural frequencies and modes of a shallow sagging cable
``whirl``           circular whirls of a taut line at large amplitude
``beam``            force, mass, oscillator, vehicle crossing a beam; frequencies, buckling, impact factors
``beam_vehicle``    the vehicles: matrices of linear bodies on wheels
``foundation``      load moving on an infinite string or beam on an elastic, viscous bed
``selfsimilar``     nonlinear string without ends: transverse impact, force that starts to move
``chain``           natural frequencies of the straight chain of links
``membrane``        frequencies of rectangular membranes, deflection of nets of taut strings
``gait``            walking: forces by harmonics
``highline``        person on an elastic webbing: sag, tension, frequencies
``lateral_balance`` people on a deck that sways: gait in closed form, negative damping
==================  =====================================================================================

The wing depends on NumPy and SciPy only and knows nothing of the rest of the package. SI units; arrays
broadcast; arguments outside the range of a formula raise `ValueError`.
"""

from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ropewalk.theory import (
        bead,
        beam,
        beam_vehicle,
        cable,
        chain,
        foundation,
        friction,
        gait,
        highline,
        lateral_balance,
        locus,
        membrane,
        rope,
        selfsimilar,
        shooting,
        string,
        whirl,
    )

__all__ = [
    "bead",
    "beam",
    "beam_vehicle",
    "cable",
    "chain",
    "foundation",
    "friction",
    "gait",
    "highline",
    "lateral_balance",
    "locus",
    "membrane",
    "rope",
    "selfsimilar",
    "shooting",
    "string",
    "whirl",
]


def __getattr__(name: str) -> ModuleType:
    """Import a submodule when it is first asked for: two of them load SciPy's root finders, 0.4 s."""
    if name in __all__:
        return import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
