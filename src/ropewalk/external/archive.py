"""FMUs are archives: how much they may hold."""

from __future__ import annotations

import os
import zipfile

from ropewalk.errors import RopewalkError

LARGEST, MOST = 1 << 30, 20_000  # bytes unpacked, and files


def check_size(file: str | os.PathLike[str]) -> None:
    """Make sure that an FMU can be unpacked without filling the disk; no more comes out than its directory says.

    Raises:
        RopewalkError: it is too large, or no archive.
    """
    try:
        with zipfile.ZipFile(file) as archive:
            entries = archive.infolist()
    except (zipfile.BadZipFile, OSError) as error:
        raise RopewalkError(f"it cannot be unpacked ({error})") from error
    size = sum(entry.file_size for entry in entries)
    if size > LARGEST or len(entries) > MOST:
        text = f"{len(entries)} files of {size / 1e9:.3g} GB"
        raise RopewalkError(f"it holds {text}; at most {MOST} of {LARGEST / 1e9:.3g} GB are unpacked")
