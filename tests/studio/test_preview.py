"""Pictures of scenarios that have not been computed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ropewalk.results.picture import Picture
from ropewalk.scenario import load, loads
from ropewalk.studio.preview import preview
from ropewalk.studio.streams import of_frame
from studio_server import SHORT, unpacked

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.yaml"))


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.stem)
def test_every_example_has_a_picture_before_it_is_computed(file: Path) -> None:
    declared = preview(load(file))
    assert declared is not None
    head, arrays = unpacked(of_frame(declared, {"id": 1}))
    assert np.isfinite(arrays["position"]).all()
    assert head["state"]["factor"] == 1.0
    assert not any(head["state"]["ranges"].values())


def test_a_load_is_where_it_starts_on_the_declared_line() -> None:
    declared = preview(loads(SHORT.replace("from: 0 m", "from: 5 m")))
    assert declared is not None
    np.testing.assert_allclose(declared["contact_position"].values[0, 0], [5.0, 0.0])
    assert [symbol.kind for symbol in Picture(declared).symbols] == ["force"]


def test_a_line_is_drawn_over_its_sheaves_and_its_load_on_it() -> None:
    declared = preview(load(next(file for file in EXAMPLES if file.stem == "sheaves")))
    assert declared is not None
    lines = load(next(file for file in EXAMPLES if file.stem == "sheaves")).lines
    name, line = next((name, line) for name, line in lines.items() if line.sheaves)
    own = declared["position"].values[0][declared["line"].values == name]
    for sheave in line.sheaves.values():
        away = np.abs(own - np.array([sheave.at[0], sheave.at[-1]])).max(axis=1)
        assert away.min() == pytest.approx(0.0, abs=1e-9)
    assert np.isfinite(declared["contact_xi"].values).any()
