"""Paths of contacts extrapolated from two meshes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import ropewalk
from mesh_cases import BEAM, PACE, PROBLEMS
from ropewalk.errors import RopewalkError
from ropewalk.results import open_result, tables
from ropewalk.simulate import simulate
from ropewalk.theory import beam_crossing


def test_the_path_of_a_mass_on_a_beam_is_ten_times_better(tmp_path: Path) -> None:
    file = tmp_path / "beam.nc"
    given = PROBLEMS["a mass crosses a beam"].on(48)
    run = given.run.model_copy(update={"mesh_error": True, "geometry": "nonlinear"})  # of the second order
    simulate(given.model_copy(update={"run": run}), file=file).close()
    with open_result(file) as result:
        exact = beam_crossing.moving_mass(result.time.values, load_mass=0.3, speed=PACE, gravity=1e-2, **BEAM)
        paths = result.contact_position, ropewalk.extrapolated(result)
        plain, better = (float(np.nanmax(np.abs(-path.values[:, 0, 1] - exact.deflection[:, 0]))) for path in paths)
        assert "mass.change.z [m]" in tables(result)["series"]
    # Measured 9.7e-8 and 1.6e-8 m at the worst instant; 4.4e-8 and 5.4e-9 m in the mean.
    assert better < 0.3 * plain


def test_what_sudden_forces_do_on_ropes_is_not_extrapolated() -> None:
    with pytest.raises(RopewalkError, match="from mesh to mesh differ"):
        ropewalk.extrapolated(PROBLEMS["a force on a soft string"].estimated(96))


def test_a_result_on_one_mesh_is_not_extrapolated() -> None:
    with pytest.raises(RopewalkError, match="write mesh_error: true"):
        ropewalk.extrapolated(simulate(PROBLEMS["a force crosses a taut string"].on(20)))
