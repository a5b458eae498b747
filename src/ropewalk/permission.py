"""Permission to run external code: steppers of Python and FMUs.

The two functions that load external code ask `check_code` just before they do, whatever has led to the load: a file, a
case of a sweep, a design or a map. The answer stands in the environment, so that processes of a sweep inherit it.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from ropewalk.errors import Problem, ScenarioError

VARIABLE = "ROPEWALK_NO_CODE"
STUDIO = "studio"


def forbid_code(by: str = "1") -> None:
    """Forbid external code in this process and in those that it starts.

    Args:
        by: STUDIO if the studio forbids it, whose messages name its own option.
    """
    os.environ[VARIABLE] = by


def is_code_forbidden() -> bool:
    """Return whether external code is forbidden here."""
    return os.environ.get(VARIABLE, "") not in ("", "0")


@contextmanager
def code_restored() -> Iterator[None]:
    """Restore the permission of before at the end."""
    before = os.environ.get(VARIABLE)
    try:
        yield
    finally:
        os.environ.pop(VARIABLE, None)
        if before is not None:
            os.environ[VARIABLE] = before


def refusal_of_code(name: str, key: str, given: str) -> Problem:
    """Return the problem of a load that would run external code.

    Args:
        name: of the load.
        key: of the load that names the code.
        given: its value.
    """
    if os.environ.get(VARIABLE) == STUDIO:
        remedy = "start the studio with permission to run code if you trust its author"
        return Problem(f"loads.{name}.{key}", "is external code, which the studio does not run", given, remedy)
    remedy = f"omit --no-code (and the environment variable {VARIABLE}) if you trust its author"
    return Problem(f"loads.{name}.{key}", "is external code, which --no-code refuses", given, remedy)


def check_code(name: str, key: str, given: str) -> None:
    """Refuse external code where it is forbidden.

    Raises:
        ScenarioError: it is.
    """
    if is_code_forbidden():
        raise ScenarioError([refusal_of_code(name, key, given)])
