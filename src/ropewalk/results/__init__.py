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
    from ropewalk.results.files import ResultError, WriteError, check_target, open_result
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
    from ropewalk.results.vtk_export import export

_NAMES = {
    "animation": "film",
    "contract": "links",
    "display_units": "DisplayUnits",
    "extrapolation": "extrapolated",
    "figures": "figure figure_data single",
    "files": "ResultError WriteError check_target open_result",
    "frame": "ENERGY_FORMS Frame Layout RunInfo",
    "recorder": "Recorder",
    "report": "html_report",
    "statistics": "summary",
    "table": "text",
    "table_export": "named_numbers named_texts save_tables series_table tables write_tables",
    "vtk_export": "export",
}
_HOME = {name: module for module, names in _NAMES.items() for name in names.split()}

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
