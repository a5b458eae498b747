"""Whether a result file is whole: its header makes sense, it is as long as that says, and its checksums are right.

Of the classic NetCDF format with 64-bit offsets, in which frames follow one another behind all else (see
docs/notes/result-file.md). A file that is being written, or whose run was killed, has a checksum of the frames up to a
second ago; one that was finished has it of all frames, and another one of all that stands before them.
"""

from __future__ import annotations

import os
import zlib
from pathlib import Path
from typing import BinaryIO, NamedTuple

from ropewalk.errors import RopewalkError

FRAMES, CHECKED, HEAD = "frames_crc32", "frames_checked", "head_crc32"  # attributes of a result file
ATTRIBUTES = (FRAMES, CHECKED, HEAD)
NONE = "0" * 8  # stands for a checksum that is not known yet
_MAGIC = b"CDF\x02"

_DIMENSION, _VARIABLE, _ATTRIBUTE = 10, 11, 12
_BYTES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 4, 6: 8}  # of a number of each of the format's types
_BLOCK = 1 << 22  # bytes that are read at a time
_MOST = 1 << 16  # entries that a list of the header may have


class DamagedError(RopewalkError):
    """A result file that is not what was written; a sentence that says what is wrong."""


class CutShortError(DamagedError):
    """One that ends before its last frame.

    Args:
        whole: how many of its frames are there.
        frames: how many there were.
    """

    def __init__(self, whole: int, frames: int) -> None:
        self.whole = whole
        super().__init__(f"is truncated: it contains {whole} of its {frames} frames")


class Head(NamedTuple):
    """What the header of a file says of its frames."""

    frames: int
    begin: int  # byte at which they begin
    size: int  # bytes of a frame
    attributes: dict[str, bytes]
    places: dict[str, int]  # byte at which the value of an attribute begins

    def whole_frames(self, size: int) -> int:
        """How many frames a file of a size in bytes has."""
        return min(self.frames, max(size - self.begin, 0) // self.size) if self.size else self.frames


class _HeaderReader:
    """Numbers and texts of a header, one after the other; none of them reaches beyond the end of the file."""

    def __init__(self, stream: BinaryIO) -> None:
        self.stream, self.end = stream, stream.seek(0, os.SEEK_END)
        self.at = stream.seek(len(_MAGIC))

    def number(self, size: int = 4) -> int:
        return int.from_bytes(self._take(size), "big")

    def _take(self, size: int) -> bytes:
        if self.at + size > self.end:
            raise DamagedError("ends within its header")
        self.at += size
        return self.stream.read(size)

    def padded(self, size: int) -> bytes:
        """Some bytes, which are followed by as many as make a multiple of four of them."""
        if size > self.end - self.at:
            raise DamagedError("ends within its header, or the header is damaged: an entry is larger than the file")
        found = self._take(size)
        self._take(-size % 4)
        return found

    def count(self, tag: int) -> int:
        """Number of entries of the list that begins here."""
        found, count = self.number(), self.number()
        if (found != tag and (found or count)) or count > _MOST:
            raise DamagedError("has a damaged header: a list has a wrong tag")
        return count

    def name(self) -> str:
        return self.padded(self.number()).decode("utf-8", "replace")

    def attributes(self) -> tuple[dict[str, bytes], dict[str, int]]:
        found, places = {}, {}
        for _ in range(self.count(_ATTRIBUTE)):
            name, kind, count = self.name(), self.number(), self.number()
            if kind not in _BYTES:
                raise DamagedError(f"has a damaged header: attribute {name!r} is of no known type")
            places[name] = self.at
            found[name] = self.padded(count * _BYTES[kind])
        return found, places


def _head(reader: _HeaderReader) -> Head:
    frames = reader.number()
    lengths = []
    for _ in range(reader.count(_DIMENSION)):
        reader.name()
        lengths.append(reader.number())
    attributes, places = reader.attributes()
    begins, size, before = [], 0, 0
    for _ in range(reader.count(_VARIABLE)):
        name, dimensions = reader.name(), []
        for _ in range(reader.number()):
            dimensions.append(reader.number())
            if dimensions[-1] >= len(lengths):
                raise DamagedError(f"has a damaged header: variable {name!r} has an undefined dimension")
        reader.attributes()
        kind, metadata, first = reader.number(), reader.number(), reader.number(8)
        if kind not in _BYTES:
            raise DamagedError(f"has a damaged header: variable {name!r} is of no known type")
        if dimensions and lengths[dimensions[0]] == 0:
            begins.append(first)
            size += metadata
        else:
            before = max(before, first + metadata)
    before = max(before, reader.at)
    if before > reader.end:
        raise DamagedError("ends before its first frame")
    begin = min(begins, default=reader.end)
    if begin < before:
        raise DamagedError("has a damaged header: its frames overlap the header")
    return Head(frames, begin, size, attributes, places)


def head_of(path: Path) -> Head:
    """The header of a file.

    Raises:
        DamagedError: there is none, or it makes no sense.
    """
    with path.open("rb") as stream:
        return _head(_HeaderReader(stream))


def frames_crc(path: Path, frames: int) -> int:
    """Checksum of the first frames in a file.

    Raises:
        DamagedError: as of `head_of`.
    """
    head = head_of(path)
    with path.open("rb") as stream:
        stream.seek(head.begin)
        left, found = frames * head.size, 0
        while left > 0:
            block = stream.read(min(_BLOCK, left))
            if not block:
                break
            found, left = zlib.crc32(block, found), left - len(block)
    return found


def _head_crc(path: Path, head: Head) -> int:
    """Checksum of all that stands before the frames, but for itself."""
    with path.open("rb") as stream:
        data = bytearray(stream.read(head.begin))
    at = head.places[HEAD]
    data[at : at + len(NONE)] = NONE.encode()
    return zlib.crc32(data)


def seal(path: Path) -> None:
    """Note the checksum of all that stands before the frames in a finished file that has place for it."""
    head = head_of(path)
    found = f"{_head_crc(path, head):08x}".encode()
    with path.open("r+b") as stream:
        stream.seek(head.places[HEAD])
        stream.write(found)


def check_whole(path: Path, *, read: bool = True) -> None:
    """Make sure that a file is what was written, if it is of the format of results.

    Args:
        path: the file; one without checksums is looked at for its length only.
        read: whether its frames are read to compare their checksum, which takes about a second for a gigabyte.

    Raises:
        DamagedError: it is not.
    """
    with path.open("rb") as stream:
        if stream.read(len(_MAGIC)) != _MAGIC:
            return
    head, size = head_of(path), path.stat().st_size
    whole = head.whole_frames(size)
    if whole < head.frames:
        raise CutShortError(whole, head.frames)
    metadata = head.attributes.get(HEAD, b"").decode("ascii", "replace")
    if len(metadata) == len(NONE) and metadata != NONE and f"{_head_crc(path, head):08x}" != metadata:
        raise DamagedError("is damaged: the checksum of its header is wrong")
    if not read or CHECKED not in head.attributes or FRAMES not in head.attributes:
        return
    checked = int.from_bytes(head.attributes[CHECKED], "big")
    if checked > head.frames:
        raise DamagedError(f"is damaged: it has {head.frames} frames, but was written with {checked}")
    if f"{frames_crc(path, checked):08x}".encode() != head.attributes[FRAMES]:
        raise DamagedError("is damaged: the checksum of its frames is wrong")
