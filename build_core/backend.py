"""Hatchling, which builds the package, and the wheel `ziglang` where the machine has no compiler that knows C++20."""

from typing import Any

from compiler import ZIG, system_compiler
from hatchling import build as hatchling
from hatchling.build import *  # noqa: F403


def get_requires_for_build_wheel(config_settings: Any = None) -> list[str]:
    """Return what is needed to build a wheel."""
    return [*hatchling.get_requires_for_build_wheel(config_settings), *_compiler()]


def get_requires_for_build_editable(config_settings: Any = None) -> list[str]:
    """Return what is needed for an editable installation."""
    return [*hatchling.get_requires_for_build_editable(config_settings), *_compiler()]


def _compiler() -> list[str]:
    return [] if system_compiler() else [ZIG]
