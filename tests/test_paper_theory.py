"""Figure 5 shows what the closed forms give."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ropewalk.paper import figure5, figures


def test_the_published_numbers_of_modes_give_half_of_the_deflection_under_the_load() -> None:
    """alpha = 0.9999, V t = 0.9 L: exact 0.450022501125, 49 modes 0.220613, 149 modes 0.226243 (in F L/P)."""
    found = [float(figure5.under_load(np.array([0.9]), modes)[0]) for modes in (None, 49, 149)]
    assert found == pytest.approx([0.450022501125, 0.220613, 0.226243], abs=1e-6)  # the digits given
    assert [modes for modes, _ in figure5.MODES] == [49, 149]


def test_figure_5_draws_both_series_and_the_exact_string_for_every_place() -> None:
    shapes = figure5.draw().axes[0]
    lines = [line for line in shapes.lines if line.get_linestyle() != "None"]
    assert len(lines) == 3 * len(figure5.PLACES)
    x, w = lines[-1].get_data()  # exact, load at 0.9 L
    assert float(np.interp(0.45, x, w)) == pytest.approx(0.45 / 1.9999, rel=1e-12)


def test_figure_5_is_written_by_its_number(tmp_path: Path) -> None:
    assert [path.name for path in figures(tmp_path, only=[5])] == ["figure-5.png"]
