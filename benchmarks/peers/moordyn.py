"""MoorDyn (C++): one `Line` of n segments between two fixed points, explicit schemes with fixed steps.

MoorDyn has no load that travels along a line and no call that sets the force on a node of a line. It does
have externally set water kinematics, and Morison's inertia force on node i is ``rho_water V_i a_i`` when
added mass and drag are zero. So the rope hangs 100 m below the surface of a nearly weightless "water" and the
acceleration of this water at the two nodes beside the load is set to give the wanted forces exactly; gravity
is raised by the buoyancy (1e-9 of the weight). The force is held over a step at its value in the middle of
the step, because that is what the interface offers: second order in the step, whatever the scheme.

Two more things a reader of the table must know. A MoorDyn line cannot push: its chain is tension-only, so its
error is measured against a tension-only reference; the undamped rope goes slack again and again, and there no
two codes agree closely. And it starts from MoorDyn's own elastic catenary, 2e-5 m from the rest shape of 200
links. CPU seconds include setting the forces from Python.
"""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

from .interface import Failed, Setting, missing, rows_by_step, silent, steps_per_passage
from .problem import Array, Rope

name = "MoorDyn"
distribution = "moordyn"

# steps that divide the time from node to node for 100, 200, 400 and 800 links
settings = (
    *(Setting("RK4", size, "step", True) for size in (2.5e-4, 1.25e-4, 6.25e-5, 2.5e-5, 1.25e-5)),
    *(Setting("RK2", size, "step", True) for size in (6.25e-5, 2.5e-5, 1.25e-5)),
)

_DEPTH = 100.0  # m, of the rope below the surface, so that every node is wet
_WATER = 1e-9  # kg/m: mass of the water displaced by a metre of rope

_INPUT = """MoorDyn input file
---------------------- LINE TYPES --------------------------------------------------------
TypeName  Diam  Mass/m  EA  BA/-zeta  EI  Cd  Ca  CdAx  CaAx
(name)  (m)  (kg/m)  (N)  (N-s/-)  (N-m^2)  (-)  (-)  (-)  (-)
rope  {diameter!r}  {mass!r}  {stiffness!r}  {damping!r}  0  0  0  0  0
---------------------- POINTS ------------------------------------------------------------
ID  Type  X  Y  Z  M  V  CdA  CA
(#)  (-)  (m)  (m)  (m)  (kg)  (m^3)  (m^2)  (-)
1  Fixed  0  0  {z!r}  0  0  0  0
2  Fixed  {span!r}  0  {z!r}  0  0  0  0
---------------------- LINES -------------------------------------------------------------
ID  LineType  AttachA  AttachB  UnstrLen  NumSegs  Outputs
(#)  (name)  (#)  (#)  (m)  (-)  (-)
1  rope  1  2  {length!r}  {n}  -
---------------------- OPTIONS -----------------------------------------------------------
0  writeLog
1  disableOutput
1  WaveKin
0  Currents
0  TmaxIC
0  kBot
0  cBot
{step!r}  dtM
{scheme}  tScheme
{water!r}  WtrDnsty
{depth!r}  WtrDpth
{gravity!r}  g
---------------------- END ---------------------------------------------------------------
"""


def available() -> str | None:
    """None if MoorDyn can be used, else the reason."""
    return missing("moordyn", distribution)


def suits(rope: Rope, setting: Setting) -> str | None:
    """None, or that the step is above the scheme's limit for the links' axial vibration and damping."""
    highest = 2 / rope.h * math.sqrt(rope.stiffness / rope.mass)
    decay = 4 * rope.damping / (rope.mass * rope.h**2)
    if setting.method == "RK2" and not decay:
        return "unstable: RK2 blows up any undamped vibration"
    edge = 2.0 if setting.method == "RK2" else 2.8
    limit = min(2.8 / highest, edge / decay if decay else math.inf)
    return f"unstable: the step is above {limit:.1e} s" if setting.size > 1.2 * limit else None


def chain(rope: Rope) -> Rope:
    """MoorDyn's line is slack when shortened."""
    return replace(rope, tension_only=True)


def run(rope: Rope, times: Array, setting: Setting) -> tuple[Array, float]:
    """Positions at ``times`` and the CPU seconds of stepping, the nodal forces and the reading of positions
    included.
    """
    import moordyn

    count = steps_per_passage(rope, setting.size)
    step = rope.passage / count
    wanted = rows_by_step(times, step)
    text = _INPUT.format(
        diameter=math.sqrt(4 / math.pi),  # one square metre, so that densities are masses per metre
        mass=float(rope.mass),
        stiffness=float(rope.stiffness),
        damping=float(rope.damping),
        z=-_DEPTH,
        span=float(rope.span),
        length=float(rope.length),
        n=rope.n,
        step=step,
        scheme=setting.method,
        water=_WATER,
        depth=2 * _DEPTH,
        gravity=rope.gravity / (1 - _WATER / rope.mass),
    )
    positions = np.empty((len(times), rope.n + 1, 2))
    with TemporaryDirectory() as folder:
        path = Path(folder) / "rope.txt"
        path.write_text(text)
        with silent():
            system = moordyn.Create(os.fspath(path))
            moordyn.SetVerbosity(system, moordyn.LEVEL_NONE)
            failed = moordyn.Init(system, [], [])
        try:
            if failed:
                raise Failed("MoorDyn could not initialise the line")
            line = moordyn.GetLine(system, 1)
            nodes = range(rope.n + 1)
            moordyn.ExternalWaveKinInit(system)
            points = moordyn.ExternalWaveKinGetCoordinates(system)  # the nodes of the line come first
            still = [[0.0, 0.0, 0.0] for _ in points]
            water = [[0.0, 0.0, 0.0] for _ in points]
            unit = rope.force / (_WATER * rope.h)
            begin = process_time()
            for index in range(max(wanted) + 1):
                row = wanted.get(index)
                if row is not None:
                    positions[row] = np.array([moordyn.GetLineNodePos(line, i) for i in nodes])[:, ::2]
                time = times[0] + index * step
                place = rope.speed * (time + step / 2) / rope.h
                node = int(place)
                if node < rope.n:
                    water[node][2], water[node + 1][2] = (node + 1 - place) * unit, (place - node) * unit
                moordyn.ExternalWaveKinSet(system, still, water, time)
                moordyn.Step(system, [], [], time, step)
                if node < rope.n:
                    water[node][2] = water[node + 1][2] = 0.0
            seconds = process_time() - begin
        except RuntimeError as error:
            raise Failed(str(error).strip().splitlines()[0][:100]) from error
        finally:
            moordyn.Close(system)
    positions[:, :, 1] += _DEPTH
    if not np.isfinite(positions).all():
        raise Failed("the motion is not finite")
    return positions, seconds
