"""Calculators of riggers and engineers: given any sufficient set of quantities, the others.

    from ropewalk import calc
    calc.highline(span=63, stretch="18 %", standing_tension="1.5 kN", mass=57).sag

Numbers are in SI units, texts carry theirs; a quantity that is None is sought even if it has a default. What is not
given follows, or a `ScenarioError` says what is missing or contradicts. On the command line: `ropewalk calc`.
"""

from ropewalk.calc.answer import Answer, CalcValue
from ropewalk.calc.beams import beam
from ropewalk.calc.calculator import Calculator
from ropewalk.calc.rolling_down import zipline
from ropewalk.calc.rope_spans import catenary, span
from ropewalk.calc.taut_string import string
from ropewalk.calc.webbing import highline

__all__ = [
    "CALCULATORS",
    "Answer",
    "CalcValue",
    "Calculator",
    "beam",
    "catenary",
    "highline",
    "span",
    "string",
    "zipline",
]

CALCULATORS = {calculator.name: calculator for calculator in (span, catenary, highline, zipline, string, beam)}
"""All of them by name."""
