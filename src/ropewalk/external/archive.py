"""FMUs are archives: how much they may hold, and their description, which is looked at before it is parsed."""

from __future__ import annotations

import os
import re
import zipfile

from ropewalk.errors import Refused, RopewalkError

LARGEST, MOST = 1 << 30, 20_000  # bytes unpacked, and files
DESCRIPTION = "modelDescription.xml"
LARGEST_TEXT, MOST_MARKS, MOST_ATTRIBUTES = 32_000_000, 600_000, 2_000_000  # bytes of the description, < and = in it
_MOST_IN_ONE = 1000  # attributes of one element
_ENCODING = re.compile(rb"""<\?xml[^>]*?encoding\s*=\s*["']([^"']*)""")
_READABLE = (b"utf-8", b"utf8", b"us-ascii", b"ascii", b"iso-8859-1", b"windows-1252")


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


def check_description(file: str | os.PathLike[str]) -> None:
    """Make sure that the description of an FMU can be parsed with little time and memory.

    Raises:
        Refused: it is too large, or defines entities, of which a small text can become a large one.
        BadZipFile, OSError, ...: it cannot be unpacked.
    """
    fewer = "export it with fewer variables"
    with zipfile.ZipFile(file) as archive, archive.open(DESCRIPTION) as stream:
        text = stream.read(LARGEST_TEXT + 1)
    if len(text) > LARGEST_TEXT:
        raise Refused(f"is larger than {LARGEST_TEXT / 1e6:g} MB", fewer)
    encoding = _ENCODING.search(text[:500])
    if b"\0" in text or (encoding is not None and encoding[1].lower() not in _READABLE):
        raise Refused("is not in UTF-8", "export it again")
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        raise Refused("defines a document type or entities, which FMI does not know", "export it again without them")
    elements, attributes = text.count(b"<"), text.count(b"=")
    if elements > MOST_MARKS or attributes > MOST_ATTRIBUTES:
        raise Refused(f"has about {elements // 2} elements and {attributes} attributes, which is too much", fewer)
    if max((part.count(b"=") for part in text.split(b"<")), default=0) > _MOST_IN_ONE:
        raise Refused(f"has an element of more than {_MOST_IN_ONE} attributes", "export it again")
