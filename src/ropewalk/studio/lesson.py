"""The lessons of the studio: scenarios with a question, its answer, and results that were kept to open at once."""

from __future__ import annotations

import json
import lzma
import tempfile
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ropewalk.checkpoint import ENGINE_NUMBER
from ropewalk.results import ResultError, open_result
from ropewalk.studio.streams import curves_of

if TYPE_CHECKING:
    import xarray as xr

FOLDER = Path(__file__).parent / "lessons"


@cache
def lessons() -> tuple[dict[str, Any], ...]:
    """Return the lessons in their order, each with its text, question, answer, numbers and scenarios."""
    from ruamel.yaml import YAML

    found = YAML(typ="safe", pure=True).load((FOLDER / "lessons.yaml").read_text(encoding="utf-8"))
    for lesson in found:
        names = {key: FOLDER / f"{lesson['name']}{end}.yaml" for key, end in (("scenario", ""), ("beside", ".beside"))}
        lesson.update({key: file.read_text(encoding="utf-8") for key, file in names.items() if file.is_file()})
    return tuple(found)


def kept_result(name: str) -> tuple[xr.Dataset, dict[str, Any]]:
    """Return the kept result of a scenario, and how its run ended as a page shows it.

    Args:
        name: of the lesson, or NAME.beside.

    Raises:
        ResultError: there is none, or it was computed by another engine.
    """
    file = FOLDER / f"{name}.nc.xz"
    if file not in FOLDER.glob("*.nc.xz"):
        raise ResultError(f"lesson {name}: there is no kept result")
    with tempfile.TemporaryDirectory() as place:
        plain = Path(place) / "kept.nc"
        plain.write_bytes(lzma.decompress(file.read_bytes()))
        dataset = open_result(plain, lazy=False)
    if (number := dataset.attrs["engine_number"]) != ENGINE_NUMBER:
        raise ResultError(
            f"lesson {name}: the kept result was computed by engine {number}; this version has engine {ENGINE_NUMBER}. "
            "Renew it with `make lessons`."
        )
    return dataset, {**json.loads(dataset.attrs.pop("ended")), "curves": curves_of(dataset)}
