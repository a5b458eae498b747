"""Commands that refuse an option given twice, of which only the last value would count."""

from __future__ import annotations

from typing import Any

from typer.core import TyperCommand

from ropewalk.cli.console import fail


class CommandOfSingleOptions(TyperCommand):
    """A command whose options have one value each, except those that may be repeated."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse arguments; an option that takes one value ends the command with exit code 2 when it is repeated."""
        *_, given = self.make_parser(ctx).parse_args(args=list(args))
        for option in given:
            if given.count(option) > 1 and not getattr(option, "multiple", True) and not getattr(option, "is_flag", 0):
                fail(f"{option.opts[-1]}: is given {given.count(option)} times and takes one value; write it once")
        return super().parse_args(ctx, args)
