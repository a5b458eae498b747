"""How much of a motion one call of a kernel computes: between two of them Python hears what its user wants."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.interrupts import is_interrupted

# Steps times nodes in a call: 5 to 200 ms, against some 20 us that a call costs.
_WORK = 2_000_000
_BESIDES = 100  # nodes that cost as much in a step as what is there besides the nodes


def portion(nodes: int, effort: int = 1) -> int:
    """Steps in one call.

    Args:
        nodes: of the structure.
        effort: how often a step of the method looks at a node.
    """
    return max(1, _WORK // (effort * (nodes + _BESIDES)))


def portions(steps: int, nodes: int, effort: int = 1) -> Iterator[int]:
    """Steps of the calls, one after the other, that make a number of steps."""
    most = portion(nodes, effort)
    for begun in range(0, steps, most):
        if is_interrupted():  # what code of others that was at work has swallowed
            raise KeyboardInterrupt
        yield min(most, steps - begun)
