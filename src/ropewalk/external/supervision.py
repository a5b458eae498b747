"""Supervision: the process between a run and an isolated FMU. It starts the FMU's process, and ends with it.

It has no FMU and no NumPy in it. Its child confines itself before it imports anything large, while it has one thread.
The supervisor passes on what the FMU prints, watches how much it takes, and ends it, with all that it has started, when
the run ends or is killed. Then it removes the folder of the FMU and leaves with the exit code or signal of its child.
"""

from __future__ import annotations

import codecs
import os
import select
import shutil
import signal
import sys
import time
from contextlib import suppress
from typing import NoReturn

from ropewalk.external.confinement import LARGEST_FILE, adopt_orphans, confine, end_with_parent, most_memory

LOOK, SOON, SELDOM = 0.2, 0.01, 1.0  # s between looks: usually, when the child can print no more, at its folder
MOST_THREADS = 1000
MOST_ON_DISK = 2 * LARGEST_FILE
MOST_PRINTED = 1 << 20  # bytes that are passed on
EXCESS = {
    81: f"took more memory than it may ({most_memory() / 1e9:.2g} GB)" if hasattr(os, "sysconf") else "",
    82: f"had more than {MOST_THREADS} threads",
    83: f"filled its folder with more than {MOST_ON_DISK / 1e9:.2g} GB",
}
"""What a child was ended for, by the exit code of its supervisor."""


class _Ended(BaseException):
    """The run has asked for the end."""


def main(folder: str, parent: int) -> None:
    """Start the process of an FMU and supervise it; or be it, where the system does not know forks.

    Args:
        folder: where the FMU is unpacked, the only place where it may write.
        parent: number of the process of the run.
    """
    if not hasattr(os, "fork"):
        _serve(folder, "")
        return
    adopt_orphans()
    reader, writer = os.pipe()
    own, child = os.getpid(), os.fork()
    if child:
        os.close(writer)
        _supervise(child, reader, folder, parent)
    os.setsid()
    end_with_parent(own)
    os.dup2(writer, 2)
    os.close(reader)
    os.close(writer)
    trouble = ""
    try:
        confine(folder)
    except (OSError, ValueError) as error:
        trouble = f"the system does not let it be held back ({error}); isolated: false runs it with all your rights"
    _serve(folder, trouble)


def _serve(folder: str, trouble: str) -> None:
    os.environ["TMPDIR"] = folder
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.dont_write_bytecode = True
    from ropewalk.external.fmu_process import serve  # lazy: this imports NumPy

    serve(folder, trouble)


def _supervise(child: int, printed: int, folder: str, parent: int) -> NoReturn:
    """Wait for the end of the child or of the run, tidy up, and leave as the child has left."""
    for stream in (0, 1):
        os.dup2(os.open(os.devnull, os.O_RDWR), stream)
    status, code = 0, 0
    try:
        signal.signal(signal.SIGTERM, _end)
        status, code = _watched(child, _Relay(printed), folder, parent)
    except _Ended:
        code = 1
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        _end_all(child)
        shutil.rmtree(folder, ignore_errors=True)
    if not code and os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        with suppress(OSError, ValueError):
            import resource

            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)
    os._exit(code or os.waitstatus_to_exitcode(status))


def _end(_number: int, _frame: object) -> NoReturn:
    raise _Ended


def _watched(child: int, relay: _Relay, folder: str, parent: int) -> tuple[int, int]:
    """The status of a child that has ended by itself, or the code to leave with."""
    due = time.monotonic() + SELDOM
    while True:
        relay.wait()
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            relay.drain()
            return status, 0
        if os.getppid() != parent:
            return 0, 1
        code = _excess(child)
        if not code and time.monotonic() > due:
            code = 83 if _on_disk(folder) > MOST_ON_DISK else 0
            due = time.monotonic() + SELDOM
        if code:
            return 0, code


def _excess(child: int) -> int:
    """The code of what a child takes too much of, as far as the system tells it; 0 if of nothing."""
    try:
        with open(f"/proc/{child}/status", encoding="ascii", errors="replace") as stream:
            found = dict(line.split(":", 1) for line in stream if line.startswith(("VmRSS", "Threads")))
    except (OSError, ValueError):
        return 0
    if int(found.get("VmRSS", "0 kB").split()[0]) * 1024 > most_memory():
        return 81
    return 82 if int(found.get("Threads", "1")) > MOST_THREADS else 0


def _on_disk(folder: str) -> int:
    size = 0
    for place, _, names in os.walk(folder):
        for name in names:
            with suppress(OSError):
                size += os.lstat(os.path.join(place, name)).st_blocks * 512
    return size


def _end_all(child: int) -> None:
    """Kill the child, and whatever it has left behind, which is ours then."""
    own = f"/proc/self/task/{os.getpid()}/children"
    pending = [child]
    while pending:
        for number in pending:
            with suppress(OSError):
                os.kill(number, signal.SIGKILL)
            with suppress(OSError):
                os.waitpid(number, 0)
        try:
            with open(own, encoding="ascii") as stream:
                pending = [int(number) for number in stream.read().split()]
        except OSError:
            pending = []


class _Relay:
    """What a child prints, passed on to stderr without signs that control a terminal, and not for ever."""

    def __init__(self, reader: int) -> None:
        self._reader, self._left, self._is_open = reader, MOST_PRINTED, True
        self._decoder = codecs.getincrementaldecoder("utf-8")("replace")

    def wait(self) -> None:
        """Wait a moment, and pass on what comes."""
        if not self._is_open:
            time.sleep(SOON)
        elif select.select([self._reader], [], [], LOOK)[0]:
            self._pass_on()

    def drain(self) -> None:
        """Pass on what is left, once nobody prints any more."""
        os.set_blocking(self._reader, False)
        while self._is_open:
            self._pass_on()

    def _pass_on(self) -> None:
        try:
            data = os.read(self._reader, 1 << 16)
        except OSError:  # nothing there
            data = b""
        self._is_open = bool(data)
        if self._left <= 0 or not data:
            return
        self._left -= len(data)
        text = self._decoder.decode(data)
        text = "".join(sign if sign.isprintable() or sign in "\n\t" else "?" for sign in text)
        if self._left <= 0:
            text += "\n... the FMU prints more than is shown\n"
        with suppress(OSError):
            os.write(2, text.encode("utf-8", "replace"))
