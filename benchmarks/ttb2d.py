"""Beside TTB-2D (Cantero 2022, GPL), which runs in GNU Octave, on the bridge of examples/bridge-ballasted-track.yaml.

    python -m benchmarks.ttb2d FOLDER [OCTAVE]

FOLDER is a copy of DanielCanteroNTNU/TTB-2D. Both programs get the same coach, bridge and track, which is smooth, or
rough beyond a level stretch on which both begin at rest. Nothing but the track damps the bridge: Rayleigh damping, that
of TTB-2D, is not there for beams under tracks. Errors are against TTB-2D with four elements between sleepers and 4000
steps a second. Its contact forces get the inertia of wheels over the irregularity, which it applies, but does not tell.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy.io
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from ropewalk.mechanics.profile_spectra import profile_of
from ropewalk.scenario import load
from ropewalk.simulate import simulate

Array = NDArray[np.float64]
EXAMPLE = Path(__file__).parents[1] / "examples" / "bridge-ballasted-track.yaml"
RAIL, FIRST, SPEED = 165.6, 27.6, 50.0  # m of rail, where the first axle begins along it, m/s
BRIDGE = (51.6, 102.0)  # m along the rail
LEVEL, RISEN, STEP = 29.0, 45.0, 0.01  # m: the rail is level up to here, as rough as it is from there on; its rows
BEHIND = (0.0, 2.56, 19.0, 21.56)  # m, axles

_DRIVER = """
addpath('{folder}'); Train.vel={speed}; veh_num=1; TrainProp_Manchester_BenchMark; Train.Veh(1).vel=Train.vel;
TrackProp_Zhai_et_al_WithBallastOnBridge; Track.Rail.Damping.per=0;
Beam.Prop.L=50.4; Beam.Prop.E=35e9; Beam.Prop.I=51.3; Beam.Prop.rho=69000; Beam.Damping.per=0; Beam.BC.text='SP';
Beam.Mesh.Ele.num_per_spacing={elements}; Track.Rail.Mesh.Ele.num_per_spacing={elements};
Calc.Profile.Type=0; Calc.Profile.minL_Approach=30; Calc.Profile.minL_After=30;
Calc.Solver.max_accurate_frq={frequency}; Calc.Plot.NoPlot=1;
Calc.Options.VBI=1; Calc.Options.redux=0; Calc.Options.calc_beam_modes=0; Calc.Options.calc_beam_sections=[];
Calc.Options.disp_every_t=1; Calc.Options.disp_every=1e9;
road=load('{work}/road.mat'); begun=cputime;
[Calc,Train,Beam]=B43_ModelGeometry(Calc,Train,Track,Beam);
[Calc,Train,Track,Beam]=B07_OptionsProcessing(Calc,Train,Track,Beam);
Beam=B01_ElementsAndCoordinates(Beam,Calc); Beam=B02_BoundaryConditions(Beam); Beam=B03_BeamMatrices(Beam);
Beam=B09_BeamFrq(Beam,Calc); Beam=B24_BeamDamping(Beam); Track=B51_RailVariables(Track,Calc);
Track.Rail=B02_BoundaryConditions(B01_ElementsAndCoordinates(Track.Rail)); Track.Rail.BC.DOF_fixed=zeros(1,0);
Track.Rail=B03_BeamMatrices(Track.Rail); Track.Rail.Mesh.Cg=Track.Rail.Mesh.Kg*0;
Model=B55_ModelBC(B54_ModelMatrices(Beam,Track,Calc),Beam,Track);
Train.Veh=B08_VehFreq(B18_TrainVehEq(Train.Veh),Calc); Calc=B11_TimeSpaceDiscretization(B10_EndTime(Calc));
Train.Veh=B47_VehStaticLoads(Train.Veh,Calc); Calc=B19_GenerateProfile(Calc);
Calc.Profile.h=interp1(road.x,road.z,Calc.Profile.x,'spline'); Calc=B25_WheelProfiles(Calc,Train.Veh);
Calc=B50_ElementNumOfForce(Track.Rail,Calc); Sol=B64_Coupled_InitialStatic(Train.Veh,Model,Calc,Track);
Sol=B65_DynamicCalcCoupledFaster(Train.Veh,Model,Calc,Track,Sol); Sol=B66_ContactForce(Sol,Track,Calc,Train);
Sol=B49_BeamDeformation(Sol,Model,Beam,Calc,Train,1);
cpu=cputime-begun; t=Calc.Solver.t; deck=Sol.Beam.U.xt((end+1)/2,:);
force=Sol.Veh(1).F_onBeam-1813*Calc.Veh(1).hdd_path;
save('-v7','{work}/out.mat','t','deck','force','cpu');
"""


class Crossing(NamedTuple):
    """What a program gives."""

    t: Array  # s
    middle: Array  # m, up, from the first instant on
    force: Array  # (instant, wheel) N, down
    cpu: float  # s


def _rough() -> tuple[Array, Array]:
    """Places along the rail and heights, m: smooth, for TTB-2D takes differences of theirs for accelerations."""
    x = STEP * np.arange(round(RAIL / STEP) + 1)
    s, z = profile_of("FRA 6", 1, (3.0, 25.0), 0.0, RAIL)
    part = np.clip((x - LEVEL) / (RISEN - LEVEL), 0.0, 1.0)
    return x, part**2 * (3.0 - 2.0 * part) * CubicSpline(s, z)(x)


def of_ttb2d(folder: Path, octave: str, rough: bool, elements: int, frequency: int) -> Crossing:
    """A crossing by TTB-2D with steps of a half of 1/frequency."""
    x, z = _rough()
    with tempfile.TemporaryDirectory() as work:
        scipy.io.savemat(f"{work}/road.mat", {"x": x, "z": float(rough) * z})
        driver = _DRIVER.format(folder=folder.resolve(), work=work, elements=elements, frequency=frequency, speed=SPEED)
        (Path(work) / "driver.m").write_text(driver)
        subprocess.run([octave, "-q", f"{work}/driver.m"], check=False, capture_output=True)
        found = scipy.io.loadmat(f"{work}/out.mat")
    middle = found["deck"][0]
    return Crossing(found["t"][0], middle - middle[0], -found["force"].T, float(found["cpu"][0, 0]))


def of_ropewalk(rough: bool, rail: int, deck: int) -> Crossing:
    """A crossing by ropewalk with some links of rail and bridge, its kernels compiled."""
    with tempfile.TemporaryDirectory() as work:
        more = [f"lines.rail.elements={rail}", f"lines.deck.elements={deck}", "run.every=1 ms"]
        if rough:
            x, z = _rough()
            np.savetxt(f"{work}/road.csv", np.stack([x[::10], z[::10]], axis=1), delimiter=",")
            more.append(f"lines.rail.profile={{file: {work}/road.csv}}")
        scenario = load(EXAMPLE, more)
        simulate(load(EXAMPLE, [*more, "run.until=10 ms"]))
        begun = time.process_time()
        found = simulate(scenario)
        cpu = time.process_time() - begun
    line, z = found["line"].to_numpy(), found["position"].to_numpy()[:, :, 1]
    middle = z[:, line == "deck"][:, deck // 2]
    force = -found["contact_force"].to_numpy()[:, :, 1]
    return Crossing(found["time"].to_numpy(), middle - middle[0], force, cpu)


def differ(one: Crossing, other: Crossing) -> tuple[float, float, float, float]:
    """Differences of the largest deflection, of midspan at all times, and of contact forces, over the largest ones.

    Contact forces are those on the bridge, their largest difference and its root mean square.
    """
    middle, size = np.interp(other.t, one.t, one.middle), np.abs(other.middle).max()
    away = list[Array]()
    for k, behind in enumerate(BEHIND):
        x = FIRST - behind + SPEED * other.t
        within = (x > BRIDGE[0]) & (x < BRIDGE[1])
        away.append((np.interp(other.t, one.t, one.force[:, k]) - other.force[:, k])[within] / other.force.max())
    both = np.concatenate(away)
    return (
        abs(one.middle.min() / other.middle.min() - 1.0), float(np.abs(middle - other.middle).max() / size),
        float(np.abs(both).max()), float(np.sqrt((both**2).mean())),
    )  # fmt: skip


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("octave", nargs="?", default="octave-cli")
    asked = parser.parse_args()
    for rough in (False, True):
        best = of_ttb2d(asked.folder, asked.octave, rough, 4, 2000)
        print(f"{'rough' if rough else 'smooth'}: deflection {1e3 * best.middle.min():.5f} mm, {best.cpu:.1f} s")
        rows = [(f"TTB-2D, {n} elements, {2 * f}/s", of_ttb2d(asked.folder, asked.octave, rough, n, f))
                for n, f in ((1, 500), (2, 500), (2, 1000))]  # fmt: skip
        rows += [(f"ropewalk, {n} and {m} links", of_ropewalk(rough, n, m)) for n, m in ((276, 28), (552, 28))]
        for name, one in rows:
            largest, history, force, mean = differ(one, best)
            print(f"  {name:32} {largest:.1e} {history:.1e} {force:.1e} {mean:.1e}  {one.cpu:.2f} s", flush=True)


if __name__ == "__main__":
    main()
