"""Wheels follow the profile of their line, and of the ground before it, as a base-excited oscillator does."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from profile_cases import DAMPING, HEIGHT, MASS, RATE, SPEED, STIFFNESS, WAVE, Array, base_excited, read, rig, rows
from ropewalk.decouple import without_feedback
from ropewalk.errors import ScenarioError
from ropewalk.mechanics.profile_spectra import density, profile_of
from ropewalk.model.history import ForceTable
from ropewalk.model.load import MovingForce
from ropewalk.model.scenario import Scenario
from ropewalk.simulate import simulate

DYNAMIC = {"kind": "dynamic", "geometry": "linearised"}


# The beam bends by 4e-6 m under the largest force: 4e-4 of the height of the wave.
@pytest.mark.parametrize(("start", "axle", "until"), [(0.0, 0.0, 1.9), (-10.0, 0.0, 2.4), (-10.0, 200.0, 2.4)])
@pytest.mark.parametrize("run", [DYNAMIC, {"kind": "linear"}], ids=["dynamic", "linear"])
def test_a_sprung_mass_is_a_base_excited_oscillator(
    start: float, axle: float, until: float, run: dict[str, Any], tmp_path: Path
) -> None:
    found = simulate(read(rig({"file": rows(tmp_path / "sine.csv")}, {**run, "until": until}, start, axle)))
    assert found.attrs["outcome"] == "completed"
    t = found["time"].to_numpy()
    y, acceleration = base_excited(t, start)
    body = found["body_position"].to_numpy()[:, 0, 1] + MASS * 9.81 / STIFFNESS
    assert np.abs(body - y).max() < 5e-4 * HEIGHT
    s = start + SPEED * t
    on = (s > 4.0) & (s < 36.0)
    force = found["contact_force"].to_numpy()[:, 0, 1]
    wheel = -(RATE**2) * HEIGHT * np.sin(RATE * t + 2.0 * np.pi * start / WAVE)
    exact = -(MASS * (9.81 + acceleration) + axle * (9.81 + wheel))
    if axle and run is DYNAMIC:  # which rings on its contact from where it has come to the line on
        return
    assert np.abs(force - exact)[on].max() < 2e-4 * np.abs(exact).max()
    assert np.isnan(force[s < -0.1]).all()


def test_the_ground_does_the_work_on_what_waits_before_the_line(tmp_path: Path) -> None:
    """Its axle has 44 kJ of the travel and 140 J of the waves; the audit closes to the second order of the step."""
    run = {**DYNAMIC, "until": 2.4}
    found = simulate(read(rig({"file": rows(tmp_path / "sine.csv")}, run, -10.0, 200.0)))
    assert np.abs(found["energy"].sel(form="imbalance")).max() < 0.05


def test_the_profile_is_felt_to_the_fourth_order_of_its_rows_and_the_second_of_steps(tmp_path: Path) -> None:
    """On the ground alone, before the line: nothing else is there to be wrong."""

    def error(step: float, spacing: float) -> float:
        scenario = rig({"file": rows(tmp_path / "sine.csv", spacing)}, {**DYNAMIC, "until": 0.9, "step": step}, -19.0)
        scenario["lines"]["deck"] |= {"bending_stiffness": 1e8, "elements": 4}
        found = simulate(read(scenario))
        y = base_excited(found["time"].to_numpy(), -19.0)[0]
        body = found["body_position"].to_numpy()[:, 0, 1]
        return float(np.abs(body + MASS * 9.81 / STIFFNESS - y).max())

    steps = np.array([error(h, 0.05) for h in (4e-3, 2e-3, 1e-3)])
    assert np.log2(steps[:-1] / steps[1:]) == pytest.approx(2.0, abs=0.1)
    spacings = np.array([error(2.5e-5, h) for h in (1.0, 0.5)])
    assert np.log2(spacings[0] / spacings[1]) == pytest.approx(4.0, abs=0.6)  # two rows a wave longer than natural ends


def test_a_vehicle_rests_on_the_ground_before_the_line() -> None:
    """Dampers above its axles do not hear of what the ground bears."""
    car = {
        "kind": "vehicle", "on": "deck", "bodies": {"box": {"mass": 1000.0, "inertia": 500.0, "at": -6.0}},
        "wheels": {"front": {"at": -5.0, "mass": 100.0}, "rear": {"at": -7.0, "mass": 100.0}},
        "springs": {"f": {"between": ["box", "front"], "stiffness": 2e5, "damping": 5e3},
                    "r": {"between": ["box", "rear"], "stiffness": 2e5, "damping": 5e3}},
        "travel": {"speed": 0.0, "at_end": "leave"},
    }  # fmt: skip
    scenario = rig(None, {**DYNAMIC, "until": 0.1, "every": 0.05})
    scenario |= {"gravity": 9.81, "loads": {"car": car}}
    scenario["lines"]["deck"] |= {"bending_stiffness": 1e9, "elements": 10, "profile": {"spectrum": "ISO 8608 A"}}
    found = simulate(read(scenario))
    assert np.ptp(found["body_position"].to_numpy()[:, 0, 1]) < 1e-12


def test_an_axle_comes_to_the_line_with_the_force_that_the_ground_has_borne(tmp_path: Path) -> None:
    """Weights, springs above, and the inertia of what follows the wave; without them it rang by half of that."""
    axle = 200.0
    found = simulate(read(rig({"file": rows(tmp_path / "wave.csv")}, {**DYNAMIC, "until": 1.5}, -10.0, axle)))
    t = found["time"].to_numpy()
    bent = -HEIGHT * RATE**2 * np.sin(RATE * t - 20.0 * np.pi / WAVE)
    known = MASS * (9.81 + base_excited(t, -10.0)[1]) + axle * (9.81 + bent)
    force = -found["contact_force"].to_numpy()[:, 0, -1]
    on = np.isfinite(force)
    assert 0.5 < t[on][0] + 1e-9 < 0.53
    assert np.abs(force - known)[on].max() < 0.02 * known.max()


def test_what_slides_freely_trades_speed_for_height(tmp_path: Path) -> None:
    """Over a hump of 0.3 m on a taut rope: v^2/2 + g z stays. The rope gives way by 2 mm, which the height knows."""
    x = np.arange(0.0, 20.1, 0.25)
    np.savetxt(tmp_path / "hump.csv", np.stack([x, 0.3 * np.exp(-(((x - 10.0) / 2.0) ** 2))], axis=1), delimiter=",")
    rope = {"start": [0.0, 0.0], "end": [20.0, 0.0], "tension": 2e6, "mass": 5.0, "axial_stiffness": 1e8,
            "elements": 60, "profile": {"file": str(tmp_path / "hump.csv")}}  # fmt: skip
    bead = {"kind": "mass", "on": "rope", "mass": 20.0, "travel": {"kind": "free", "from": 3.0, "speed": 5.0}}
    run = {"kind": "dynamic", "until": 2.6, "every": 0.02}
    found = simulate(read({"lines": {"rope": rope}, "loads": {"bead": bead}, "run": run}))
    place = found["contact_position"].to_numpy()[:, 0]
    v = np.linalg.norm(np.gradient(place, 0.02, axis=0), axis=1)[5:-5]
    exact = np.sqrt(25.0 - 2.0 * 9.81 * (place[5:-5, 1] - place[0, 1]))
    assert exact.min() < 4.4
    assert np.abs(v - exact).max() < 3e-3  # what swings as it is set down suddenly
    assert np.abs(found["energy"].sel(form="imbalance")).max() < 1e-4


@pytest.mark.parametrize("spectrum", ["ISO 8608 A", "ISO 8608 H", "FRA 1", "FRA 6", "German low", "German high"])
def test_a_generated_profile_has_its_spectrum(spectrum: str) -> None:
    """The variance in each octave, from a periodogram of 60 km, is the integral of the density there.

    Within 3 %: an octave has 177 lines of the sum, of which half a line at each of its ends is another's; those at its
    lower end are 0.1 /km apart, which this is long enough to tell.
    """
    shortest, longest = 1.0, 50.0
    s, z = profile_of(spectrum, 3, (shortest, longest), 0.0, 60e3)
    window = np.hanning(z.size)
    power = np.abs(np.fft.rfft(window * (z - z.mean()))) ** 2 * 2.0 / (window**2).sum() / z.size
    n = np.fft.rfftfreq(z.size, s[1] - s[0])
    edges = 1.0 / longest * 2.0 ** np.arange(0.5, np.log2(longest / shortest) - 0.5)
    for low, high in itertools.pairwise(edges):
        fine = np.linspace(low, high, 2001)
        wanted = float(np.trapezoid(density(spectrum, fine), fine))
        assert power[(n >= low) & (n < high)].sum() == pytest.approx(wanted, rel=0.03)
    assert power[n > 1.01 / shortest].sum() < 1e-6 * power.sum()


def test_densities_are_those_of_their_sources() -> None:
    """Numbers by hand: G(0.1 1/m) of ISO 8608 classes, and one of FRA and of German track at W = 0.8245 rad/m."""
    assert density("ISO 8608 A", np.array([0.1]))[0] == pytest.approx(16e-6, rel=1e-12)
    assert density("ISO 8608 C", np.array([0.2]))[0] == pytest.approx(64e-6, rel=1e-12)
    n = np.array([0.8245 / (2.0 * np.pi)])
    assert density("FRA 6", n)[0] == pytest.approx(2.0 * np.pi * 0.25 * 0.0339e-4 / (2.0 * 0.8245**2), rel=1e-12)
    W, Wc, Wr = 0.8245, 0.8246, 0.0206
    german = 2.0 * np.pi * 4.032e-7 * Wc**2 / ((W**2 + Wr**2) * (W**2 + Wc**2))
    assert density("German low", n)[0] == pytest.approx(german, rel=1e-12)


def test_a_profile_does_not_depend_on_how_far_it_is_asked_for() -> None:
    s, z = profile_of("ISO 8608 B", 7, (0.5, 50.0), -10.0, 50.0)
    t, y = profile_of("ISO 8608 B", 7, (0.5, 50.0), 3.0, 90.0)
    assert np.abs(np.interp(t[(t > 4.0) & (t < 49.0)], s, z) - y[(t > 4.0) & (t < 49.0)]).max() < 1e-12
    other = profile_of("ISO 8608 B", 8, (0.5, 50.0), -10.0, 50.0)[1]
    assert np.abs(other - z).max() > 1e-3


def walks(profile: str | None, **deck: Any) -> Any:
    """A walker on a beam that hardly gives way, who begins above 3 m of level way."""
    q = float(np.linalg.norm(deck.get("end", [10.0, 0.0]))) / 10.0
    beam = {
        "start": [0.0, 0.0], "end": [10.0, 0.0], "length": 10.0 * q, "mass": 1000.0, "axial_stiffness": 1e9,
        "bending_stiffness": 1e11, "elements": 8, **deck, **({"profile": {"file": profile}} if profile else {}),
    }  # fmt: skip
    her = {"kind": "walker", "on": "deck", "from": 3.0 * q, **({"balance": {}} if len(beam["end"]) == 3 else {})}
    run = {"kind": "dynamic", "until": 0.9, "every": 0.05, "method": "verlet"}
    found = simulate(read({"lines": {"deck": beam}, "loads": {"her": her}, "run": run}))
    assert found.attrs["outcome"] == "completed"
    assert np.abs(found["energy"].sel(form="imbalance")).max() < 0.01  # J of 800 J
    assert np.isfinite(found["contact_xi"].to_numpy()).any(axis=0).all()  # both feet have stood
    return found


def a_rise(file: Path, slope: float, height: float = 0.0) -> str:
    """A file of a way that rises evenly."""
    x = np.array([-5.0, 12.0])
    np.savetxt(file, np.stack([x, height + slope * x], axis=1), delimiter=",", fmt="%.17g")
    return str(file)


def test_a_walker_on_a_level_profile_walks_as_on_none(tmp_path: Path) -> None:
    plain = walks(None)["body_position"].to_numpy()
    assert np.abs(walks(a_rise(tmp_path / "flat.csv", 0.0))["body_position"].to_numpy() - plain).max() < 1e-12
    raised = walks(a_rise(tmp_path / "raised.csv", 0.0, 0.3))["body_position"].to_numpy()
    assert np.abs(raised - plain - [0.0, 0.3]).max() < 1e-8  # rounding, and where feet are found to land


@pytest.mark.parametrize("end", [[10.0, 0.5], [10.0, 0.0, 0.5]], ids=["plane", "aside"])
def test_a_walker_climbs_a_profile_as_an_inclined_line(end: list[float], tmp_path: Path) -> None:
    """The beam is compressed by 5e-8 m where it is inclined; a body that balances falls as exp(2.9 t) from there."""
    level = [*end[:-1], 0.0]
    over = walks(a_rise(tmp_path / "rise.csv", 0.05), end=level, start=[0.0] * len(end))
    on = walks(None, end=end, start=[0.0] * len(end))
    assert np.abs(over["body_position"].to_numpy() - on["body_position"].to_numpy()).max() < 1e-5
    force = [np.nan_to_num(found["contact_force"].to_numpy()).sum(axis=1) for found in (over, on)]
    assert np.abs(force[0] - force[1]).max() < 0.05  # N of 1600


class Sprung:
    """A sprung mass that rolls along as a model of a user's own: exact where its wheel moves evenly."""

    def __init__(self) -> None:
        self.z = self.v = self.base = 0.0

    def reset(self, line: Any) -> None:
        self.base = float(line.at(0.0)[0][-1])
        self.z, self.v = self.base, HEIGHT * RATE

    def step(self, t: float, h: float, line: Any) -> list[Any]:
        place = float(line.at(SPEED * t)[0][-1])
        rise = (place - self.base) / h if t > 0.0 else HEIGHT * RATE
        if t > 0.0:
            root = (-DAMPING + np.sqrt(complex(DAMPING**2 - 4.0 * STIFFNESS * MASS))) / (2.0 * MASS)
            x, w = self.z - self.base, self.v - rise  # above its wheel
            c = (w - root.conjugate() * x) / (root - root.conjugate()) * np.exp(root * h)
            self.z, self.v = place + 2.0 * c.real, rise + 2.0 * (root * c).real
            self.base = place
        force = STIFFNESS * (self.z - place) + DAMPING * (self.v - rise)
        return [(SPEED * t, [0.0, force], SPEED)]


def test_a_model_of_ones_own_sees_the_line_with_its_profile(tmp_path: Path) -> None:
    """The same sprung mass as a model that is asked a thousand times a second: its wheel goes straight in between."""
    own = rig({"file": rows(tmp_path / "sine.csv")}, {**DYNAMIC, "until": 1.5})
    own["loads"] = {"car": {"kind": "stepper", "on": "deck", "model": "MODEL", "every": 1e-3}}
    scenario = Scenario.model_validate({**own, "loads": {"car": {**own["loads"]["car"], "model": Sprung()}}})
    found = simulate(scenario)
    assert found.attrs["outcome"] == "completed"
    t, force = found["time"].to_numpy(), found["contact_force"].to_numpy()[:, 0, -1]
    exact = -MASS * base_excited(t, 0.0)[1]
    on = (t > 0.1) & (t < 1.45)
    assert np.abs(force - exact)[on].max() < 2e-3 * np.abs(exact).max()  # twice what was seen
    place = found["contact_position"].to_numpy()[:, 0]
    assert np.abs(place[on, 1] - HEIGHT * np.sin(2.0 * np.pi * SPEED / WAVE * t[on])).max() < 2e-5


@pytest.mark.parametrize("start", [0.0, 5.0])
def test_without_feedback_a_sprung_mass_presses_as_on_a_rigid_way(start: float, tmp_path: Path) -> None:
    """In closed form, on a bridge that bends by centimetres; ground gives way by 3e-6 m, and its links have a mass."""
    car = rig({"file": rows(tmp_path / "sine.csv")}, {**DYNAMIC, "until": 1.2}, start)
    car["lines"]["deck"] |= {"bending_stiffness": 1e8}
    alone = without_feedback(read(car)).loads["car"]
    assert isinstance(alone, MovingForce)
    assert isinstance(alone.force, ForceTable)
    t, force = np.array(alone.force.time), np.array(alone.force.value)
    exact = -MASS * (9.81 + base_excited(t, start)[1])
    assert np.abs(force[:, 1] - exact).max() < 2e-3 * np.abs(exact).max()  # twice what was seen
    assert np.abs(force[:, 0]).max() < 1.0
    assert alone.travel.start == start


@pytest.mark.parametrize("measured", ["material", "horizontal"])
def test_without_feedback_a_mass_presses_with_its_inertia_over_waves(measured: str, tmp_path: Path) -> None:
    """On a deck that rises by 5 % as well, along which its travel is measured, or level."""
    level = float(np.sqrt(1.0 - 0.05**2)) if measured == "horizontal" else 1.0
    scenario = rig({"file": rows(tmp_path / "sine.csv")}, {**DYNAMIC, "until": 1.0, "start": {"with_loads": True}})
    travel = {"speed": 16.0, "measured": measured, "from": 4.0, "at_end": "leave"}
    scenario["lines"]["deck"] |= {"bending_stiffness": 1e8, "end": [float(np.sqrt(1596.0)), 2.0]}
    scenario |= {"gravity": 9.81, "loads": {"mass": {"kind": "mass", "on": "deck", "mass": 50.0, "travel": travel}}}
    force = without_feedback(read(scenario)).loads["mass"].force
    t, along = np.array(force.time), 16.0 / level
    s = 4.0 / level + along * t
    exact = -50.0 * (9.81 - HEIGHT * (2.0 * np.pi / WAVE * along) ** 2 * np.sin(2.0 * np.pi / WAVE * s))
    late = t > 0.1  # as it begins, it rests, and comes to the speed of its way all of a sudden
    assert np.abs(np.array(force.value)[late, 1] - exact[late]).max() < 1e-3 * 50.0 * 9.81


def test_a_profile_from_a_file_tells_its_row(tmp_path: Path) -> None:
    (tmp_path / "wrong.csv").write_text("0, 0\n1, 0.01\n1, 0.02\n")
    with pytest.raises(ScenarioError, match="x must rise") as error:
        simulate(read(rig({"file": str(tmp_path / "wrong.csv")}, {**DYNAMIC, "until": 0.1})))
    assert error.value.problems[0].key == "lines.deck.profile.file"


def test_a_force_does_not_feel_a_profile(tmp_path: Path) -> None:
    (tmp_path / "level.csv").write_text("0, 0\n40, 0\n")

    def places(profile: dict[str, Any]) -> tuple[Array, Array]:
        scenario = rig(profile, {**DYNAMIC, "until": 0.2})
        force = {"kind": "force", "on": "deck", "force": [0.0, -1e4], "travel": {"speed": 20.0, "from": 4.0}}
        scenario["lines"]["deck"] |= {"bending_stiffness": 1e9, "elements": 10}
        found = simulate(read({**scenario, "loads": {"force": force}}))
        return found["position"].to_numpy(), found["contact_position"].to_numpy()

    rough, smooth = places({"spectrum": "ISO 8608 D"}), places({"file": str(tmp_path / "level.csv")})
    assert np.abs(smooth[0][..., 1]).max() > 1e-3
    assert all((one == other).all() for one, other in zip(rough, smooth, strict=True))
