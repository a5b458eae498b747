"""Equilibria are found from rough drawings, whatever the mesh and the stiffness, or refused with their cause."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sparse
import xarray as xr

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.scenario import loads
from ropewalk.simulate import simulate
from ropewalk.solve import search_budget
from ropewalk.solve.minimum import settle
from ropewalk.solve.search_budget import SearchBudgetError
from ropewalk.system.equilibrium.form_finding import formed

CASES = Path(__file__).parent


def text(case: str, *changes: tuple[str, str]) -> str:
    """An input with parts replaced, each of which is there."""
    out = (CASES / f"{case}.yaml").read_text()
    for old, new in changes:
        assert old in out
        out = out.replace(old, new)
    return out


def run(case: str, *changes: tuple[str, str]) -> xr.Dataset:
    return simulate(loads(text(case, *changes)))


def force(result: xr.Dataset, support: str) -> float:
    """Size of a support force in the last frame, N."""
    return float(np.linalg.norm(result["reaction"].sel(support=support).to_numpy()[-1]))


def mean_tension(result: xr.Dataset, line: str) -> float:
    """Mean tension of a line in the last frame, N."""
    return float(result["tension"].to_numpy()[-1][result["link_line"].to_numpy() == line].mean())


MIRRORED = ("start: [-50 m, 100 m]", "start: [50 m, 100 m]")
REVERSED = (("start: [-50 m, 100 m]", "start: [0 m, 60 m]"), ("    end: [0 m, 60 m]", "    end: [-50 m, 100 m]"))


@pytest.mark.parametrize(
    ("changes", "end"),
    [
        ((), "start"),
        ((("elements: 60", "elements: 23"),), "start"),
        ((MIRRORED,), "start"),
        (REVERSED, "end"),
        ((("10 MN", "1 GN"), ("elements: 60", "elements: 61")), "start"),
    ],
)
def test_a_rope_over_a_sheave_has_the_tension_of_its_catenary(changes: tuple[tuple[str, str], ...], end: str) -> None:
    """The catenary of 52 m over 50 m has 564.55 N at its ends; 10 MN stretches it by 5e-5 and lowers that by 1e-3."""
    assert force(run("c-p3-31", *changes), f"rope.{end}") == pytest.approx(564.55, rel=1.5e-3)


@pytest.mark.parametrize("spare", [94.0, 110.0])
def test_a_slack_tail_hangs_at_the_sheave(spare: float) -> None:
    """Tensions on both sides of a sheave are equal, so that it bears them in balance with both ends and the weight."""
    found = run("c-p3-31", ("92 m", f"{spare} m"))
    total = found["reaction"].to_numpy()[-1].sum(axis=0)
    assert total == pytest.approx([0.0, spare * 9.81], abs=1e-6 * spare * 9.81)  # of rounding


@pytest.mark.parametrize("a", ["[-0.1 m, 1 m]", "[-0.6 m, 2.5 m]", "[0.4 m, 1.7 m]", "[-1.1 m, 0.5 m]"])
def test_weights_over_a_pulley_come_to_rest_from_any_drawing(a: str) -> None:
    """The rope of 1 g/m bears 1 kg, and the thread the other half of a kilogram."""
    found = run("c-p3-12-atwood", ("[-0.1 m, 1 m]", a))
    assert mean_tension(found, "rope") == pytest.approx(9.81, rel=1e-3)  # its own weight
    assert mean_tension(found, "thread") == pytest.approx(4.905, rel=6e-3)  # its own weight, and 1 : 13 of slope


@pytest.mark.parametrize("at", ["[2 m, -2 m]", "[-1 m, -1 m]", "[0.5 m, 3 m]"])
def test_a_movable_pulley_comes_to_rest_from_any_drawing(at: str) -> None:
    found = run("movable-pulley", ("[2 m, -2 m]", at), ("{kind: dynamic, until: 0.1 s}", "{kind: equilibrium}"))
    assert force(found, "rope.start") == pytest.approx(52.368, rel=1e-4)  # digits shown


def test_a_beam_elsewhere_does_not_change_a_rope_over_a_sheave() -> None:
    lines = text("t-10-sheave-beside-a-beam").splitlines()
    alone = simulate(loads("\n".join(line for line in lines if not line.startswith("  beam"))))
    assert force(run("t-10-sheave-beside-a-beam"), "rope.w") == pytest.approx(force(alone, "rope.w"), rel=1e-9)


@pytest.mark.parametrize("changes", [(), (("elements: 2,", "elements: 8, law: {kind: tension_only},"),)])
def test_a_slack_hanger_hangs_between_cable_and_beam(changes: tuple[tuple[str, str], ...]) -> None:
    """It weighs 10 N, of which cable and beam bear no more than that; the cable bears its own 2531 N otherwise."""
    found = run("t-11-slack-hanger", *changes)
    bare = 0.5 * 9.81 * 10 * 25.8
    vertical = found["reaction"].sel(support=["cable.start", "cable.end"]).to_numpy()[-1][:, -1]
    assert vertical == pytest.approx([bare, bare], abs=9.81)


@pytest.mark.parametrize("count", [2, 3, 20])
@pytest.mark.parametrize("turned", [False, True])
def test_lines_in_one_row_have_their_tensions(count: int, turned: bool) -> None:
    """The sag of all is w L^2/(8 T) with the weight of stretched lines; tensions differ by (w L)^2/(8 T^2)."""
    rows = [f"joints: {{{', '.join(f'k{i}: {{}}' for i in range(1, count))}}}", "lines:"]
    for i in range(count):
        ends = [(10 * i, f"k{i}"), (10 * (i + 1), f"k{i + 1}" if i + 1 < count else "k0")][:: -1 if turned else 1]
        parts = [
            f"{side}: [{x}, 0]" + ("" if joint == "k0" else f", {side}_support: {{kind: joined, to: {joint}}}")
            for side, (x, joint) in zip(("start", "end"), ends, strict=True)
        ]
        rows.append(f"  l{i}: {{{', '.join(parts)}, tension: 20e3, mass: 1, axial_stiffness: 2e6, elements: 6}}")
    found = simulate(loads("\n".join([*rows, "run: {kind: equilibrium}"])))
    means = [mean_tension(found, f"l{i}") for i in range(count)]
    uneven = (9.81 * 10 * count) ** 2 / (8 * 20e3**2)
    assert means == pytest.approx(np.full(count, 20e3), rel=1.01 * uneven)
    sag = 9.81 / 1.01 * (10 * count) ** 2 / (8 * 20e3)
    assert -found["position"].to_numpy()[-1][:, -1].min() == pytest.approx(sag, rel=2e-3 + uneven)  # a parabola
    assert ("in one row" in found.attrs["warnings"]) == (uneven > 1e-3)  # told from 0.01 % on


def test_tensions_that_lines_in_one_row_cannot_have_are_refused() -> None:
    twenty = text(
        "c-13-twenty-lines-by-tension", ("end: [10 m, 0 m], tension: 20 kN", "end: [10 m, 0 m], tension: 9 kN")
    )
    with pytest.raises(EquilibriumError, match=r"l0\.tension: .* one row share their horizontal force"):
        simulate(loads(twenty))


DECK = "deck: {start: [0, 0], end: [40, 0]", "deck: {start: [40, 0], end: [0, 0]"


@pytest.mark.parametrize(("changes", "count"), [((), 5), ((("count: 5", "count: 2"), DECK), 2)])
def test_hangers_above_a_deck_of_given_tension_are_symmetric(changes: tuple[tuple[str, str], ...], count: int) -> None:
    scenario = loads(text("t-05-bridge-by-tension", *changes))
    lines = formed(scenario).lines
    lengths = [float(lines[f"h-{i}"].length or 0.0) for i in range(1, count + 1)]
    assert lengths == pytest.approx(lengths[::-1], abs=2e-6)  # form finding goes on to 4e-7 m
    found = simulate(scenario)
    place, line = found["position"].to_numpy()[-1], found["line"].to_numpy()
    feet = sorted(float(place[line == f"h-{i}"][-1, 0]) for i in range(1, count + 1))
    assert feet == pytest.approx([40.0 * i / (count + 1) for i in range(1, count + 1)], abs=2e-6)
    assert mean_tension(found, "deck") == pytest.approx(6e4, rel=1e-4)  # of unequal links


def test_a_line_that_nothing_holds_is_named() -> None:
    with pytest.raises(EquilibriumError, match=r"line rope near \(.*\) m is free to move; hold it"):
        run("c-p3-11-crash")


def test_a_mass_on_a_rail_may_be_slack_at_rest() -> None:
    """The thread holds the weight of 1 kg; the mass on the rail beyond it hangs on nothing."""
    found = run("c-p3-11-cut", ("until: 0.3 s, every: 10 ms", "until: 10 us, every: 10 us"))
    assert force(found.isel(time=[0]), "thread.start") == pytest.approx(9.814, abs=1e-3)  # with 0.4 g of rope


def test_motion_begins_with_a_result_where_there_is_no_equilibrium(tmp_path: Path) -> None:
    """Two masses of 1 kg, one of which falls: x = g t^2/4."""
    held = run("c-p3-11-hold", ("every: 1 ms", "every: 2 ms"))
    held.to_netcdf(tmp_path / "p3-11-hold.nc")
    stored = "p3-11-hold.nc", str(tmp_path / "p3-11-hold.nc")
    found = run("c-p3-11-go", ("until: 0.3 s, every: 10 ms", "until: 60 ms, every: 60 ms"), stored)
    moved = float(np.diff(found["position"].to_numpy()[:, 0, 0])[0])
    assert found.attrs["outcome"] == "completed"
    assert moved == pytest.approx(9.81 / 4 * 0.06**2, rel=0.05)  # the rope was 0.4 mm longer


@pytest.mark.parametrize("start", [-4.0, -3.99999])
def test_a_node_that_would_rest_at_a_sheave_does_not_matter(start: float) -> None:
    short = ("until: 1.1, every: 0.01", "until: 1e-3, every: 1e-3")
    moved = "start: [-0.05, -4]", f"start: [-0.05, {start}]"
    even, odd = (
        run("t-12-symmetric-over-a-sheave", short, moved, ("elements: 80", f"elements: {n}")) for n in (80, 79)
    )
    assert even["tension"].to_numpy()[0].max() == pytest.approx(odd["tension"].to_numpy()[0].max(), rel=2e-5)  # 1/n^2


@pytest.mark.xfail(strict=True, reason="one engine, stage 4")
def test_friction_on_a_saddle_is_followed_in_large_steps() -> None:
    """With 20 positions it is; with 5 the search ends after 12 halvings of a step, and says that more are needed."""
    assert run("t-09-saddle-friction-crash", ("elements: 100", "elements: 30")).attrs["outcome"] == "completed"


@pytest.mark.xfail(strict=True, reason="one engine, stage 4")
def test_a_heavy_mass_slides_on_an_inextensible_line() -> None:
    found = run("c-p3-13-inextensible", ("elements: 80", "elements: 12"), ("until: 1 s", "until: 0.15 s"))
    assert found.attrs["outcome"] == "completed"


class Wanderer:
    """A structure whose energy falls for ever."""

    size, is_symmetric = 1.0, True
    free = sparse.identity(1, format="csc")

    def energy(self, r: Array) -> float:
        return -float(np.abs(r[0]))

    def out_of_balance(self, r: Array) -> Array:
        return np.sign(r)

    def stiffness(self, r: Array) -> sparse.csc_matrix:
        return sparse.csc_matrix([[1.0]])

    convex = pattern = stiffness

    def stability(self, r: Array) -> tuple[sparse.csc_matrix, np.ndarray]:
        return self.stiffness(r), np.arange(1)

    def part(self, r: Array, way: Array) -> str:
        return "the node"

    def moved(self, r: Array, step: Array) -> Array:
        return np.asarray(r + step)

    def arrived(self, r: Array) -> tuple[Array, bool]:
        return r, False

    def approaches(self, start: Array, way: str) -> list[Array]:
        return []


def test_a_search_that_does_not_end_is_ended_and_says_where(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search_budget, "_SECONDS", 0.0)
    with pytest.raises(SearchBudgetError, match=r"in 201 factorisations .*: 1 N are not in balance on the node"):
        settle(Wanderer(), np.ones(1))
