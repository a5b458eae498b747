"""Confinement: the rights that a process gives up, as far as the system can hold it to that.

Linux alone. Landlock (5.13 and later) keeps the process from writing outside one folder and from other processes;
a filter of system calls (`seccomp.py`) from the network, other processes and attributes of files; limits bound memory
and the size of files; capabilities go. Nothing of that can be undone by the process, nor by what it starts. It must
have one thread: those that exist already would keep their rights.
"""

from __future__ import annotations

import ctypes
import errno
import os
import sys
from contextlib import suppress

from ropewalk.external import seccomp

# Numbers of system calls, the same on all processors that Landlock came to.
_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446
_VERSION, _BENEATH = 1, 1
_NO_NEW_PRIVILEGES, _PARENT_DEATH_SIGNAL, _CHILD_SUBREAPER = 38, 1, 36

# By the version of Landlock from which on they are known: rights to write, to make and to remove files.
_WRITE_FILE, _TRUNCATE = 1 << 1, 1 << 14
_WRITES = ((1, _WRITE_FILE | sum(1 << bit for bit in range(4, 13))), (2, 1 << 13), (3, _TRUNCATE), (5, 1 << 15))
_TCP = (4, 0b11)
_SCOPES = (6, 0b11)  # abstract sockets of others, and signals to them
_HARMLESS = ("/dev/null",)
_LIST = 1 << 3  # the entries of a folder: those of /proc are other processes

LARGEST_FILE = 1 << 30  # bytes
_MOST_MEMORY = 4 << 30  # bytes, and no more than half of what the machine has
_CAPABILITIES_3, _READ_ALL = 0x20080522, 1 << 2  # version of their structure; root may still read what it may read


class _Ruleset(ctypes.Structure):
    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scoped", ctypes.c_uint64))


class _Beneath(ctypes.Structure):
    _pack_ = 1
    _fields_ = (("rights", ctypes.c_uint64), ("place", ctypes.c_int32))


def lacking() -> list[str]:
    """Name the walls that this system does not have; none if it can hold a process back."""
    if not sys.platform.startswith("linux"):
        return ["Landlock and seccomp, which only Linux has"]
    walls = {"Landlock (Linux 5.13 or later)": landlock_version() >= 1, "seccomp": seccomp.is_available()}
    return [name for name, is_there in walls.items() if not is_there]


def landlock_version() -> int:
    """Return the version of Landlock that the kernel knows, less than 1 if none."""
    return int(ctypes.CDLL(None).syscall(_CREATE_RULESET, None, ctypes.c_size_t(0), _VERSION))


def most_memory() -> int:
    """Return the most bytes of data that a confined process may have."""
    return min(_MOST_MEMORY, os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2)


def adopt_orphans() -> None:
    """Become the parent of whatever the descendants of this process leave behind."""
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(_CHILD_SUBREAPER, 1, 0, 0, 0)


def end_with_parent(parent: int) -> None:
    """Have the kernel kill this process when its parent, of this number, ends."""
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, 9, 0, 0, 0)
    if os.getppid() != parent:
        os._exit(1)


def confine(folder: str) -> None:
    """Give up the rights of this process, which has one thread, except to write in a folder.

    Raises:
        OSError: the system has a wall and does not let it be used.
    """
    if not sys.platform.startswith("linux"):
        return
    missing = lacking()
    _limit()
    system = ctypes.CDLL(None, use_errno=True)
    _checked(system.prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0), "no_new_privs")
    if not any("Landlock" in name for name in missing):
        _write_only_in(folder, system)
    _drop_capabilities(system)
    if not any("seccomp" in name for name in missing):
        seccomp.give_up_calls(os.getpid())


def _limit() -> None:
    """Bound the memory of this process and the size of what it writes."""
    import resource

    for what, most in (
        (resource.RLIMIT_CORE, 0), (resource.RLIMIT_DATA, most_memory()), (resource.RLIMIT_FSIZE, LARGEST_FILE),
    ):  # fmt: skip
        hard = resource.getrlimit(what)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(what, (most, most))


def _write_only_in(folder: str, system: ctypes.CDLL) -> None:
    version = landlock_version()
    rights = sum(right for since, right in _WRITES if version >= since)
    places = [
        (folder, rights),
        *((name, rights & (_WRITE_FILE | _TRUNCATE)) for name in _HARMLESS),
        ("/proc/self", _LIST),
    ]
    places += [(f"/{name}", _LIST) for name in os.listdir("/") if name != "proc" and os.path.isdir(f"/{name}")]
    rules = _Ruleset(rights | _LIST, *(every if version >= since else 0 for since, every in (_TCP, _SCOPES)))
    size = 8 * (3 if version >= _SCOPES[0] else 2 if version >= _TCP[0] else 1)
    ruleset = system.syscall(_CREATE_RULESET, ctypes.byref(rules), ctypes.c_size_t(size), 0)
    _checked(ruleset, "Landlock")
    try:
        for place, allowed in places:
            opened = os.open(place, os.O_PATH | os.O_CLOEXEC)
            try:
                rule = _Beneath(allowed, opened)
                _checked(system.syscall(_ADD_RULE, ruleset, _BENEATH, ctypes.byref(rule), 0), "Landlock")
            finally:
                os.close(opened)
        _checked(system.syscall(_RESTRICT_SELF, ruleset, 0), "Landlock")
    finally:
        os.close(ruleset)


def _drop_capabilities(system: ctypes.CDLL) -> None:
    """Keep of the powers of root that to read, as of a user; no_new_privs keeps programs from regaining any."""
    header, now = (ctypes.c_uint32 * 2)(_CAPABILITIES_3, 0), (ctypes.c_uint32 * 6)()
    _checked(system.capget(ctypes.byref(header), ctypes.byref(now)), "capabilities")
    kept = now[1] & _READ_ALL
    _checked(system.capset(ctypes.byref(header), (ctypes.c_uint32 * 6)(kept, kept, 0, 0, 0, 0)), "capabilities")
    with suppress(OSError):  # where the kernel does not know them there are none
        _checked(system.prctl(47, 4, 0, 0, 0), "ambient capabilities")


def _checked(answer: int, what: str) -> None:
    if answer < 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{what}: {errno.errorcode.get(number, number)}")
