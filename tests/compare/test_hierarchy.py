"""The ladder: thresholds, rungs that cannot be had, what it tells as JSON, as a table, as a figure, and bad input."""

from __future__ import annotations

import json

import numpy as np
import pytest

from ropewalk import Scenario
from ropewalk.cli.app import app
from ropewalk.compare import MODELS, QUANTITIES, distances, model_hierarchy
from ropewalk.compare.stretches import reach_of
from ropewalk.compare.trace import FLOOR, Difference, Trace, difference
from ropewalk.compare.verdict import is_adequate, sentence, thresholds
from ropewalk.errors import RopewalkError, ScenarioError


def scenario(load=None, run=None, **line):
    rope = {
        "start": [0.0, 0.0], "end": [10.0, 0.0], "tension": 2e3, "mass": 0.5, "axial_stiffness": 1e5, "elements": 20,
        **line,
    }  # fmt: skip
    load = load or {"kind": "force", "force": [0.0, -50.0], "travel": {"speed": 5.0}}
    run = run or {"kind": "dynamic", "until": 1.0}
    return Scenario.model_validate({"lines": {"rope": rope}, "loads": {"cart": {"on": "rope", **load}}, "run": run})


def numbers(value):
    if isinstance(value, dict):
        return [n for entry in value.values() for n in numbers(entry)]
    if isinstance(value, list):
        return [n for entry in value for n in numbers(entry)]
    return [value] if isinstance(value, float) else []


def test_thresholds_are_one_for_all_and_others_for_some():
    assert thresholds(0.02) == dict.fromkeys(QUANTITIES[:-1], 0.02)
    own = thresholds(0.02, {"tension": 0.1, "hold force": 0.5})
    assert (own["deflection"], own["tension"], own["hold force"]) == (0.02, 0.1, 0.5)
    errors = {"deflection": 0.01, "tension": 0.08, "hold force": None}
    assert is_adequate(errors, own)
    assert not is_adequate(errors, thresholds(0.02))
    assert not is_adequate({"tension": None}, own)  # nothing is known
    message = sentence("linear", errors, thresholds(0.02))
    assert message == "linear: not adequate: the largest tension 8.0 % off; adequate for the largest deflection"


@pytest.mark.parametrize("tolerance", [0.0, -0.1, float("nan"), float("inf"), True, "5 %"])
def test_a_tolerance_is_a_positive_part(tolerance):
    with pytest.raises(ScenarioError, match="a tolerance is a positive part"):
        thresholds(tolerance)


def test_an_unknown_quantity_or_simpler_model_is_named_with_the_next_one():
    with pytest.raises(ScenarioError, match="no such quantity, given 'tensoin'; did you mean tension"):
        model_hierarchy(scenario(), tolerances={"tensoin": 0.1})
    with pytest.raises(ScenarioError, match="no such model, given 'moving forse'; did you mean moving force"):
        distances(scenario(), ["moving forse"])


def test_what_has_no_model_hierarchy_is_refused():
    with pytest.raises(ScenarioError, match="compare needs a load that moves"):
        model_hierarchy(scenario(run={"kind": "equilibrium"}))
    empty = scenario().model_copy(update={"loads": {}})
    with pytest.raises(ScenarioError, match="no load travels"):
        model_hierarchy(empty)
    # a full scenario that cannot begin has nothing that others could be compared with
    with pytest.raises(RopewalkError, match="load cart"):
        model_hierarchy(
            scenario({"kind": "force", "force": [0.0, -1.0], "travel": {"speed": 0.1, "from": 12.0, "measured": "arc"}})
        )


def test_json_has_no_nan_and_the_table_says_what_is_too_large(climbed):
    for name in ("slack_rope", "pantograph", "slow_trolley"):
        found = climbed(name)
        message = found.as_dict()
        assert list(message["models"]) == list(MODELS)
        assert np.isfinite(numbers(json.loads(json.dumps(message, allow_nan=False)))).all()
    rows = climbed("slack_rope").table()
    assert {len(row) for row in rows} == {len(rows[0])}
    assert rows[0] == ("", "linear", "quasi-static", "full")
    assert rows[-1] == ("adequate", "no", "no", "yes")
    assert next(row for row in rows if row[0] == "distance: largest deflection")[1].endswith("!")


def test_a_simpler_model_that_cannot_be_had_says_why():
    displacement = {"time": [0.0, 1.0], "value": [[0.0, 0.0], [0.0, 0.01]]}
    soft = {"end_support": {"kind": "moving", "displacement": displacement}}
    found = model_hierarchy(scenario(**soft))
    assert "the linear" not in found.models["linear"].same_as
    assert "a support that yields or moves is not implemented for kind: linear" in found.models["linear"].reason
    assert found.models["linear"].quantities is None
    assert not found.adequate("linear")
    assert "linear: not available: " in found.verdict
    assert found.adequate("quasi-static") or found.errors["quasi-static"]
    assert distances(scenario(**soft), ["linear"])["linear"] == dict.fromkeys((*QUANTITIES, "share beyond"))


def test_distances_are_those_of_the_model_hierarchy_and_run_no_more(monkeypatch):
    whole = model_hierarchy(scenario()).errors
    run = []
    from ropewalk.compare import hierarchy

    true = hierarchy._run
    monkeypatch.setattr(hierarchy, "_run", lambda model, *rest: run.append(model.name) or true(model, *rest))
    few = distances(scenario(), ["quasi-static", "moving force"])
    assert run == ["full", "quasi-static"]
    assert {q: few["quasi-static"][q] for q in QUANTITIES} == whole["quasi-static"]
    assert few["moving force"]["deflection"] == 0.0  # it is the scenario itself
    assert 0.0 <= few["quasi-static"]["share beyond"] <= 1.0


def test_a_slow_run_and_a_linear_one_have_a_full_simpler_model_in_time():
    quasistatic = model_hierarchy(scenario(run={"kind": "quasistatic"}))
    assert "time" in quasistatic.models["full"].result.dims
    assert "has kind: quasistatic" in quasistatic.models["full"].remark
    assert quasistatic.models["quasi-static"].quantities is not None
    linear = model_hierarchy(scenario(run={"kind": "linear", "until": 1.0}))
    assert linear.models["full"].result.attrs["method"] != "linear theory"
    # what does not stretch moves, too
    limp = {"law": {"kind": "inextensible"}, "axial_stiffness": None, "tension": None, "length": 10.1}
    most = model_hierarchy(scenario(run={"kind": "quasistatic", "positions": 21}, **limp))
    assert not most.models["quasi-static"].same_as
    assert "time" in most.models["full"].result.dims
    assert "has kind: quasistatic" in most.models["full"].remark


def test_footsteps_become_their_weight_and_feedback_cut_keeps_them():
    steps = {"kind": "footsteps", "mass": 60.0, "from": 3.0, "frequency": 2.0, "step_length": 0.5}
    found = model_hierarchy(scenario(steps))
    assert found.models["feedback cut"].same_as == "full"
    force = found.models["moving force"].quantities.wheels["cart"]["contact_force"]
    # a person's weight, evenly; rounding
    assert force["value"] == pytest.approx(60.0 * 9.81, rel=1e-9)
    assert force["deviation"] < 1e-6
    assert found.errors["moving force"]["contact force"] > 0.1


def line_of(xi, depth, time=None):
    xi = np.asarray(xi, dtype=float)
    none = np.full(xi.size, np.nan)
    time = np.arange(xi.size, dtype=float) if time is None else time
    return Trace(
        "rope", time, xi, np.asarray(depth, dtype=float), np.zeros((xi.size, 2)), none, np.zeros((xi.size, 2)), none
    )


def test_deflections_are_compared_in_equal_places_whatever_the_instants():
    full = line_of(np.linspace(0.0, 10.0, 101), np.linspace(0.0, 10.0, 101) ** 2)
    other = line_of(np.linspace(2.0, 9.0, 29), 1.1 * np.linspace(2.0, 9.0, 29) ** 2, np.linspace(5.0, 6.0, 29))
    way = difference(full, other, timed=True)
    assert (way.xi[0], way.xi[-1]) == pytest.approx((2.0, 9.0))
    # a tenth everywhere; a parabola between places a quarter of a metre apart is 0.016 of 4 too high
    assert way.local == pytest.approx(0.1, abs=0.01)
    assert way.largest == pytest.approx(0.1, abs=2e-3)


def test_nothing_over_nothing_at_a_support_is_no_failure():
    xi = np.linspace(0.0, 10.0, 401)
    full = 0.4 * xi * (10.0 - xi) / 10.0
    off = Difference(xi, full, full + 1e-3)
    assert off.local.max() == pytest.approx(1e-3 / (FLOOR * 1.0), rel=1e-9)  # not infinite
    assert reach_of(off, 0.05).beyond == ()


def test_a_reach_says_from_where_to_where_a_model_holds():
    xi = np.linspace(0.0, 10.0, 401)
    full = np.ones(401)
    reach = reach_of(Difference(xi, full, np.where(xi > 7.0, 1.2, 1.0)), 0.02)
    # the crossing is somewhere in the step of 25 mm
    assert reach.from_start == pytest.approx(7.0, abs=0.026)
    assert (reach.to_end, reach.share) == pytest.approx((0.0, 0.3), abs=0.003)
    assert reach.text("the linear theory").startswith(
        "the linear theory is within 2 % up to 7.00 m from the start; on the last 3.00 m of the path it is not (20 %"
    )
    bump = reach_of(Difference(xi, full, 1.0 + 0.2 * np.exp(-((xi - 5.0) ** 2))), 0.05)
    # exp(-d^2) = 1/4 at d = 1.177
    assert (bump.from_start, bump.to_end) == pytest.approx((5.0 - 1.1774, 5.0 - 1.1774), abs=1e-3)
    assert "between them it is not" in bump.text("it")
    assert reach_of(Difference(xi, full, full), 0.05).text("it") == "it is within 5 % along the whole path, 0 to 10.0 m"
    assert reach_of(Difference(xi, full, 2.0 * full), 0.05).text("it").startswith("it is nowhere within 5 %")


def test_the_figure_shows_every_simpler_model_that_was_run(climbed):
    for name in ("mass_to_the_end", "pantograph"):
        found = climbed(name)
        fig = found.figure()
        upper, middle, lower = fig.axes
        drawn = [line.get_label() for line in upper.get_lines()]
        assert [label.split(" = ")[0] for label in drawn] == list(found.table()[0][1:])
        assert all("(" in ax.get_ylabel() for ax in fig.axes)  # units
        assert "(m)" in middle.get_xlabel()
        assert lower.patches
        low, high = upper.get_ylim()
        assert (low > high) == (name != "pantograph")  # downwards is down, and an uplift up
        fig.canvas.draw()


@pytest.fixture
def call(tmp_path, monkeypatch):
    """Runs the command on a rope, with a ladder of its own unless asked otherwise."""
    from typer.testing import CliRunner

    from ropewalk.scenario import dump

    monkeypatch.chdir(tmp_path)
    (tmp_path / "rope.yaml").write_text(dump(scenario()), encoding="utf-8")
    return lambda *arguments: CliRunner().invoke(app, ["compare", *arguments])


def test_the_command_prints_table_assumptions_and_verdict(call, tmp_path):
    out = call("rope.yaml", "-o", "rope.png", "--set", "lines.rope.elements=10")
    assert out.exit_code == 0, out.output
    assert "distance: largest deflection" in out.stdout
    assert "largest slope against the chord" in out.stdout
    assert "model that is adequate is" in out.stdout or "Nothing simpler" in out.stdout
    assert (tmp_path / "rope.png").stat().st_size > 10_000
    message = json.loads(call("rope.yaml", "--json", "--tolerance", "0.5").stdout)
    assert message["allowed"]["tension"] == 0.5
    assert set(message["models"]) == set(MODELS)
    assert call("rope.yaml", "--quiet").stdout == ""


def test_the_command_refuses_what_it_cannot_do(call):
    for arguments, said in (
        (("rope.yaml", "--tolerance", "-1"), "a tolerance is a positive part"),
        (("rope.yaml", "-o", "rope.gif"), "the name must end in .png, .svg, .pdf"),
        (("rope.yaml", "--set", "run={kind: equilibrium}"), "compare needs a load that moves"),
    ):
        out = call(*arguments)
        assert out.exit_code == 2
        assert said in out.output


def test_a_simpler_model_that_breaks_off_does_not_keep_the_others_from_being_shown(monkeypatch):
    from ropewalk.compare import hierarchy

    true = hierarchy._run

    def broken(model, *rest):
        result = true(model, *rest)
        if model.name == "quasi-static":
            result.attrs.update(outcome="no rest shape", advice="give more length")
        return result

    monkeypatch.setattr(hierarchy, "_run", broken)
    found = model_hierarchy(scenario())
    assert not found.adequate("quasi-static")
    assert found.models["linear"].errors
    assert "quasi-static: not available: no rest shape: give more length" in found.verdict
    assert distances(scenario(), ["quasi-static"])["quasi-static"]["deflection"] is None


def test_an_overhead_line_that_swings_sideways_is_compared_with_models_in_the_plane():
    deflection = []
    for arms in ({"stagger": 0.2}, {}):
        line = {
            "spans": [40.0] * 3, "droppers": {"per_span": 4}, "element": 1.0, "analysed_spans": [2, 2],
            "steady_arms": arms,
        }  # fmt: skip
        load = {"kind": "pantograph", "on": "line", "model": "en50318-2002", "travel": {"speed": 30.0, "from": 50.0}}
        run = {"kind": "dynamic", "until": 0.3, "every": 0.05}
        tree = {"overhead_lines": {"line": line}, "loads": {"p": load}, "run": run}
        models = model_hierarchy(Scenario.model_validate(tree)).models
        deflection.append(
            [models[name].quantities.lines["line.contact"]["deflection"]["value"] for name in ("full", "linear")]
        )
    # In the middle of a span arms change the uplift little: by 0.1 % of 20 and of 9 mm.
    assert deflection[0] == pytest.approx(deflection[1], rel=5e-3)
