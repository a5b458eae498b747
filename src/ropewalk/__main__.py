"""`ropewalk` and `python -m ropewalk` are the command line."""

import gc
import os
import sys
import warnings
from contextlib import suppress
from typing import Any, NoReturn

from ropewalk.importing import lightly
from ropewalk.interrupts import EXIT_CODE, is_interrupted, listen, note_ending

_GARBAGE = 50_000  # objects after which the interpreter looks for cycles: with its usual 700 a tenth of a short run


@lightly()
def main() -> None:
    """Run the command line; interrupts are heard from the first import on."""
    try:
        listen()
        gc.set_threshold(_GARBAGE, *gc.get_threshold()[1:])
        warnings.showwarning = _warn
        from ropewalk.cli.app import app

        app()
    except SystemExit as end:
        # Of the first typer says nothing, and code of others may have swallowed the second.
        text = not isinstance(getattr(end.__context__, "__cause__", None), KeyboardInterrupt) and end.code
        if is_interrupted():
            _end_interrupted(bool(text))
        raise
    except BaseException:  # what extension modules make of an interrupt
        if not is_interrupted():
            raise
        _end_interrupted(text=False)
    finally:
        note_ending()
        gc.freeze()  # or the interpreter, before it ends, looks for cycles in half a second's worth of objects


def _end_interrupted(text: bool) -> NoReturn:
    """End the process at once: libraries that were interrupted within a call may crash when they are torn down."""
    if not text:
        print("interrupted", file=sys.stderr)
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(EXIT_CODE)


def _warn(message: Warning | str, *_: Any, **__: Any) -> None:
    from ropewalk.errors import printable_lines  # lazy: interrupts are heard a twentieth of a second sooner

    print(f"warning: {printable_lines(str(message))}", file=sys.stderr)


if __name__ == "__main__":
    main()
