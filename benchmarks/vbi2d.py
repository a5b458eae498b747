"""Beside VBI-2D (Cantero 2022, GPL), which runs in GNU Octave, on the bridge of examples/vehicle-on-rough-bridge.yaml.

    python -m benchmarks.vbi2d FOLDER [OCTAVE]

FOLDER is a copy of DanielCanteroNTNU/VBI-2D. Both programs get the same lorry, bridge and road, which rises from level
ground so that both begin at rest; errors are against VBI-2D with 40 elements and 4000 steps a second.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy.io
from numpy.typing import NDArray

from ropewalk.mechanics.profile_spectra import profile_of
from ropewalk.model.scenario import Scenario
from ropewalk.scenario import load
from ropewalk.simulate import simulate

Array = NDArray[np.float64]
EXAMPLE = Path(__file__).parents[1] / "examples" / "vehicle-on-rough-bridge.yaml"
LEVEL, RISEN, STEP = -19.0, -10.0, 0.01  # m: the road is level up to here, as rough as it is from there on; its rows

_DRIVER = """
cd('{folder}'); addpath('{folder}'); addpath('{folder}/Functions');
Veh(1).Model.type='Vehicle_2'; Veh(1).Prop.mBi=10500; Veh(1).Prop.IBi=50000; Veh(1).Prop.kSj=[1,1]*6e5;
Veh(1).Prop.cSj=[1,1]*1e4; Veh(1).Prop.mGj=[1,1]*900; Veh(1).Prop.kTk=[1,1]*1.75e6; Veh(1).Prop.cTk=[0,0];
Veh(1).Prop.dj=[-2.5,2.5]; Veh(1).Pos.x0=-20; Veh(1).Pos.vel=25;
Beam.Prop.type=0; Beam.Prop.Lb=25; Beam.Prop.rho=18358; Beam.Prop.E=48.65e9; Beam.Prop.I=1; Beam.Prop.A=1;
Beam.Prop.damp_per=0; Beam.BC.loc=[0,25]; Beam.BC.vert_stiff=[Inf,Inf]; Beam.BC.rot_stiff=[0,0];
Beam.Mesh.Ele.num={elements};
Calc.Profile.type=1; Calc.Profile.Load.path='{work}/'; Calc.Profile.Load.file_name='road.mat';
Calc.Solver.max_accurate_frq={frequency}; Calc.Opt.verbose=0; Calc.Opt.show_progress_every_s=1000; Calc.Plot.NoPlot=1;
begun=cputime;
[Calc,Veh,Beam]=B07_OptionsProcessing(Calc,Veh,Beam); Beam=B51_BeamProperties(Beam);
Beam=B01_ElementsAndCoordinates(Beam); Beam=B02_BeamBoundaryConditions(Beam); Beam=B22_DamageBeamElements(Beam);
Beam=B03_Beam_Matrices(Beam); Beam=B09_BeamFrq(Calc,Beam); Beam=B24_Beam_Damping(Beam); Veh=B45_VehicleModel(Calc,Veh);
[Calc,Veh]=B08_VehFreq(Calc,Veh); [Calc,Veh]=B43_ModelGeometry(Calc,Veh,Beam); Calc=B42_TimeStep(Calc,Veh,Beam);
[Calc,Veh]=B11_TimeSpace_discretization(Calc,Veh,Beam); Calc=B40_Profile(Calc); Veh=B25_WheelProfiles(Calc,Veh);
Sol=B49_Coup_solver(Calc,Veh,Beam); [Calc,Sol]=B50_ContactForce(Calc,Veh,Beam,Sol);
cpu=cputime-begun; t=Calc.Solver.t; deck=Sol.Beam.U.value_DOFt; force=Sol.Veh(1).Under.onBeamF;
clear Calc Veh Beam Sol
save('-v7', '{work}/out.mat');
"""


class Crossing(NamedTuple):
    """What a program gives: of the time on the bridge."""

    t: Array  # s
    middle: Array  # m, up
    force: Array  # (instant, wheel) N, rear and front, down
    cpu: float  # s


def _road(rough: bool) -> tuple[Array, Array]:
    """Places and heights, m."""
    x = STEP * np.arange(-10000, 10001)
    s, z = profile_of("ISO 8608 B", 1, (0.5, 50.0), -101.0, 101.0)
    part = np.clip((x - LEVEL) / (RISEN - LEVEL), 0.0, 1.0)
    return x, float(rough) * part**2 * (3.0 - 2.0 * part) * np.interp(x, s, z)


def of_vbi2d(folder: Path, octave: str, rough: bool, elements: int, frequency: int) -> Crossing:
    """A crossing by VBI-2D with steps of a half of 1/frequency."""
    x, z = _road(rough)
    with tempfile.TemporaryDirectory() as work:
        road: dict[str, Any] = {
            "dx": STEP, "L": 200.0, "x": x[None, :], "num_x": float(x.size), "h": z[None, :],
            "Spatial_frq": {"min": 0.02, "max": 2.0, "ref": 0.1},
        }  # fmt: skip
        scipy.io.savemat(f"{work}/road.mat", {"Profile": road})
        driver = _DRIVER.format(folder=folder.resolve(), work=work, elements=elements, frequency=frequency)
        (Path(work) / "driver.m").write_text(driver)
        subprocess.run([octave, "-q", f"{work}/driver.m"], check=False, capture_output=True)
        found = scipy.io.loadmat(f"{work}/out.mat")
    deck, force = found["deck"], found["force"]
    t = found["t"][0][-deck.shape[1] :]
    return Crossing(t, deck[2 * (elements // 2)], -force[::-1, -t.size :].T, float(found["cpu"][0, 0]))


def of_ropewalk(rough: bool, elements: int, kind: str) -> Crossing:
    """A crossing by ropewalk, its kernels compiled."""
    with tempfile.TemporaryDirectory() as work:
        x, z = _road(rough)
        within = slice(6000, 14001, 5)
        np.savetxt(f"{work}/road.csv", np.stack([x[within], z[within]], axis=1), delimiter=",")
        tree = load(EXAMPLE, [f"lines.bridge.elements={elements}"]).model_dump(by_alias=True)
        tree["lines"]["bridge"]["profile"] = {"file": f"{work}/road.csv"}
        if kind == "linear":
            tree["run"] = {"kind": "linear", "until": 2.0, "every": 0.002}
        scenario = Scenario.model_validate(tree)
        simulate(scenario)
        begun = time.process_time()
        found = simulate(scenario)
        cpu = time.process_time() - begun
    middle = found["position"].to_numpy()[:, elements // 2, 1]
    return Crossing(found["time"].to_numpy(), middle, -found["contact_force"].to_numpy()[:, :, 1], cpu)


def _differ(one: Crossing, other: Crossing) -> tuple[float, float, float]:
    """Differences of the largest deflection, of midspan at all times, and of contact forces, over the largest ones."""
    middle = np.interp(other.t, one.t, one.middle)
    size = np.abs(other.middle).max()
    forces = 0.0
    for k, start in enumerate((-25.0, -20.0)):
        x = start + 25.0 * other.t
        within, known = (x > 0.5) & (x < 24.5), np.isfinite(one.force[:, k])
        mine = np.interp(other.t, one.t[known], one.force[known, k])
        forces = max(forces, float(np.abs(mine - other.force[:, k])[within].max() / other.force[within, k].max()))
    return abs(one.middle.min() / other.middle.min() - 1.0), float(np.abs(middle - other.middle).max() / size), forces


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("octave", nargs="?", default="octave-cli")
    asked = parser.parse_args()
    for rough in (False, True):
        best = of_vbi2d(asked.folder, asked.octave, rough, 40, 2000)
        print(f"{'rough' if rough else 'smooth'}: deflection {1e3 * best.middle.min():.5f} mm, {best.cpu:.2f} s")
        rows = list[tuple[str, Crossing]]()
        for f in (250, 500):
            rows.append((f"VBI-2D, 20 elements, {f} Hz", of_vbi2d(asked.folder, asked.octave, rough, 20, f)))
        rows += [(f"ropewalk, {n} links, {kind}", of_ropewalk(rough, n, kind)) for kind, n in
                 (("dynamic", 20), ("dynamic", 40), ("dynamic", 60), ("linear", 20))]  # fmt: skip
        for name, one in rows:
            largest, history, force = _differ(one, best)
            print(f"  {name:32} {largest:.1e} {history:.1e} {force:.1e}  {one.cpu:.2f} s")


if __name__ == "__main__":
    main()
