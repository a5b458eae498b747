"""How far carriages are from the ends of their lines: along these, and as the crow flies."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import lean_inner
from ropewalk.system.contact.contacts import goes_on


@lean_inner
def to_drive(lines, runs, length, contacts, first, count, to):
    """Mean length of the line between some contacts and its end (`to` is 1) or its start (-1), m."""
    line, gone, behind = contacts[first].line, 0.0, 0.0
    last = lines.first[line] + lines.runs[line] - 1
    for s in range(lines.first[line], last + 1):
        begin = runs.first[s]
        for k in range(first, first + count):
            if contacts[k].run == s:
                whole = int(contacts[k].x)
                own = gone
                for i in range(begin, begin + whole):
                    own += length[i]
                if whole < runs.links[s]:
                    own += (contacts[k].x - whole) * length[begin + whole]
                behind += own
        for i in range(begin, begin + runs.links[s]):
            gone += length[i]
        if s < last and not goes_on(lines, runs, s):
            gone += length[begin + runs.links[s]]
    behind /= count
    return gone - behind if to > 0 else behind


@lean_inner
def middle(contacts, first, count, u, a):
    """Component a of the middle of a carriage, m."""
    total = 0.0
    for k in range(first, first + count):
        total += u[contacts[k].first + a]
    return total / count


@lean_inner
def aim(hauls, e, lines, runs, r, u, contacts, first, count, to):
    """Note the level way from a carriage to an end of its line; returns how far and how much higher that is, m."""
    last, s = r.shape[0] - 1, lines.first[contacts[first].line]
    node = runs.first[s]
    if to > 0:
        s += lines.runs[contacts[first].line] - 1
        node = runs.first[s] + runs.links[s]
    square = 0.0
    for a in range(last):
        hauls[e].way[a] = r[a, node] - middle(contacts, first, count, u, a)
        square += hauls[e].way[a] ** 2
    level = max(np.sqrt(square), 1e-9)
    for a in range(last):
        hauls[e].way[a] /= level
    return level, r[last, node] - middle(contacts, first, count, u, last)
