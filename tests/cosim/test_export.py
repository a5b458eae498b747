"""Lines and vehicles as FMUs: valid, loaded again and again, and doing what they do in a scenario."""

import sys
import zipfile

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import ropewalk
from coupling_master import FmuPart
from ropewalk.cosim import Outside, stepwise
from ropewalk.cosim.export import export
from ropewalk.cosim.vehicle import LoneVehicle, alone
from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.model import MovingMass, Oscillator

fmpy = pytest.importorskip("fmpy")
pytest.importorskip("pythonfmu")
from fmpy.validation import validate_fmu  # noqa: E402

TRAVEL = {"speed": 5.0, "from": 10.0}


def string(loads=None, **line):
    given = {"start": (0, 0), "end": (20, 0), "tension": 2e3, "mass": 0.5, "axial_stiffness": 2e5, "elements": 80}
    run = {"kind": "dynamic", "until": 0.3, "every": 0.01, "method": "verlet", "step": 2e-4}
    return ropewalk.Scenario(lines={"rope": ropewalk.Line(**given | line)}, loads=loads or {}, run=run)


def body(**more):
    return Oscillator(on="rope", mass=5.0, stiffness=2e3, damping=20.0, travel=TRAVEL, **more)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmus")
    export(string(), "rope", folder / "motion.fmu", contacts=2)
    export(string(), "rope", folder / "force.fmu", causality="force", contact_stiffness=1e4, measured="horizontal")
    export(string({"b": body()}), "b", folder / "vehicle.fmu")
    export(string({"b": MovingMass(on="rope", mass=5.0, travel=TRAVEL)}), "b", folder / "mass.fmu")
    return folder


KINDS = ("motion", "force", "vehicle", "mass")


@pytest.mark.parametrize("kind", KINDS)
def test_the_validator_finds_nothing(kind, files):
    assert validate_fmu(str(files / f"{kind}.fmu")) == []


@pytest.mark.parametrize("kind", KINDS)
def test_all_variables_are_described(kind, files):
    about = fmpy.read_model_description(str(files / f"{kind}.fmu"))
    assert "ropewalk[fmi]" in about.description
    assert about.coSimulation.canGetAndSetFMUstate
    assert about.coSimulation.canHandleVariableCommunicationStepSize
    for variable in about.modelVariables:
        assert variable.description
        assert variable.type == "Boolean" or variable.unit or variable.name.endswith("slope")
        assert variable.causality == "output" or variable.start is not None


@pytest.mark.parametrize("kind", KINDS)
def test_fmpy_simulates_it(kind, files):
    result = fmpy.simulate_fmu(str(files / f"{kind}.fmu"), stop_time=0.02, step_size=1e-3, output_interval=1e-3)
    assert result["time"].size == 21
    assert all(np.isfinite(result[name]).all() for name in result.dtype.names)


def test_the_line_in_the_fmu_is_the_line(files):
    h, line = 2e-3, stepwise(string(), {"a": Outside("rope"), "b": Outside("rope")})
    with FmuPart(files / "motion.fmu") as fmu:
        at = {"contact1.place": 5.0, "contact2.place": 12.0}
        fmu.begin(at | {"contact1.force": 0.0, "contact2.force": 0.0})
        for n in range(20):
            fmu.step(n * h, h, {"contact1.force": -50.0 * (n + 1), "contact2.place": 12.0 + 4.0 * (n + 1) * h})
            line.set_force("a", 5.0, -50.0 * n, last=-50.0 * (n + 1))
            line.set_force("b", 12.0 + 4.0 * n * h, 0.0, 4.0)
            line.step(h)
        a, b = line.output("a"), line.output("b")
        assert fmu.look("contact1.height") == pytest.approx(a.place[-1], abs=1e-12)  # the same but for rounding
        assert fmu.look("contact2.velocity") == pytest.approx(b.velocity[-1], abs=1e-12)
        assert fmu.look("contact1.slope") == pytest.approx(a.slope, abs=1e-12)
        forces = line.support_forces()
        assert fmu.look("support_rope_start.force_z") == pytest.approx(forces["rope.start"][-1], abs=1e-8)


def test_instances_side_by_side_and_again_and_again(files):
    def height(force, kind="motion"):
        with FmuPart(files / f"{kind}.fmu") as fmu:
            fmu.begin({"contact1.place": 5.0, "contact1.force": force})
            for n in range(10):
                fmu.step(n * 2e-3, 2e-3, {})
            return fmu.look("contact1.height")

    alone_ = [height(-100.0), height(-300.0)]
    with (
        FmuPart(files / "motion.fmu") as one,
        FmuPart(files / "motion.fmu") as two,
        FmuPart(files / "mass.fmu") as mass,
    ):
        for fmu, force in ((one, -100.0), (two, -300.0)):
            fmu.begin({"contact1.place": 5.0, "contact1.force": force})
        mass.begin({"contact1.force": 0.0})
        for n in range(10):
            for fmu in (one, two, mass):
                fmu.step(n * 2e-3, 2e-3, {})
        assert [one.look("contact1.height"), two.look("contact1.height")] == alone_
        assert mass.look("contact1.velocity") == pytest.approx(-9.81 * 0.02, rel=1e-12)  # it falls
    assert [height(-100.0), height(-300.0)] == alone_


def test_who_has_run_an_fmu_can_write_another(files, tmp_path):
    """An FMU brings a pythonfmu of its own; our slaves, which it is the first to import, then derive from that."""
    sys.modules.pop("ropewalk.cosim.slaves")
    del ropewalk.cosim.slaves
    names = {"force": "contact1.force", "height": "contact1.height", "velocity": "contact1.velocity"}
    contact = {**names, "force_factor": 1.0, "height_from": "zero"}
    load = {"kind": "fmu", "on": "rope", "file": str(files / "vehicle.fmu"), "contacts": {"wheel": contact}}
    whole = string().model_dump(by_alias=True) | {"loads": {"b": {**load, "travel": TRAVEL, "every": 0.01}}}
    assert ropewalk.simulate(ropewalk.Scenario.model_validate(whole)).attrs["outcome"] == "completed"
    export(string({"b": body()}), "b", tmp_path / "again.fmu")
    assert validate_fmu(str(tmp_path / "again.fmu")) == []


@pytest.mark.parametrize("kind", KINDS)
def test_an_fmu_goes_back_in_time(kind, files):
    message, seen = {
        "motion": ("contact1.force", "contact1.height"), "force": ("contact1.height", "contact1.force"),
        "vehicle": ("contact1.height", "contact1.force"), "mass": ("contact1.force", "contact1.height"),
    }[kind]  # fmt: skip
    with FmuPart(files / f"{kind}.fmu") as fmu:
        fmu.begin({})
        scale = 10.0 if message.endswith("force") else 1e-2

        def go():
            found = []
            for n in range(5):
                fmu.step(n * 1e-3, 1e-3, {message: -scale * n})
                found.append(fmu.look(seen))
            return found

        go()
        state = fmu.get_state()
        first = go()
        fmu.set_state(state)
        assert go() == pytest.approx(first, rel=1e-9)  # see test_going_back_repeats_what_was


def test_steps_refused_say_so(files):
    with FmuPart(files / "motion.fmu") as fmu:
        fmu.begin({"contact1.place": 5.0})
        with pytest.raises(RopewalkError, match="refused the step"):
            fmu.step(0.0, 1e-3, {"contact1.force": float("nan")})


# -- Vehicles by themselves -----------------------------------------------------------------------------------------


def test_a_vehicle_moves_exactly_over_a_step_of_any_length():
    vehicle = alone(string({"b": body()}), "b")
    h, low, high = 0.2, np.array([0.0]), np.array([0.05])
    rise = (high - low) / h

    def rate(t, x):
        return [x[1], (-2e3 * (x[0] - rise[0] * t) - 20.0 * (x[1] - rise[0])) / 5.0]

    expected = solve_ivp(rate, (0.0, h), [0.0, 0.0], rtol=1e-11, atol=1e-13).y[:, -1]
    for parts in (1, 7):
        ride = LoneVehicle(vehicle, "force")
        ride.place(low, np.zeros(1))
        for n in range(parts):
            ends = (low + rise * h * n / parts, rise), (low + rise * h * (n + 1) / parts, rise)
            ride.step(h / parts, *ends)
        assert [ride.q[0], ride.v[0]] == pytest.approx(expected, rel=1e-9)  # of the reference


def test_a_wheel_that_lifts_off_lands_again():
    vehicle = alone(string({"b": MovingMass(on="rope", mass=5.0, travel=TRAVEL, lift_off=True)}), "b",
                    contact_stiffness=2e4)  # fmt: skip
    ride, still = LoneVehicle(vehicle, "force"), (np.zeros(1), np.zeros(1))
    ride.place(*still)
    ride.q[:] += 0.5  # thrown down from half a metre
    drop = 0.5 - 5.0 * 9.81 / 2e4
    fall = np.sqrt(2.0 * drop / 9.81)
    ride.step(0.9 * fall, still, still)
    assert ride.forces(*still)[0] == 0.0
    assert ride.q[0] == pytest.approx(0.5 - 0.5 * 9.81 * (0.9 * fall) ** 2, rel=1e-9)
    w, g = np.sqrt(2e4 / 5.0), 9.81
    # On the spring it swings about its place of rest: half a turn, and twice from where it touches to there.
    bounce = (np.pi + 2.0 * np.arctan(g / w / np.sqrt(2.0 * g * drop))) / w
    ride.step(1.1 * fall + bounce, still, still)
    assert ride.q[0] == pytest.approx(0.5, rel=1e-6)  # it has bounced back to where it was: no energy is lost
    assert ride.v[0] == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize("height", [0.0, 3.0])
def test_a_mass_on_a_net_is_that_on_a_level_line(height):
    """Without its net it knows of this only how high it is and how far it goes."""
    sheet = {"kind": "net", "corner": [1, 2, height], "sides": [[4, 0, 0], [0, 3, 0]], "tension": 50}
    travel = {"speed": 2.0, "path": [[0.5, 1.0], [3.5, 1.0]], "at_end": "stay"}
    net = ropewalk.Scenario.model_validate({
        "nets": {"n": {**sheet, "axial_stiffness": 1e4, "mass": 0.1}},
        "loads": {"m": {"kind": "mass", "on": "n", "mass": 5.0, "travel": travel}},
        "run": {"kind": "dynamic", "until": 0.3},
    })  # fmt: skip
    line = string({"m": MovingMass(on="rope", mass=5.0, travel={"speed": 2.0})}, start=(0, height), end=(20, height))
    one, two = alone(net, "m"), alone(line, "m")
    assert one.touches[0].base == height
    assert one.touches == two.touches
    for name in ("mass", "damping", "stiffness", "spread", "push", "place"):
        assert getattr(one, name) == pytest.approx(getattr(two, name)), name


def test_what_cannot_be_exported_is_refused(tmp_path):
    force = ropewalk.MovingForce(on="rope", force=(0, -1), travel={"speed": 1.0, "from": 3.0})
    scenario = string({"f": force, "m": MovingMass(on="rope", mass=5.0, travel=TRAVEL)})
    with pytest.raises(RopewalkError, match="is only a force"):
        export(scenario, "f", tmp_path / "a.fmu")
    with pytest.raises(RopewalkError, match="give contact_stiffness"):
        export(scenario, "m", tmp_path / "a.fmu", causality="force")
    with pytest.raises(ScenarioError, match="did you mean rope"):
        export(scenario, "Rope", tmp_path / "a.fmu")
    with pytest.raises(ScenarioError, match="the folder does not exist"):
        export(scenario, "rope", tmp_path / "nowhere" / "a.fmu")
    with pytest.raises(ScenarioError, match=r"must end in \.fmu"):
        export(scenario, "rope", tmp_path / "a.zip")
    with pytest.raises(ScenarioError, match="write kind: dynamic"):
        export(scenario.model_copy(update={"run": ropewalk.model.Equilibrium()}), "rope", tmp_path / "a.fmu")
    assert not list(tmp_path.iterdir())


def test_writing_leaves_nothing_behind(tmp_path, files):
    import sys

    before = list(sys.path), set(sys.modules)
    export(string({"b": body()}), "b", tmp_path / "my vehicle 2.fmu")
    assert list(sys.path) == before[0]
    assert not [name for name in set(sys.modules) - before[1] if name.startswith("slave_")]
    assert [file.name for file in tmp_path.iterdir()] == ["my vehicle 2.fmu"]
    with zipfile.ZipFile(tmp_path / "my vehicle 2.fmu") as archive:
        assert {"resources/about.json", "resources/vehicle.json"} <= set(archive.namelist())
    assert validate_fmu(str(tmp_path / "my vehicle 2.fmu")) == []
