"""Seccomp: system calls that a process gives up, on Linux.

A filter of the kernel refuses with EPERM all that reaches beyond the process and is no matter of Landlock: sockets,
other processes, attributes of files, mounts, shared memory, limits of others. Threads stay possible.
"""

from __future__ import annotations

import ctypes
import errno
import platform
from typing import NamedTuple

_SET_MODE_FILTER, _ACTION_AVAILABLE = 1, 2
_ALLOW, _ERRNO, _KILL = 0x7FFF0000, 0x00050000, 0x80000000
_LOAD, _EQUAL, _AT_LEAST, _ANY_BIT, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_NUMBER, _ARCHITECTURE, _FIRST, _SECOND = 0, 4, 16, 24  # places in struct seccomp_data, low halves of arguments
_THREAD = 0x10000  # CLONE_THREAD
_LATEST = 469  # the last system call whose effect is known here; later ones do not exist for the process

# By name, the numbers on x86-64 and in the generic table of all newer processors; None: not there.
_REFUSED: dict[str, tuple[int | None, int | None]] = {
    "socket": (41, 198), "socketpair": (53, 199),
    "fork": (57, None), "vfork": (58, None), "execve": (59, 221), "execveat": (322, 281),
    "chmod": (90, None), "fchmod": (91, 52), "fchmodat": (268, 53), "chown": (92, None), "fchown": (93, 55),
    "lchown": (94, None), "fchownat": (260, 54), "utime": (132, None), "utimes": (235, None), "futimesat": (261, None),
    "utimensat": (280, 88), "setxattr": (188, 5), "lsetxattr": (189, 6), "fsetxattr": (190, 7),
    "removexattr": (197, 14), "lremovexattr": (198, 15), "fremovexattr": (199, 16),
    "tkill": (200, 130), "rt_sigqueueinfo": (129, 138), "rt_tgsigqueueinfo": (297, 240),
    "ptrace": (101, 117), "process_vm_readv": (310, 270), "process_vm_writev": (311, 271), "kcmp": (312, 272),
    "perf_event_open": (298, 241), "bpf": (321, 280), "userfaultfd": (323, 282), "seccomp": (317, 277),
    "mount": (165, 40), "umount2": (166, 39), "pivot_root": (155, 41), "chroot": (161, 51), "unshare": (272, 97),
    "setns": (308, 268), "quotactl": (179, 60), "acct": (163, 89), "swapon": (167, 224), "swapoff": (168, 225),
    "open_by_handle_at": (304, 265), "name_to_handle_at": (303, 264), "fanotify_init": (300, 262),
    "shmget": (29, 194), "shmat": (30, 196), "semget": (64, 190), "msgget": (68, 186), "mq_open": (240, 180),
    "mq_unlink": (241, 181), "memfd_create": (319, 279), "add_key": (248, 217), "request_key": (249, 218),
    "keyctl": (250, 219), "migrate_pages": (256, 238), "move_pages": (279, 239), "setpriority": (141, 140),
    "ioprio_set": (251, 30), "reboot": (169, 142), "sethostname": (170, 161), "setdomainname": (171, 162),
    "settimeofday": (164, 170), "clock_settime": (227, 112), "adjtimex": (159, 171), "clock_adjtime": (305, 266),
    "init_module": (175, 105), "delete_module": (176, 106), "finit_module": (313, 273), "kexec_load": (246, 104),
    "kexec_file_load": (320, 294), "iopl": (172, None), "ioperm": (173, None), "syslog": (103, 116),
    "vhangup": (153, 58),
}  # fmt: skip
# From 424 on the numbers are the same on all processors.
_REFUSED |= {
    name: (number, number)
    for name, number in {
        "pidfd_send_signal": 424, "io_uring_setup": 425, "io_uring_enter": 426, "io_uring_register": 427,
        "open_tree": 428, "move_mount": 429, "fsopen": 430, "fsconfig": 431, "fsmount": 432, "fspick": 433,
        "pidfd_getfd": 438, "process_madvise": 440, "mount_setattr": 442, "quotactl_fd": 443,
        "process_mrelease": 448, "fchmodat2": 452, "setxattrat": 463, "removexattrat": 466, "open_tree_attr": 467,
        "file_setattr": 469,
    }.items()
}  # fmt: skip
# Refused with some arguments only: by name, the numbers as above.
_CLONE, _CLONE3, _IOCTL, _FCNTL, _PRLIMIT, _KILL_CALL, _TGKILL = (
    (56, 220), (435, 435), (16, 29), (72, 25), (302, 261), (62, 129), (234, 131),
)  # fmt: skip
_SCHEDULING = ((142, 118), (144, 119), (203, 122), (314, 274))  # of other processes or threads: sched_set...
_IOCTLS = (0x5412, 0x541C, 0x40086602, 0x401C5820)  # TIOCSTI, TIOCLINUX, FS_IOC_SETFLAGS, FS_IOC_FSSETXATTR
_OWNERS = (8, 15)  # F_SETOWN, F_SETOWN_EX: whom a file may send signals


class _Machine(NamedTuple):
    audit: int  # how the kernel names the processor
    column: int  # of the tables above


_MACHINES = {
    "x86_64": _Machine(0xC000003E, 0), "aarch64": _Machine(0xC00000B7, 1), "riscv64": _Machine(0xC00000F3, 1),
    "loongarch64": _Machine(0xC0000102, 1),
}  # fmt: skip


class _Instruction(ctypes.Structure):
    _fields_ = (("code", ctypes.c_uint16), ("yes", ctypes.c_uint8), ("no", ctypes.c_uint8), ("k", ctypes.c_uint32))


class _Program(ctypes.Structure):
    _fields_ = (("length", ctypes.c_uint16), ("instructions", ctypes.POINTER(_Instruction)))


def is_available() -> bool:
    """Return whether this system knows filters, and the numbers of its calls are known here."""
    machine = _MACHINES.get(platform.machine())
    if machine is None or ctypes.sizeof(ctypes.c_void_p) != 8:
        return False
    action = ctypes.c_uint32(_ERRNO)
    call = _number_of_seccomp(machine)
    return bool(ctypes.CDLL(None).syscall(call, _ACTION_AVAILABLE, 0, ctypes.byref(action)) == 0)


def give_up_calls(own: int) -> None:
    """Refuse the calls from now on, to this thread and those that it starts.

    Args:
        own: number of this process, which alone it may send signals.

    Raises:
        OSError: the system does not take the filter.
    """
    machine = _MACHINES[platform.machine()]
    lines = _filter(machine, own)
    instructions = (_Instruction * len(lines))(*(_Instruction(*line) for line in lines))
    program = _Program(len(lines), instructions)
    if ctypes.CDLL(None, use_errno=True).syscall(
        _number_of_seccomp(machine), _SET_MODE_FILTER, 0, ctypes.byref(program)
    ):
        number = ctypes.get_errno()
        raise OSError(number, f"seccomp: {errno.errorcode.get(number, number)}")


def _number_of_seccomp(machine: _Machine) -> int:
    return _REFUSED["seccomp"][machine.column] or 0


def _filter(machine: _Machine, own: int) -> list[tuple[int, int, int, int]]:
    """The filter as (code, jump if so, jump if not, value); it lets pass what it does not name."""
    refuse, allow = (_RETURN, 0, 0, _ERRNO | errno.EPERM), (_RETURN, 0, 0, _ALLOW)
    absent = _RETURN, 0, 0, _ERRNO | errno.ENOSYS
    lines = [(_LOAD, 0, 0, _ARCHITECTURE), (_EQUAL, 1, 0, machine.audit), (_RETURN, 0, 0, _KILL)]
    lines += [(_LOAD, 0, 0, _NUMBER), (_AT_LEAST, 0, 1, _LATEST + 1), absent]
    lines += [(_EQUAL, 0, 1, _CLONE3[machine.column]), absent]  # its flags cannot be seen; libraries then take clone
    for numbers in _REFUSED.values():
        if (number := numbers[machine.column]) is not None:
            lines += [(_EQUAL, 0, 1, number), refuse]

    def of(call: tuple[int, int], *decisions: tuple[int, int, int, int]) -> None:
        lines.extend([(_EQUAL, 0, len(decisions), call[machine.column]), *decisions])

    of(_CLONE, (_LOAD, 0, 0, _FIRST), (_ANY_BIT, 1, 0, _THREAD), refuse, allow)
    for call, values in ((_IOCTL, _IOCTLS), (_FCNTL, _OWNERS)):
        wrong = [line for value in values for line in ((_EQUAL, 0, 1, value), refuse)]
        of(call, (_LOAD, 0, 0, _SECOND), *wrong, allow)
    for call in (_PRLIMIT, *_SCHEDULING):
        of(call, (_LOAD, 0, 0, _FIRST), (_EQUAL, 1, 0, 0), refuse, allow)
    for call in (_KILL_CALL, _TGKILL):
        of(call, (_LOAD, 0, 0, _FIRST), (_EQUAL, 1, 0, own), refuse, allow)
    return [*lines, allow]
