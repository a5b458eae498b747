"""Packages of others, that few runs need and nobody has to have installed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from ropewalk.errors import RopewalkError


def imported(module: str, package: str) -> Any:
    """A module of a package that may be absent.

    Args:
        module: its name, as in an import.
        package: what to install for it.

    Raises:
        RopewalkError: it is not there, or cannot be imported.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise RopewalkError(
            f"this model needs the package {package}, which cannot be imported ({error}); "
            f'pip install {package}, or pip install "ropewalk[external]"'
        ) from error
