"""Results: what a solver hands over, the labelled dataset on file or in memory, and what is made of it.

Everything is imported when it is first used: recording needs no Matplotlib, and a figure no NetCDF.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ropewalk.results.animation import film
    from ropewalk.results.contract import links
    from ropewalk.results.display_units import DisplayUnits
    from ropewalk.results.extrapolation import extrapolated
    from ropewalk.results.figures import figure, figure_data, single
    from ropewalk.results.files import ResultError, WriteError, open_result
    from ropewalk.results.frame import ENERGY_FORMS, Frame, Layout, RunInfo
    from ropewalk.results.recorder import Recorder
    from ropewalk.results.report import html_report
    from ropewalk.results.statistics import summary
    from ropewalk.results.table import text
    from ropewalk.results.table_export import (
        named_numbers,
        named_texts,
        save_tables,
        series_table,
        tables,
        write_tables,
    )
    from ropewalk.results.target import check_target
    from ropewalk.results.vtk_export import export

_HOME = {
    "RunInfo": "frame",
    "DisplayUnits": "display_units",
    "ENERGY_FORMS": "frame",
    "Frame": "frame",
    "Layout": "frame",
    "Recorder": "recorder",
    "ResultError": "files",
    "WriteError": "files",
    "check_target": "target",
    "export": "vtk_export",
    "extrapolated": "extrapolation",
    "figure": "figures",
    "figure_data": "figures",
    "film": "animation",
    "html_report": "report",
    "links": "contract",
    "named_numbers": "table_export",
    "named_texts": "table_export",
    "open_result": "files",
    "save_tables": "table_export",
    "series_table": "table_export",
    "single": "figures",
    "summary": "statistics",
    "tables": "table_export",
    "text": "table",
    "write_tables": "table_export",
}

__all__ = [
    "ENERGY_FORMS",
    "DisplayUnits",
    "Frame",
    "Layout",
    "Recorder",
    "ResultError",
    "RunInfo",
    "WriteError",
    "check_target",
    "export",
    "extrapolated",
    "figure",
    "figure_data",
    "film",
    "html_report",
    "links",
    "named_numbers",
    "named_texts",
    "open_result",
    "save_tables",
    "series_table",
    "single",
    "summary",
    "tables",
    "text",
    "write_tables",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
