"""Commands that write one file, and refuse a second one: only the last would be written."""

from __future__ import annotations

from typing import Any

from typer.core import TyperCommand

from ropewalk.cli.console import fail


class CommandWithOutput(TyperCommand):
    """A command whose --output takes several files or is given once. Of other options the last value counts."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse arguments; an --output of one file that is repeated ends the command with exit code 2."""
        *_, given = self.make_parser(ctx).parse_args(args=list(args))
        for option in given:
            if "--output" in option.opts and not getattr(option, "multiple", False) and given.count(option) > 1:
                fail(f"--output: is given {given.count(option)} times, but this command writes one file; give it once")
        return super().parse_args(ctx, args)
