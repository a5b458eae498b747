"""Recording: frames in, a labelled dataset out, in memory or streaming to a NetCDF file."""

from __future__ import annotations

import contextlib
import time
import zlib
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Protocol, Self

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.results import checksums, contract
from ropewalk.results.files import WriteError, alone, beside, check_target, open_result
from ropewalk.results.frame import Array, Frame, Layout, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.labelled import of_frames
from ropewalk.results.slots import Past, Slots, cut, digests
from ropewalk.results.verdict import Verdict

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario
    from ropewalk.results.running import Run

SYNC_SECONDS = 1.0  # a killed run loses no more than this
SLOW_FRAME = 0.1  # frames that come more slowly, in s, are written at once: it costs next to nothing then
BLOCK_BYTES = 1_000_000  # frames wait in memory up to this size: fewer and larger writes
BLOCK_ROWS = 512
_CUT_SHORT = ("interrupted", "failed")  # outcomes of runs that did not come to where they were before
_METADATA = ("method", "reason", "step", "doubts", "warnings")  # kept up to date while a run continues
RESERVE = 16 * 1024  # bytes kept free in the header for attributes that grow, or else the data would have to move


class Recorder:
    """Collects the frames of a run; use it as a context manager, or call `close` at the end.

    Args:
        layout: names and coordinates of the result.
        scenario: what is run; it goes into the attributes as JSON.
        run_info: how the run goes; read again whenever the file is brought up to date, and at the end.
        file: stream to this NetCDF file, or keep everything in memory. An earlier one is replaced with the first
            frame: a run that never begins leaves it as it was.
        run: whose state the file is to hold, so that it can be taken up again.
        past: the frames that the file has already; what comes goes behind them.
        opened: what opens the file at the end.

    Raises:
        ResultError: a result cannot be written to `file`; nothing has been touched then.
    """

    def __init__(
        self,
        layout: Layout,
        scenario: Scenario,
        run_info: RunInfo,
        file: Path | None = None,
        *,
        run: Run | None = None,
        past: Past | None = None,
        opened: Callable[[Path], xr.Dataset] = open_result,
    ) -> None:
        if layout.path not in contract.PATHS:
            raise ValueError(f"the leading dimension is one of {', '.join(contract.PATHS)}, not {layout.path!r}")
        self._run_info = run_info
        self._verdict = Verdict(layout, scenario)
        self._shapes = contract.shapes(layout)
        self._result: xr.Dataset | None = None
        self._closed = False
        fixed = contract.scenario_attributes(scenario)
        if past is not None:
            for frames in past.frames(layout):
                self._verdict.see(frames)
        kept = None if run is None or file is None else partial(_checkpoint, digests(scenario), run_info, run)
        self._store: _Store = (
            _Memory(layout, fixed, run) if file is None else _File(layout, fixed, file, run, kept, past, opened)
        )

    @property
    def frames(self) -> int:
        """Number of frames recorded so far."""
        return self._store.count

    def append(self, frame: Frame) -> None:
        """Record a frame, as `extend` does."""
        self.extend(Frames.together([frame]))

    def extend(self, frames: Frames) -> None:
        """Record frames; their arrays are copied and may be used again.

        Raises:
            ValueError: an array does not have the shape of the layout.
            WriteError: the file cannot be written any further.
        """
        if self._closed:
            raise ValueError("the recorder is closed")
        for name, shape in self._shapes.items():
            given = frames.of[name].shape[1:] if name in frames.of else None
            if given != shape and not (given is None and 0 in shape):
                raise ValueError(f"frame {self.frames}: {name} has shape {given}, the layout requires {shape}")
        self._verdict.see(frames)
        self._store.extend(frames, self._run_info)

    def close(self) -> xr.Dataset:
        """Finish the record and give it as a dataset; a file is complete and closed then.

        Raises:
            WriteError: the last frames cannot be written.
        """
        if not self._closed:
            self._closed = True
            self._verdict.judge(self._run_info)
            self._run_info.conclude()
            try:
                self._store.finish(self._run_info)
            finally:
                self._store.release()
        if self._result is None:
            self._result = self._store.result(self._run_info)
        return self._result

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        run_info = self._run_info
        if problem is None:
            self.close()
            return
        if run_info.outcome == "running":
            run_info.outcome = "interrupted" if isinstance(problem, KeyboardInterrupt) else "failed"
            run_info.advice = run_info.advice or str(problem)
        if not self._closed:
            self._closed = True
            if self.frames:
                self._verdict.judge(run_info)
                with contextlib.suppress(WriteError):  # the problem under way is the one to report
                    self._store.finish(run_info)
            self._store.release()


def _checkpoint(data: dict[str, str], run_info: RunInfo, run: Run) -> Tree | None:
    """What a run continues from; None if there is nothing."""
    state = run.get_state()
    if state is None:
        return None
    return {
        "data": data, "run": state, "seconds": [run_info.wall_seconds, run_info.cpu_seconds, run_info.compile_seconds],
    }  # fmt: skip


class _Store(Protocol):
    count: int

    def extend(self, frames: Frames, run_info: RunInfo) -> None: ...

    def finish(self, run_info: RunInfo) -> None: ...

    def release(self) -> None: ...

    def result(self, run_info: RunInfo) -> xr.Dataset: ...


def _rows(layout: Layout, rows: int) -> dict[str, Array]:
    """Arrays for some frames; no page of them is touched before it is written to."""
    arrays = {name: np.empty((rows, *shape)) for name, shape in contract.shapes(layout).items()}
    return {contract.PATH: np.empty(rows), **arrays}


def _put(frames: Frames, arrays: dict[str, Array], row: int, part: slice) -> None:
    """Copy some frames to rows of arrays from a row on."""
    rows = slice(row, row + part.stop - part.start)
    for name, array in arrays.items():
        given = frames.path if name == contract.PATH else frames.of.get(name)
        if given is not None:
            array[rows] = given[part]


class _Memory:
    """Arrays for all frames of a run; where their number is not known, they double when they are full."""

    def __init__(self, layout: Layout, fixed: dict[str, contract.Attribute], run: Run | None = None) -> None:
        self.count = 0
        self._layout, self._fixed = layout, fixed
        self._arrays = _rows(layout, 64 if run is None else run.total)

    def extend(self, frames: Frames, run_info: RunInfo) -> None:
        if self.count + len(frames) > len(self._arrays[contract.PATH]):
            self._resize(max(2 * self.count, self.count + len(frames)))
        _put(frames, self._arrays, self.count, slice(0, len(frames)))
        self.count += len(frames)

    def _resize(self, rows: int) -> None:
        for array in self._arrays.values():
            array.resize((rows, *array.shape[1:]), refcheck=False)  # in place: no second copy of a large result

    def finish(self, run_info: RunInfo) -> None:
        self._resize(self.count)

    def release(self) -> None:
        """Nothing is kept from others."""

    def result(self, run_info: RunInfo) -> xr.Dataset:
        attributes = {**self._fixed, **contract.run_info_attributes(run_info)}
        return of_frames(self._layout, self._arrays[contract.PATH], self._arrays, attributes)


class _File:
    """A NetCDF file that is readable at any time.

    It has the classic format (64-bit offsets), whose frames follow one another behind a header that holds their
    number: a kill at any instant, and a full disk, leave what was synchronised before. The HDF5-based format was
    found unreadable after kills during a write (`docs/notes/result-file.md`).
    """

    def __init__(
        self,
        layout: Layout,
        fixed: dict[str, contract.Attribute],
        file: Path,
        run: Run | None = None,
        kept: Callable[[], Tree | None] | None = None,
        past: Past | None = None,
        opened: Callable[[Path], xr.Dataset] = open_result,
    ) -> None:
        self.count = past.count if past is not None else 0
        self._layout, self._fixed, self._past, self._opened = layout, fixed, past, opened
        self.path = check_target(file) if past is None else file  # whoever takes it up has looked
        self._total = run.total if run is not None else None
        self._slots = Slots(kept, past.number if past is not None else 0) if kept is not None else None
        self._lock = ExitStack()
        if past is None:
            self._lock.enter_context(alone(self.path))
        self._crc = 0  # of the frames that are in the file
        self._arrays = _rows(layout, block_rows(layout))
        self._file: Any = None
        self._begun = False
        self._base = self._written = self.count  # first frame in the block, and first that is not in the file
        self._metadata: dict[str, contract.Attribute] = {}
        self._last_append = self._last_sync = time.monotonic()

    def _begin(self, run_info: RunInfo) -> None:
        """Replace an earlier file: not before there is something to write."""
        self._begun = True
        if self._past is not None:
            self._reopen(run_info)
            return
        made = beside(self.path, "new")
        try:
            attributes = {**self._fixed, **contract.run_info_attributes(run_info)}
            self._file = _create(made, self._layout, attributes, self._slots)
            made.replace(self.path)  # a reader of the earlier result keeps what it has open
        except (OSError, RuntimeError) as problem:
            self._file = None
            with contextlib.suppress(OSError):
                made.unlink(missing_ok=True)
            raise WriteError(f"{self.path}: cannot be created ({problem}); is the disk full?") from problem

    def _reopen(self, run_info: RunInfo) -> None:
        """Go on in a file: it serves the present request from now on."""
        import netCDF4

        assert self._past is not None
        try:
            if self._past.cut_short:
                cut(self.path, self.count)
            self._crc = checksums.frames_crc(self.path, self.count)
            self._file = netCDF4.Dataset(self.path, "r+")
            self._file.set_fill_off()
            metadata = {**self._fixed, **contract.run_info_attributes(run_info), **self._checks(self.count, self._crc)}
            self._file.setncatts(_storable({**metadata, checksums.HEAD: checksums.NONE}))
            self._file.sync()
        except (OSError, RuntimeError) as problem:
            raise WriteError(f"{self.path}: cannot be written ({problem})") from problem
        if self._slots is not None:
            self._slots.use(self._file)

    def extend(self, frames: Frames, run_info: RunInfo) -> None:
        if not self._begun:
            self._begin(run_info)
        now, space = time.monotonic(), len(self._arrays[contract.PATH])
        slow = now - self._last_append >= SLOW_FRAME * len(frames) or self.count == 0
        self._last_append, done = now, 0
        while done < len(frames):
            row = self.count - self._base
            part = slice(done, min(len(frames), done + space - row))
            _put(frames, self._arrays, row, part)
            self.count, done = self.count + part.stop - done, part.stop
            if done < len(frames):
                self._flush(run_info, _METADATA)
        last, full = self.count == self._total, self.count - self._base == space
        if full or slow or last or now - self._last_sync >= SYNC_SECONDS:
            self._flush(run_info, _METADATA)
            if self._slots is not None and self._slots.is_due(at_once=last):
                self._keep()

    def _flush(self, run_info: RunInfo, keys: Iterable[str]) -> None:
        """Write what is new and synchronise; harmless to repeat after an interrupt."""
        first, last = self._written, self.count
        try:
            for name, variable in self._file.variables.items():
                array = self._arrays.get(contract.PATH if name == self._layout.path else name)
                if array is not None and last > first:
                    variable[first:last] = array[first - self._base : last - self._base]
            self._file.sync()
            crc = zlib.crc32(self._bytes(first, last), self._crc)
            self._tell(run_info, keys)  # after the frames that it is of: a kill in between leaves them unchecked
            self._file.setncatts(_storable(self._checks(last, crc)))
            self._file.sync()
        except (OSError, RuntimeError) as problem:
            self._file = None  # closes it; an explicit close fails as well, and a second one crashes
            raise WriteError(
                f"{self.path}: cannot be written any further ({problem}); is the disk full? "
                f"{first} frames had been written before"
            ) from problem
        self._written, self._crc = last, crc
        if last - self._base == len(self._arrays[contract.PATH]):
            self._base = last
        self._last_sync = time.monotonic()

    def _bytes(self, first: int, last: int) -> bytes:
        """Frames as the file has them."""
        if first == last:
            return b""
        rows, arrays = slice(first - self._base, last - self._base), self._arrays
        names = [contract.PATH if name == self._layout.path else name for name in self._file.variables]
        parts = [arrays[name][rows].reshape(last - first, -1) for name in names if name in arrays]
        return np.concatenate(parts, axis=1).astype(">f8").tobytes()

    def _checks(self, frames: int, crc: int) -> dict[str, contract.Attribute]:
        return {checksums.CHECKED: frames, checksums.FRAMES: f"{crc:08x}"}

    def _keep(self) -> None:
        """Write a checkpoint, of right after the last frame."""
        assert self._slots is not None
        try:
            self._slots.write(self._file)
        except (OSError, RuntimeError) as problem:
            self._file = None
            raise WriteError(f"{self.path}: cannot be written any further ({problem}); is the disk full?") from problem

    def _tell(self, run_info: RunInfo, keys: Iterable[str]) -> None:
        values = contract.run_info_attributes(run_info)
        news = {key: values[key] for key in keys if values[key] != self._metadata.get(key)}
        if news:
            self._file.setncatts(_storable(news))
            self._metadata.update(news)

    def finish(self, run_info: RunInfo) -> None:
        if not self._begun:
            self._begin(run_info)
        if self._file is None:
            return
        self._flush(run_info, contract.run_info_attributes(run_info))
        try:
            self._file.close()
        except (OSError, RuntimeError) as problem:
            self._file = None
            raise WriteError(f"{self.path}: cannot be completed ({problem}); is the disk full?") from problem
        if self._past is not None and self.count < self._past.stored and run_info.outcome not in _CUT_SHORT:
            cut(self.path, self.count)  # the rest of the earlier run is not computed
        try:
            checksums.seal(self.path)
        except (OSError, checksums.DamagedError) as problem:
            raise WriteError(f"{self.path}: cannot be completed ({problem}); is the disk full?") from problem

    def release(self) -> None:
        """Let others write the file."""
        self._lock.close()

    def result(self, run_info: RunInfo) -> xr.Dataset:
        return self._opened(self.path)


def block_rows(layout: Layout) -> int:
    """Number of frames that wait in memory for being written."""
    return int(np.clip(BLOCK_BYTES // contract.numbers(layout), 1, BLOCK_ROWS))


def _storable(attributes: dict[str, contract.Attribute]) -> dict[str, Any]:
    """Attributes as the classic format takes them: it knows no integers of 64 bits."""
    return {
        key: (np.int32(value) if abs(value) < 2**31 else float(value)) if isinstance(value, int) else value
        for key, value in attributes.items()
    }


def _create(path: Path, layout: Layout, attributes: dict[str, contract.Attribute], slots: Slots | None = None) -> Any:
    import netCDF4

    file = netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET")
    file.set_fill_off()  # every value is written, once
    size = contract.sizes(layout)
    file.createDimension(layout.path, None)
    for name in size:
        if size[name]:  # a length of zero would mean "unlimited"; `open_result` gives what is missing
            file.createDimension(name, size[name])
    unknown = {checksums.FRAMES: checksums.NONE, checksums.HEAD: checksums.NONE, "reserve": " " * RESERVE}
    file.setncatts(_storable({**attributes, checksums.CHECKED: 0, **unknown}))
    for name, quantity in contract.COORDINATES.items():
        if all(size[d] for d in quantity.dims):
            _write_coordinate(file, name, quantity, contract.coordinate_values(layout)[name])
    if slots is not None:
        slots.define(file)
        if slots.lacking:
            file.setncattr(contract.LACKING, slots.lacking)
    variables = {layout.path: contract.PATHS[layout.path], **contract.VARIABLES}
    for name, quantity in variables.items():
        if all(size[d] for d in quantity.dims):
            variable = file.createVariable(name, "f8", (layout.path, *quantity.dims))
            variable.setncatts(quantity.attributes)
            if auxiliary := _auxiliary(quantity.dims):
                variable.setncattr("coordinates", auxiliary)
    file.sync()
    file.delncattr("reserve")
    file.sync()
    return file


def _auxiliary(dims: tuple[str, ...]) -> str:
    """Names of the coordinates that are not dimensions, in the way of the CF conventions."""
    return " ".join(n for n, q in contract.COORDINATES.items() if n not in q.dims and q.dims[0] in dims)


def _write_coordinate(file: Any, name: str, quantity: contract.ResultVariable, values: Any) -> None:
    if values.dtype.kind != "U":
        variable = file.createVariable(name, "f8", quantity.dims)
        variable[:] = values
    else:
        width = max(len(text.encode()) for text in values.tolist())
        data = np.char.encode(values, "utf-8").astype(f"S{width}")
        file.createDimension(f"{name}_letters", width)
        variable = file.createVariable(name, "S1", (*quantity.dims, f"{name}_letters"))
        variable.set_auto_chartostring(False)
        variable[:] = data.view("S1").reshape(-1, width)
        variable.setncattr("_Encoding", "utf-8")
    variable.setncatts(quantity.attributes)
