"""`ropewalk` and `python -m ropewalk` are the command line."""

import gc
import sys
import warnings
from typing import Any

from ropewalk.interrupts import EXIT_CODE, is_interrupted, listen


def main() -> None:
    """Run the command line; interrupts are heard from the first import on."""
    listen()
    warnings.showwarning = _warn
    try:
        from ropewalk.cli import app

        app()
    except SystemExit as end:
        if isinstance(getattr(end.__context__, "__cause__", None), KeyboardInterrupt):  # of which typer says nothing
            print("interrupted", file=sys.stderr)
        sys.exit(EXIT_CODE if end.code and is_interrupted() else end.code)
    except BaseException:  # what extension modules make of an interrupt
        if not is_interrupted():
            raise
        print("interrupted", file=sys.stderr)
        sys.exit(EXIT_CODE)
    finally:
        gc.freeze()  # or the interpreter, before it ends, looks for cycles in half a second's worth of objects


def _warn(message: Warning | str, *_: Any, **__: Any) -> None:
    print(f"warning: {message}", file=sys.stderr)


if __name__ == "__main__":
    main()
