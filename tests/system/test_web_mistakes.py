"""What does not fit together in webs: each mistake is reported once, at its line and key, with a remedy."""

from __future__ import annotations

import pytest

from ropewalk.errors import ScenarioError
from ropewalk.scenario import loads

WEB = """lines:
  a: {start: [0, 0], end: [5, -1], length: 5, mass: 1, axial_stiffness: 1e5, end_support: {kind: joined, to: knot}}
  b: {start: [9, 0], end: [5, -1], length: 5, mass: 1, axial_stiffness: 1e5, end_support: {kind: joined, to: knot}}
  c: {start: [5, -4], end: [3, 0], length: 5, mass: 1, axial_stiffness: 1e5, end_support: {kind: joined, to: a, at: 2}}
joints:
  knot: {mass: 2}
loads:
  p: {kind: force, on: a, force: [0, -9], travel: {speed: 1}}
run: {kind: dynamic, until: 1 s}
"""
NET = """nets:
  n: {kind: net, corner: [0, 0, 0], sides: [[4, 0, 0], [0, 3, 0]], axial_stiffness: 1e4, mass: 0.1, tension: 50}
loads:
  p: {kind: force, on: n, force: [0, 0, -9], travel: {speed: 1, path: [[1, 1], [3, 1]]}}
run: {kind: dynamic, until: 1 s}
"""

# What is replaced, by what; line, key and words of the only problem.
MISTAKES = {
    "path on a line": ("speed: 1}", "speed: 1, path: [[0, 1], [1, 1]]}", 8, "loads.p.travel.path", "is for nets"),
    "method": ("1 s", "1 s, method: rkn6, window: 3 m, geometry: linearised", 9, "run.method", "leave window out"),
    "wind that nothing feels": (
        "run: {kind: dynamic", "wind: {direction: [1, 0], speed: 5}\nrun: {kind: dynamic",
        9, "wind", "wind acts on nothing",
    ),
    "an idle joint": ("\nloads", "\n  idle: {mass: 1}\nloads", 7, "joints.idle", "no line is joined to it"),
    "no such joint": ("to: a, at: 2", "to: kot", 4, "lines.c.end_support.to", "did you mean knot"),
    "itself": ("to: a, at: 2", "to: c, at: 2", 4, "lines.c.end_support.to", "cannot be joined to itself"),
    "place on a joint": ("to: a, at: 2", "to: knot, at: 2", 4, "lines.c.end_support.at", "a joint is a single point"),
    "no place on a line": ("to: a, at: 2", "to: a", 4, "lines.c.end_support.at", "position along that line"),
    "off the line": ("to: a, at: 2", "to: a, at: 6", 4, "lines.c.end_support.at", "is off the line a (5 m long)"),
    "no such joint for a sheave": (
        "{start: [9, 0],", "{sheaves: {w: {at: [7, -1], to: kno}}, start: [9, 0],",
        3, "lines.b.sheaves.w.to", "did you mean knot",
    ),
}  # fmt: skip
ON_NETS = {
    "no path": (", path: [[1, 1], [3, 1]]", "", 4, "loads.p.travel.path", "required for a load on a net"),
    "no length": ("[[1, 1], [3, 1]]", "[[1, 1], [1, 1]]", 4, "loads.p.travel.path", "the path has no length"),
    "beyond the end": ("speed: 1,", "speed: 5,", 4, "loads.p.travel.speed", "5 m along its path of 2 m"),
}  # fmt: skip


def problems_of(text: str) -> list[tuple[int | None, str, str]]:
    with pytest.raises(ScenarioError) as caught:
        loads(text, "web.yaml")
    return [(problem.line, problem.key, str(problem)) for problem in caught.value.problems]


def test_both_are_right_without_a_mistake() -> None:
    assert loads(WEB, "web.yaml").is_network
    assert loads(NET, "web.yaml").is_network


@pytest.mark.parametrize("name", [*MISTAKES, *ON_NETS])
def test_the_mistake_has_one_problem_with_its_place_and_remedy(name: str) -> None:
    base, (old, new, line, key, says) = (WEB, MISTAKES[name]) if name in MISTAKES else (NET, ON_NETS[name])
    assert old in base
    ((at, where, row),) = problems_of(base.replace(old, new, 1))
    assert (at, where) == (line, key)
    assert says in row
    assert ";" in row  # what to do


def test_a_name_stands_for_one_thing() -> None:
    rows = [row for *_, row in problems_of(WEB.replace("\nloads", "\n  c: {mass: 1}\nloads"))]
    assert any("joints.c: a line has the same name" in row for row in rows)


def test_inextensible_lines_do_not_resist_bending_in_webs_either() -> None:
    old, stretch = "length: 5, mass: 1, axial_stiffness: 1e5, end_support: {kind: joined, to: a", "axial_stiffness: 1e5"
    text = WEB.replace(old, old.replace(stretch, "law: {kind: inextensible}, bending_stiffness: 5"))
    rows = problems_of(text)
    assert any(key == "lines.c.bending_stiffness" and "for inextensible lines" in row for _, key, row in rows)


def test_a_stiff_line_may_rest_in_a_web_without_nets() -> None:
    text = WEB.replace("[3, 0], length: 5,", "[3, 0], length: 5, bending_stiffness: 10,")
    loads(text.replace("kind: dynamic, until: 1 s", "kind: equilibrium"), "web.yaml")


def test_a_line_is_not_joined_to_a_net_without_a_place_on_it() -> None:
    text = NET + "lines:\n  a: {start: [2, 1, 5], end: [2, 1, 0], length: 5, mass: 1, axial_stiffness: 1e5, "
    text += "end_support: {kind: joined, to: n%s}}\n"
    ((_, key, row),) = problems_of(text % ", at: 3")
    assert key == "lines.a.end_support.at"
    assert "write at: [u, v] in m" in row
    loads(text % ", at: [2, 1]", "web.yaml")


def test_a_path_is_said_in_two_coordinates() -> None:
    assert any("path" in key for _, key, _ in problems_of(NET.replace("[[1, 1], [3, 1]]", "[[1, 1, 0], [3, 1, 0]]")))


def test_a_load_that_would_leave_the_line_is_refused() -> None:
    assert any(key == "loads.p.travel.speed" for _, key, _ in problems_of(WEB.replace("speed: 1}", "speed: 9}")))
    for at_end in ("leave", "stay"):
        loads(WEB.replace("speed: 1}", f"speed: 9, at_end: {at_end}}}"), "web.yaml")
