"""Form finding: droppers of the EN 50318 models, a messenger as a polygon of string, lengths that cannot be."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from overhead_cases import EN_2002, SIMPLE_AC, formed, rested
from ropewalk.errors import EquilibriumError

MIDDLE = slice(36, 45)  # droppers of span 5 of 10
AT = np.array(EN_2002["droppers"]["at"])
GRAVITY, STIFFNESS = 9.81, 100e3
Array = NDArray[np.float64]


def pulls() -> Array:
    """Of droppers that hold a string level: half of it to either side."""
    x = np.concatenate([[0.0], AT, [60.0]])
    return np.asarray(1.35 * GRAVITY * (x[2:] - x[:-2]) / 2.0)


def string_lengths(tension: float = 16e3, mass: float = 1.07, span: float = 60.0) -> Array:
    """Droppers below a string under its own weight and point loads, all in closed form."""
    low, high = np.minimum(AT[:, None], AT), np.maximum(AT[:, None], AT)
    sag = (mass * GRAVITY * AT * (span - AT) / 2.0 + (low * (span - high) / span) @ pulls()) / tension
    return np.asarray(1.2 - sag - pulls() / STIFFNESS)


def test_the_droppers_of_en_50318_2002_pull_as_published() -> None:
    published = [69, 79, 86, 86, 86, 86, 86, 79, 69]
    # Given in whole newtons.
    np.testing.assert_allclose(formed(EN_2002).pull[MIDDLE], published, atol=1.0)


@pytest.mark.parametrize("element", [0.5, 0.37])
def test_dropper_lengths_are_those_below_a_polygon_of_string(element: float) -> None:
    section = formed(EN_2002, element=element)
    np.testing.assert_allclose(section.pull[MIDDLE], pulls(), rtol=2e-3)  # droppers midway between nodes, no more
    # The kinks at droppers and supports fall between control points, which the local compliance sets right.
    np.testing.assert_allclose(section.lengths[MIDDLE], string_lengths(), atol=1e-4)


def c1_lengths(h: float = 0.6, spans: int = 3) -> Array:
    """The same with a messenger of cubic elements, whose slope cannot jump at a support either."""
    count, tension, weight = round(spans * 60.0 / h), 16e3, 1.07 * GRAVITY
    K, f = np.zeros((2 * count + 2, 2 * count + 2)), np.zeros(2 * count + 2)
    rising = np.array([[36, 3 * h, -36, 3 * h], [3 * h, 4 * h * h, -3 * h, -h * h],
                       [-36, -3 * h, 36, -3 * h], [3 * h, -h * h, -3 * h, 4 * h * h]])  # fmt: skip
    for e in range(count):
        part = slice(2 * e, 2 * e + 4)
        K[part, part] += tension / (30.0 * h) * rising
        f[part] -= weight * h * np.array([0.5, h / 12.0, 0.5, -h / 12.0])

    def shape(x: float) -> tuple[slice, Array]:
        e = int(x / h)
        t = x / h - e
        cubic = [1 - 3 * t * t + 2 * t**3, h * (t - 2 * t * t + t**3), 3 * t * t - 2 * t**3, h * (t**3 - t * t)]
        return slice(2 * e, 2 * e + 4), np.array(cubic)

    for k in range(spans):
        for x, pull in zip(AT, pulls(), strict=True):
            part, share = shape(60.0 * k + x)
            f[part] -= pull * share
    free = np.setdiff1d(np.arange(2 * count + 2), [2 * round(60.0 * k / h) for k in range(spans + 1)])
    z = np.zeros(2 * count + 2)
    z[free] = np.linalg.solve(K[np.ix_(free, free)], f[free])
    middle = [shape(60.0 * (spans // 2) + x) for x in AT]
    return np.array([1.2 + z[part] @ share for part, share in middle]) - pulls() / STIFFNESS


def test_the_table_of_lengths_lies_above_the_string_because_its_elements_round_the_kink_at_the_supports() -> None:
    table = np.array([0.999, 0.817, 0.661, 0.567, 0.535, 0.567, 0.661, 0.817, 0.999])
    above = table - formed(EN_2002).lengths[MIDDLE]
    # All by nearly the same, 3.4 to 4.2 mm: it comes from the supports. Rounding to a millimetre is 0.5 of it.
    assert above.max() < 4.5e-3
    assert above.min() > 3.0e-3
    # Elements of 0.6 m with continuous slope give the table; theirs had other nodes, which moves droppers by 0.6 mm.
    np.testing.assert_allclose(c1_lengths(), table, atol=1.2e-3)
    np.testing.assert_allclose(c1_lengths(0.2), string_lengths(), atol=1.3e-3)  # and finer ones the string


def test_the_droppers_of_simple_ac_have_their_nominal_lengths() -> None:
    first = formed(SIMPLE_AC)
    hold = first.plan.holds[first.holds["section.support.3"]]
    # The published height of the supports is that of their springs without load, here it is given at rest.
    section = formed(SIMPLE_AC, system_height=1.2 - (hold.place[2] - 1.2))
    nominal = [1.017, 0.896, 0.810, 0.758, 0.741, 0.758, 0.810, 0.896, 1.017]
    # The independent check reached 1 to 2 mm, too; the pre-sag is in whole millimetres.
    np.testing.assert_allclose(section.lengths[18:27], nominal, atol=2e-3)


VARIANTS: dict[str, dict[str, Any]] = {
    "en": EN_2002,
    "pre-sag": EN_2002 | {"pre_sag": 0.03, "start": [100.0, 2.0, 5.08]},
    "simple ac": SIMPLE_AC,
    "arms that hold the wire level": SIMPLE_AC | {"steady_arms": {"stagger": 0.2, "mass_per_length": 0.73}},
    "droppers that lean": SIMPLE_AC | {"messenger_supports": {"stagger": "straight"}},
    "nothing at the supports": EN_2002 | {"steady_arms": {"free": True}},
    "spans of several lengths": EN_2002 | {"spans": [60, 50, 65], "droppers": {"per_span": 8}, "analysed_spans": None},
    "one span": EN_2002 | {"spans": [60], "analysed_spans": None},
    "stitch wires": EN_2002 | {"stitch_wire": {}, "system_height": 1.8, "spans": [60] * 4, "analysed_spans": None},
}


@pytest.mark.parametrize("line", VARIANTS.values(), ids=VARIANTS)
def test_lengths_found_for_heights_give_these_heights(line: dict[str, Any]) -> None:
    from ropewalk.model.overhead import OverheadLine

    by_heights = formed(line)
    rows = np.split(by_heights.lengths, len(by_heights.supports) - 1)
    droppers = line["droppers"] | {"lengths": [row.tolist() for row in rows]}
    by_lengths = formed(line, droppers=droppers, pre_sag=None)
    wanted = by_heights.level - np.concatenate(OverheadLine.model_validate(line).sags)

    for section in (by_heights, by_lengths):
        rest, heights = rested(section)
        # Newton's method ends at 1e-13 of the length; forces of 1e-7 N at the supports are 1e-10 m.
        np.testing.assert_allclose(heights[: wanted.size], wanted, atol=1e-6)
        np.testing.assert_allclose(rest.tie_force[: wanted.size], by_heights.pull, atol=1e-3)
        if not line["steady_arms"].get("free"):
            # The weight of what is clamped there bends a stiff wire by 2e-6 m more than its node, see `rested`.
            np.testing.assert_allclose(heights[wanted.size :], section.level, atol=3e-6)
    np.testing.assert_allclose(by_lengths.pull, by_heights.pull, atol=1e-3)


def test_a_wire_that_nothing_holds_up_hangs_from_the_droppers_beside_the_support() -> None:
    section = formed(EN_2002, steady_arms={"free": True, "mass": 0})
    _, heights = rested(section)
    # A string of 10 m between two droppers at the same height: m g L^2 / (8 T), 8 mm.
    np.testing.assert_allclose(heights[90:], -1.35 * GRAVITY * 10.0**2 / (8.0 * 20e3), rtol=1e-3)


def test_a_dropper_given_too_long_is_slack_and_named() -> None:
    lengths = formed(EN_2002).lengths[MIDDLE].tolist()
    lengths[3] += 0.05
    section = formed(EN_2002, droppers=EN_2002["droppers"] | {"lengths": lengths})
    assert section.slack == tuple(f"section.{span}.4" for span in range(1, 11))
    assert section.pull[section.droppers["section.5.3"]] > 100.0


def test_heavier_droppers_are_found_with_the_weight_of_the_length_that_they_have() -> None:
    section = formed(SIMPLE_AC)
    index = section.droppers["section.3.1"]
    tie = section.plan.ties[index]
    own = 0.5 * 0.117 * section.lengths[index]
    lumps = [lump.mass for lump in section.plan.masses if lump.spot == tie.spot]
    assert lumps == pytest.approx([0.165 + own], abs=1e-9)  # the lengths are found to 1e-10 m


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"system_height": 0.5}, "dropper section.1.5 would have to be -0.16"),
        ({"messenger_wire": {"tension": "5 kN"}}, "more tension to messenger_wire (it is 5000 N)"),
        ({"pre_sag": [0, 0, 0, 0, 0.2, 0, 0, 0, 0]}, "dropper section.1.5 would have to push with"),
        ({"steady_arms": {"stagger": "10 mm"}}, "would have to stand steeply"),
        ({"steady_arms": {"stagger": [0.2] * 11}}, "has no kink at section.arm.1"),
        (
            {
                "steady_arms": {"stagger": 1.5},
                "messenger_supports": {"stagger": "straight"},
                "droppers": EN_2002["droppers"] | {"lengths": [1, 0.8, 0.6, 0.5, 0.5, 0.5, 0.6, 0.8, 1]},
            },
            "cannot lean",
        ),
    ],
)
def test_what_cannot_be_built_is_refused_with_advice(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(EquilibriumError, match="overhead line section: ") as caught:
        formed(EN_2002, **changes)
    assert says in str(caught.value)


def test_a_hinged_arm_hangs_half_its_weight_on_the_wire_and_moves_a_third_of_its_mass() -> None:
    with_arm = formed(EN_2002, steady_arms={"free": True, "mass_per_length": "1 kg/m", "length": "1.2 m"})
    without = formed(EN_2002, steady_arms={"free": True, "mass": 0})
    beside = [with_arm.droppers[name] for name in ("section.5.9", "section.6.1")]
    # The droppers beside the support hold the wire at heights, so that they and no others bear it.
    assert (with_arm.pull - without.pull)[beside].sum() == pytest.approx(0.6 * GRAVITY, rel=1e-3)
    assert [lump.mass for lump in with_arm.plan.masses if lump.spot.station == 300.0] == pytest.approx([0.4])


def test_stitch_wires_have_their_tension_whatever_the_droppers_do() -> None:
    line = EN_2002 | {"stitch_wire": {}, "system_height": 1.8, "spans": [60] * 4, "analysed_spans": None}
    lengths = formed(line).lengths[9:18] + np.array([0.06, 0, 0, 0, 0, 0, 0, 0, 0])
    section = formed(line, droppers=EN_2002["droppers"] | {"lengths": lengths.tolist()})
    rest, _ = rested(section)
    links = [i for i, tie in enumerate(section.plan.ties) if ".stitch." in tie.name]
    assert len(links) == 6
    # Along the line, as its links turn with the wire; found to 1e-10 m of 200 kN/m.
    level = np.sqrt(1.0 - rest.tie_way[links, 2] ** 2)
    np.testing.assert_allclose(rest.tie_force[links] * level, 2.5e3, rtol=1e-5)
