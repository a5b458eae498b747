"""Figures of sweeps: what is drawn of what."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import ropewalk
from ropewalk.errors import ScenarioError


def dataset(*sizes, case=False, words=False):
    """A sweep over parameters a, b, ... in m, with a doubtful case and one without a value."""
    names = list("abc"[: len(sizes)])
    dims = ["case"] if case else names
    values = np.arange(float(np.prod(sizes if not case else sizes[:1]))).reshape(sizes if not case else sizes[:1])
    outcome = np.full(values.shape, "completed", dtype=object)
    outcome.flat[0], outcome.flat[1], values.flat[1] = "doubtful", "failed", np.nan
    coordinates = {
        name: (["case"] if case else [name], np.array(list("uvwxyz")[:size]) if words else np.arange(1.0, size + 1.0),
               {} if words else {"units": "m"})
        for name, size in zip(names, sizes, strict=True)
    }  # fmt: skip
    about = {"title": "T", "outcome": "completed", "parameters": names, "quantities": ["max tension"]}
    return xr.Dataset({"max tension": (dims, values, {"units": "N"}), "outcome": (dims, outcome)}, coordinates, about)


def marks(ax):
    return {one.get_label() for one in ax.collections}


def test_one_parameter_gives_a_curve_with_rings_and_crosses():
    (ax,) = ropewalk.sweep_figure(dataset(6)).axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("a (m)", "max tension (N)")
    assert len(ax.lines) == 1
    assert {"doubtful", "no value"} <= marks(ax)


def test_two_parameters_of_many_values_give_a_map():
    ax, bar = ropewalk.sweep_figure(dataset(6, 5)).axes
    assert (ax.get_xlabel(), ax.get_ylabel(), bar.get_ylabel()) == ("a (m)", "b (m)", "max tension (N)")
    assert {"doubtful", "no value"} <= marks(ax)


def test_two_parameters_of_which_one_has_few_values_give_a_family():
    (ax,) = ropewalk.sweep_figure(dataset(6, 2)).axes
    assert [line.get_label() for line in ax.lines] == ["b 1 m", "b 2 m"]


def with_limits(found):
    """The same of a quantity that counts broken limits: none, one, and two in the last three cases."""
    names = np.full(found["max tension"].shape, "", dtype=object)
    names.flat[-4], names.flat[-3:] = "largest force", "largest force; uplift"
    renamed = found.rename({"max tension": "limits.failures"})
    return renamed.assign({"limits.broken": (found["max tension"].dims, names)}).assign_attrs(
        quantities=["limits.failures"]
    )


def test_a_curve_names_limits_where_others_are_broken():
    (ax,) = ropewalk.sweep_figure(with_limits(dataset(6))).axes
    assert [(note.get_text(), note.xy[0]) for note in ax.texts] == [
        ("largest force", 3.0),
        ("largest force\nuplift", 4.0),
    ]


@pytest.mark.parametrize("how", [{"sizes": (6, 5)}, {"sizes": (6,), "case": True}])
def test_maps_and_points_name_them_in_their_title(how):
    ax = ropewalk.sweep_figure(with_limits(dataset(*how["sizes"], case="case" in how))).axes[0]
    assert ax.get_title("left") == "broken somewhere: largest force; uplift"


def test_words_have_places_and_no_line():
    (ax,) = ropewalk.sweep_figure(dataset(3, words=True)).axes
    assert [tick.get_text() for tick in ax.get_xticklabels()] == ["u", "v", "w"]
    assert ax.lines[0].get_linestyle() == "None"


def test_drawn_cases_are_points_over_each_parameter():
    found = ropewalk.sweep_figure(dataset(6, 6, case=True))
    assert [ax.get_xlabel() for ax in found.axes] == ["a (m)", "b (m)"]


def test_too_many_curves_and_unknown_quantities_are_refused():
    with pytest.raises(ScenarioError, match="20 curves are too many"):
        ropewalk.sweep_figure(dataset(6, 4, 5))
    with pytest.raises(ScenarioError, match="did you mean max tension"):
        ropewalk.sweep_figure(dataset(6), ["max tensoin"])


@pytest.mark.parametrize("sizes", [(6,), (6, 5), (4, 3)])
def test_a_figure_is_drawn(tmp_path, sizes):
    ropewalk.sweep_figure(dataset(*sizes)).savefig(tmp_path / "f.png")
    assert (tmp_path / "f.png").stat().st_size > 5000
