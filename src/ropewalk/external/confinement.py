"""Confinement: what a process may do no more, as far as the system it runs on can hold it back.

Linux alone: Landlock (5.13 and later) keeps it from writing outside one folder, from signals to others and, from 6.7
on, from TCP; a network namespace of its own, where an ordinary user may have one, from any network. Nothing of that can
be undone by the process, nor by what it starts.
"""

from __future__ import annotations

import ctypes
import os
import sys
from contextlib import suppress

# Numbers of system calls, the same on all processors that Landlock came to.
_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446
_VERSION, _BENEATH = 1, 1
_NO_NEW_PRIVILEGES = 38
_NEW_USER, _NEW_NETWORK = 0x10000000, 0x40000000

# By the version of Landlock from which on they are known: rights to write, to make and to remove files.
_WRITE_FILE, _TRUNCATE = 1 << 1, 1 << 14
_WRITES = ((1, _WRITE_FILE | sum(1 << bit for bit in range(4, 13))), (2, 1 << 13), (3, _TRUNCATE), (5, 1 << 15))
_TCP = (4, 0b11)
_SCOPES = (6, 0b11)  # abstract sockets of others, and signals to them
_HARMLESS = ("/dev/null",)


class _Ruleset(ctypes.Structure):
    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scoped", ctypes.c_uint64))


class _Beneath(ctypes.Structure):
    _pack_ = 1
    _fields_ = (("rights", ctypes.c_uint64), ("place", ctypes.c_int32))


def leave_network() -> bool:
    """Keep this process, which has no threads yet, from any network; whether that could be done."""
    if not sys.platform.startswith("linux"):
        return False
    system, user, group = ctypes.CDLL(None), os.getuid(), os.getgid()
    if system.unshare(_NEW_USER | _NEW_NETWORK) != 0:
        return False
    for file, text in (("setgroups", "deny"), ("uid_map", f"{user} {user} 1"), ("gid_map", f"{group} {group} 1")):
        with suppress(OSError), open(f"/proc/self/{file}", "w", encoding="ascii") as stream:  # else it is nobody
            stream.write(text)
    return True


def write_only_in(folder: str) -> bool:
    """Keep this thread, and those that it starts, from writing outside a folder; whether that could be done."""
    if not sys.platform.startswith("linux"):
        return False
    system = ctypes.CDLL(None)
    version = system.syscall(_CREATE_RULESET, None, ctypes.c_size_t(0), _VERSION)
    if version < 1:
        return False
    rights = sum(right for since, right in _WRITES if version >= since)
    rules = _Ruleset(rights, *(every if version >= since else 0 for since, every in (_TCP, _SCOPES)))
    size = 8 * (3 if version >= _SCOPES[0] else 2 if version >= _TCP[0] else 1)
    ruleset = system.syscall(_CREATE_RULESET, ctypes.byref(rules), ctypes.c_size_t(size), 0)
    if ruleset < 0:
        return False
    try:
        for place, allowed in ((folder, rights), *((name, rights & (_WRITE_FILE | _TRUNCATE)) for name in _HARMLESS)):
            opened = os.open(place, os.O_PATH | os.O_CLOEXEC)
            try:
                rule = _Beneath(allowed, opened)
                if system.syscall(_ADD_RULE, ruleset, _BENEATH, ctypes.byref(rule), 0) != 0:
                    return False
            finally:
                os.close(opened)
        if system.prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0) != 0:
            return False
        return bool(system.syscall(_RESTRICT_SELF, ruleset, 0) == 0)
    finally:
        os.close(ruleset)
