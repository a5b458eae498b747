"""Contacts that share links: each lengthens them by its kink, and feels the tension that all of them make."""

from __future__ import annotations

from ropewalk.mechanics.compiled import lean_inner

FAR = 4.0  # links, from which on contacts of a run share none


@lean_inner
def see_others(contacts, k, on):
    """Note at contact k what the kinks of others add to half of the squares of the lengths of its links.

    Args:
        on: state of those that are on their lines.
    """
    contacts[k].shares_links = 0
    for j in range(3):
        contacts[k].beside[j] = 0.0
    for m in range(contacts.size):
        if m == k or (contacts[m].state != on and contacts[m].kink <= 0.0):
            continue
        apart = abs(contacts[m].run - contacts[k].run)
        if apart > 1 or (apart == 0 and abs(contacts[m].x - contacts[k].x) > FAR):
            continue
        for j in range(3):
            for i in range(3):
                if contacts[m].link[i] == contacts[k].link[j] and contacts[m].part[i] > 0.0:
                    contacts[k].beside[j] += contacts[m].part[i] * contacts[m].kink
                    if contacts[m].state == on:
                        contacts[k].shares_links = 1
