"""Films draw the description of a frame: trains on the deck, factors of displacements, diagrams, symbols of loads."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex

from ropewalk.results import figure, style
from ropewalk.results.figures import panels_of
from ropewalk.results.film_symbols import SPACE, Brush, draw_symbol
from ropewalk.results.stage import Stage
from ropewalk.results.symbols import KINDS, Symbol
from ropewalk.results.tempo import tempo
from ropewalk.scenario import load
from ropewalk.simulate import simulate

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def bridge():
    """A short bridge under twelve coaches, on a coarse mesh."""
    return simulate(load(EXAMPLES / "bridge-coaches.yaml", ["lines.deck.elements=10", "run.until=1.2 s"]))


@pytest.fixture(scope="module")
def stage(bridge) -> Stage:
    return Stage(bridge, tempo(bridge, 40))


def test_displacements_of_a_bridge_are_exaggerated_by_the_factor_that_the_title_states(bridge, stage):
    factor, k = stage._arrays.picture.factor, 25
    assert factor >= 50.0
    assert f"displacements drawn {factor:g} times as large" in stage._panel.get_title("right")
    stage.picture(k)
    strokes = np.array(stage._ropes.get_segments())
    drawn = np.ptp(stage._panel.transData.inverted().transform(strokes.reshape(-1, 2))[:, 1])
    frame = tempo(bridge, 40).frames[k]
    assert drawn == pytest.approx(factor * np.ptp(bridge["position"].values[frame, :, -1]), rel=1e-6)
    marks = [float(tick.get_text().replace("−", "-")) for tick in stage._panel.get_yticklabels()]
    np.testing.assert_allclose(np.array(stage._panel.get_yticks()) / factor, 1e-3 * np.array(marks), rtol=1e-6)
    assert stage._panel.get_ylabel() == "displacement (mm)"


def test_coaches_are_on_the_deck_and_come_from_beside_it(stage):
    stage.picture(20)
    deck = np.concatenate(stage._ropes.get_segments())
    boxes = [p.vertices[:4] for p in stage._shapes.get_paths() if len(p.vertices) < 7]
    assert boxes
    on = [box for box in boxes if deck[:, 0].min() < box[:, 0].mean() < deck[:, 0].max()]
    assert all(box[:, 1].min() > deck[:, 1].min() for box in on)
    assert any(box[:, 0].min() < deck[:, 0].min() for box in boxes)  # some of a coach is still on the ground


def test_diagrams_state_the_largest_value_of_the_frame_and_of_the_film(bridge, stage):
    stage.picture(30)
    texts = [text.get_text() for track in stage._tracks for text in track.artists[1:]]
    assert [text.endswith("in the film") for text in texts] == [True, True]
    shown = tempo(bridge, 40).frames
    down = bridge["position"].values[0, :, -1] - bridge["position"].values[shown, :, -1]
    largest = 1e3 * down.ravel()[np.abs(down).argmax()]
    assert f"of {largest:.2f} mm" in texts[0]
    assert stage._tracks[0]._curve.axes.yaxis_inverted()  # deflections are drawn downwards


def test_the_force_of_a_train_is_that_of_all_its_axles(bridge, stage):
    k = 25
    force = bridge["contact_force"].values[tempo(bridge, 40).frames[k], :, -1]
    stage.picture(k)
    number, unit = stage._clock.get_text().splitlines()[1].split()[1:]
    assert unit == "kN"
    assert float(number) == pytest.approx(-np.nansum(force) / 1e3, abs=0.6)
    drawn = figure(bridge, panels=["contact_force"]).axes[0].lines
    assert len(drawn) == 1
    np.testing.assert_allclose(
        np.nanmin(drawn[0].get_ydata()), np.nansum(bridge["contact_force"].values[..., -1], 1).min()
    )


def test_heights_and_deflections_of_a_bridge_are_labelled_in_millimetres(bridge):
    fig = figure(bridge)
    labels = {ax.get_title("left"): ax.get_ylabel() for ax in fig.axes if ax.get_title("left")}
    assert labels["Shapes"].startswith("z (mm), drawn ")
    assert labels["Deflection, downward"] == "deflection (mm)"
    assert labels["Acceleration, filtered"] == "acceleration (m/s²)"
    assert "contact_height" not in panels_of(bridge)  # single axles of a train say nothing


def test_every_symbol_is_drawn_and_has_the_space_it_needs():
    spots, others = np.array([[100.0, 100.0], [130.0, 100.0]]), np.array([[115.0, 60.0]])
    for kind in {*KINDS.values(), "mass", "tower", "sheave", "saddle", "bearing", "place"} - {"force"}:
        brush = Brush(10.0, 1.0)
        draw_symbol(brush, Symbol(kind, "one", (0, 1), (0,), foot=0.0), spots, others)
        points = np.concatenate([*brush.polygons, *brush.strokes])
        assert np.isfinite(points).all(), kind
        above, _ = SPACE.get(kind, (20, 20))
        assert points[:, 1].max() <= 100.0 + above + 1.0, kind
        gone = Brush(10.0, 1.0)
        draw_symbol(gone, Symbol(kind, "one", (0, 1), (0,)), np.full((2, 2), np.nan), np.full((1, 2), np.nan))
        assert not gone.polygons, kind


def test_an_arrow_ends_at_its_place_and_is_as_long_as_its_force():
    brush = Brush(10.0, 1.0)
    brush.arrow(np.array([50.0, 50.0]), np.array([0.0, -40.0]))
    points = np.concatenate([*brush.polygons, *brush.strokes])
    assert points[:, 1].min() == pytest.approx(50.0)
    assert points[:, 1].max() == pytest.approx(90.0)
    assert to_hex(brush.faces[0]) == to_hex(style.RED)


def test_the_strength_of_a_line_is_drawn_where_it_is_in_reach_and_else_named():
    quick = ["run.until=0.3 s", "lines.rope.elements=16"]
    near = simulate(load(EXAMPLES / "moving-force.yaml", [*quick, "lines.rope.strength=2 kN"]))
    ax = figure(near, panels=["tension"]).axes[0]
    (limit,) = [line for line in ax.lines if line.get_label() == "strength of rope"]
    assert limit.get_ydata() == [2000.0, 2000.0]
    assert ax.get_ylim()[1] > 2000.0
    far = simulate(load(EXAMPLES / "moving-force.yaml", [*quick, "lines.rope.strength=40 kN"]))
    ax = figure(far, panels=["tension"]).axes[0]
    assert "strength of rope 40 kN" in (ax.get_title("right"), ax.get_title("left").splitlines()[-1])
    assert "contact_force" not in panels_of(far)  # 800 N throughout


def test_a_crowded_panel_is_told_by_a_band(bridge):
    names = [f"axle {k}" for k in range(bridge.sizes["contact"])]
    single = bridge.assign_coords(load=("contact", np.array(names))).assign_attrs(scenario="")
    ax = figure(single, panels=["contact_force"]).axes[0]
    assert len([line for line in ax.lines if not line.get_label().startswith("_")]) <= 7
    assert any("least to largest" in c.get_label() for c in ax.collections)
