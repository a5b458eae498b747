"""Contacts that come to links over which sheaves stand."""

from __future__ import annotations

from ropewalk.mechanics.compiled import lean_inner
from ropewalk.system.contact.contact_record import ON


@lean_inner
def is_at_sheave(sheaves, structure, contacts, state):
    """Whether a contact has come to the link over which a sheave stands."""
    if sheaves is None:
        return False
    found, lines, runs = False, structure.lines, structure.runs
    for q in range(sheaves.node.size):
        run = sheaves.run[q]
        low, high = lines.begin[run] + runs.links[run] * runs.h[run], lines.begin[run + 1]
        for k in range(contacts.size):
            line = contacts[k].line
            if contacts[k].state == ON and lines.first[line] <= run < lines.first[line] + lines.runs[line]:
                found = found or low < state.s[k] < high
    return found
