"""Where compiled kernels are kept, and that nothing else is taken for them.

Numba asks whether the file of a kernel has changed, but not whether the kernels that it calls have: here the folder is
named after the contents of all. What is kept carries a checksum; what is spoilt is compiled anew. Of kernels that are
kept for another processor, as in an image that comes from elsewhere, only the machine code is made anew.
"""

from __future__ import annotations

import hashlib
import math
import os
import pickle
import shutil
import sys
import tempfile
import uuid
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core import event as events
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile, UserProvidedCacheLocator
from numba.core.environment import Environment, _rebuild_env, lookup_environment
from numba.core.registry import cpu_target
from numba.core.runtime.nrt import rtsys
from numpy.typing import NDArray

from ropewalk.interrupts import note_loading
from ropewalk.mechanics.kernel_parts import rebuilt, reduced

PACKAGE = Path(__file__).parents[1]
HOLD_KERNELS = ("mechanics", "solve", "system", "wires")
"""Folders of the package whose files hold kernels, or constants that are compiled into them."""
_PREFIX = "kernels-"
PARTS = "parts"
"""Folder of the code of single functions, beside those of the packages."""
_KEPT = 3  # states of the sources whose kernels are kept
_SEAL = hashlib.sha256().digest_size


@cache
def digest() -> str:
    """Of all that compiled kernels come of: their sources, and the versions of what compiles them."""
    found = hashlib.sha256(f"{numba.__version__} {np.__version__} {sys.version}".encode())
    for name in HOLD_KERNELS:
        for path in sorted((PACKAGE / name).rglob("*.py")):
            found.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return found.hexdigest()[:16]


def processor() -> Any:
    """What machine code depends on."""
    return cpu_target.target_context.codegen().magic_tuple()


def _places() -> Iterator[Path]:
    """Folders that outlast the process, the best first."""
    if wanted := os.environ.get("NUMBA_CACHE_DIR"):
        yield Path(wanted)
    yield PACKAGE / "__pycache__"
    from platformdirs import user_cache_path  # seldom needed

    with suppress(RuntimeError):  # there is no home
        yield user_cache_path("ropewalk", appauthor=False)


@cache
def folder() -> Path:
    """The folder of the kernels of these sources; it can be written."""
    name, closed = _PREFIX + digest(), list[Path]()
    for place in _places():
        if _is_writable(place / name):
            break
        closed.append(place)
    else:
        place = _passing()
        warnings.warn(
            f"compiled kernels are kept in {place} as long as that lasts, for none of "
            f"{', '.join(map(str, closed))} can be written; NUMBA_CACHE_DIR names another folder",
            RuntimeWarning,
            stacklevel=2,
        )
        _is_writable(place / name)
    found = place / name
    if not any(found.iterdir()):
        for other in closed:  # an image may bring its kernels along in a folder that nobody writes to
            if (other / name).is_dir():
                with suppress(OSError, shutil.Error):
                    shutil.copytree(other / name, found, dirs_exist_ok=True)
        _clear(place, found)
    return found


def _is_writable(place: Path) -> bool:
    try:
        place.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=place).close()
    except OSError:
        return False
    return True


def _passing() -> Path:
    """A folder among the temporary ones that nobody else can have put kernels into."""
    if not hasattr(os, "getuid"):
        return Path(tempfile.mkdtemp(prefix="ropewalk-"))
    place = Path(tempfile.gettempdir()) / f"ropewalk-{os.getuid()}"
    with suppress(OSError):
        place.mkdir(mode=0o700, exist_ok=True)
        status = place.lstat()
        if place.is_dir() and not place.is_symlink() and status.st_uid == os.getuid() and not status.st_mode & 0o022:
            return place
    return Path(tempfile.mkdtemp(prefix="ropewalk-"))


def _clear(place: Path, new: Path) -> None:
    """Throw away the kernels of sources of long ago."""
    with suppress(OSError):
        others = [path for path in place.glob(f"{_PREFIX}*") if path != new]
        others.sort(key=lambda path: path.stat().st_mtime, reverse=True)
        for path in others[_KEPT - 1 :]:
            shutil.rmtree(path, ignore_errors=True)


class _Locator(UserProvidedCacheLocator):
    def __init__(self, py_func: Any, py_file: str) -> None:
        self._py_file, self._lineno = py_file, py_func.__code__.co_firstlineno
        self._cache_path = str(folder() / Path(py_file).parent.name)

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> _Locator:
        found = cls(py_func, py_file)
        Path(found._cache_path).mkdir(exist_ok=True)
        return found


class _Implementation(CompileResultCacheImpl):
    _locator_classes = [_Locator]  # noqa: RUF012

    def reduce(self, cres: Any) -> Any:
        return reduced(cres, folder() / PARTS)

    def rebuild(self, target_context: Any, payload: Any, *, other_machine: bool = False) -> Any:
        return rebuilt(target_context, folder() / PARTS, payload, other_machine=other_machine)


class _Files(IndexDataCacheFile):
    """Index and machine code of a kernel, each behind its checksum."""

    def save(self, key: Any, data: Any) -> None:
        """Keep the code of a kernel for some types under a name of its own.

        Numba counts its files: two processes might give one number to the code for different types.
        """
        name = self._data_name(int.from_bytes(hashlib.sha256(repr(key).encode()).digest()[:8]))
        self._save_data(name, data)
        self._save_index({**self._load_index(), key: name})

    def _save_index(self, overloads: dict[Any, str]) -> None:
        self._write(self._index_path, (self._source_stamp, overloads))

    def _load_index(self) -> dict[Any, str]:
        found = self._read(self._index_path)
        return found[1] if found is not None and found[0] == self._source_stamp else {}

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), data)

    def _load_data(self, name: str) -> Any:
        return self._read(self._data_path(name))

    def _write(self, path: str, content: Any) -> None:
        data = self._dump(content)
        with self._open_for_write(path) as stream:
            stream.write(hashlib.sha256(data).digest() + data)

    def _read(self, path: str) -> Any:
        """What has been written; None of what is not there or as it was, or needs modules that have gone."""
        data = _unsealed(Path(path))
        if data is None:
            return None
        try:
            return _Unpickler(BytesIO(data)).load()
        except Exception:  # whatever those raise that are asked for by name
            return None


class _Unpickler(pickle.Unpickler):
    def find_class(self, module: str, name: str) -> Any:
        """As always, but for what would import a part of Numba for each of its functions in a kernel."""
        return _environment if name == _rebuild_env.__name__ else super().find_class(module, name)


def _environment(module: str, constants: list[Any], name: str) -> Environment:
    """What a function in a kernel needs of Python: its constants. Globals of its module are for its compiler only."""
    found: Environment | None = lookup_environment(name)
    if found is None:
        known = sys.modules.get(module)
        found = Environment({"__name__": module} if known is None else known.__dict__)
        found.consts[:] = constants
        found.env_name = name
        Environment._memo[name] = found
    return found


def _unsealed(path: Path) -> bytes | None:
    """What is behind the checksum of a file; None of what is not there or not as it was."""
    try:
        data = path.read_bytes()
    except OSError:
        return None
    return data[_SEAL:] if hashlib.sha256(data[_SEAL:]).digest() == data[:_SEAL] else None


def kept(name: str, shape: tuple[int, ...], make: Callable[[], NDArray[np.float64]]) -> NDArray[np.float64]:
    """An array of numbers that follow from the sources alone, as kernels do, and are kept beside these.

    Args:
        name: of the array, one for each.
        shape: of it.
        make: computes it, where it is not there.
    """
    file = folder() / name
    data = _unsealed(file)
    if data is not None and len(data) == 8 * math.prod(shape):
        return np.frombuffer(data).reshape(shape).copy()
    found = np.ascontiguousarray(make(), dtype=np.float64)
    data, beside = found.tobytes(), file.with_name(f"{name}.{uuid.uuid4().hex}")
    with suppress(OSError):  # where there is no place it is computed again another time
        beside.write_bytes(hashlib.sha256(data).digest() + data)
        os.replace(beside, file)
    return found


class KernelCache(FunctionCache):
    """The cache of one kernel."""

    _impl_class = _Implementation

    def __init__(self, dispatcher: Any) -> None:
        super().__init__(dispatcher.py_func)
        self._dispatcher = dispatcher
        self._cache_file = _Files(self._cache_path, self._impl.filename_base, self._impl.locator.get_source_stamp())

    def signatures(self) -> list[tuple[Any, ...]]:
        """For which types of arguments there is code for this processor."""
        return [kinds for kinds, made_for, *_ in self._cache_file._load_index() if made_for == processor()]

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """A kernel from the cache. What compiles calls for is not read in yet: the compiler does so itself."""
        note_loading(True)
        try:
            rtsys.initialize(target_context)
            with self._guard_against_spurious_io_errors():
                return self._load_overload(sig, target_context)
        finally:
            note_loading(False)

    def _load_overload(self, sig: Any, target_context: Any) -> Any:
        """A kernel from the cache; of one that is there for another processor only, machine code is made."""
        found = super()._load_overload(sig, target_context)
        kinds, (system, *_), code = self._index_key(sig, target_context.codegen())
        for other in () if found is not None else self._cache_file._load_index():
            if (other[0], other[1][0], other[2]) == (kinds, system, code) and (kept := self._cache_file.load(other)):
                with events.trigger_event("numba:compile", data={"dispatcher": self._dispatcher}):
                    found = self._impl.rebuild(target_context, kept, other_machine=True)
                if found is not None:
                    self.save_overload(sig, found)
                    break
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a kernel; where there is no place it will be compiled again another time."""
        try:
            super().save_overload(sig, data)
        except OSError as problem:
            _warn_once(f"compiled kernels cannot be kept in {folder()} ({problem.strerror})")


@cache
def _warn_once(message: str) -> None:
    warnings.warn(message, RuntimeWarning, stacklevel=2)


def keep(dispatcher: Any) -> Any:
    """Let a kernel keep its machine code."""
    if hasattr(dispatcher, "enable_caching"):  # not as plain Python
        dispatcher._cache = KernelCache(dispatcher)
    return dispatcher
