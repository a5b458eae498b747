"""The energy residual of a run: its size compared with the energy throughput, its trend, and its cause."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ropewalk.model.load import Rolling
from ropewalk.results.attachments import AttachmentWatch
from ropewalk.results.audit import AUDIT, rounding, turnover
from ropewalk.results.frame import ENERGY_FORMS, OFF_LINE, Array, Doubt, Layout, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

if TYPE_CHECKING:
    from ropewalk.model import Scenario

RESIDUAL = "Energy residual"  # how its doubts and warnings begin
AUDITED = ENERGY_FORMS.index(AUDIT)
NOTABLE, LARGE = 0.01, 0.05  # of the energy throughput: a residual beyond is a warning, or a doubt
FAST = 0.8  # of the speed of transverse waves: forces of masses are hard to resolve beyond
SLACK = 100.0  # times the speed of waves: a line is slack there
LATE = 0.2  # of the energy exchanged in the last third of a run: a residual that grows by more makes a run doubtful
_FEW = 30  # output instants: with fewer the energy exchanged is not known
_MOSTLY = 0.5  # part of the growth of a residual that an event must coincide with to be its cause
_PUSHED = 1e-3  # part of the largest tension, from which on a compression counts
_NEAR = 0.05  # part of a line next to its ends, where contact forces of bodies grow without bound
_PEAK = 1.5  # times its median: a contact force next to an end beyond that has grown
_ONCE = 2  # changes of a contact that enters its line once and leaves it once
_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))

Booleans = NDArray[np.bool_]
Cause = tuple[str, str, str]  # cause, key and remedy of a doubt


class EnergyWatch(Watch):
    """Watches the energy residual, and what loads and lines do while it grows.

    Args:
        layout: of the frames.
        scenario: the scenario.
        attachments: bodies that cross attachments.
    """

    def __init__(self, layout: Layout, scenario: Scenario, attachments: AttachmentWatch) -> None:
        super().__init__(layout, scenario)
        self._attachments = attachments
        self._bodies = np.array([isinstance(scenario.loads.get(name), Rolling) for name in self.loads], dtype=np.bool_)
        self._slowness = np.array([self._slowness_of(name) for name in self.loads])  # (contact,) (kg/m)^(1/2)
        self._first: Array | None = None
        self._last: Array = np.zeros(0)  # forms in the frame before, J
        self._rounding = 0.0  # J
        names = "time residual throughput exchanged compression pushed speed fastest xi on force"
        self._of = {name: array("d") for name in names.split()}

    def _slowness_of(self, name: str) -> float:
        """Return the root of the mass of the line below a load, which gives the speed of its waves; 0: no such line."""
        load = self.scenario.loads.get(name)
        line = self.scenario.lines.get(load.on) if load is not None else None
        return 0.0 if line is None or line.has_bending_stiffness else float(np.sqrt(line.mass))

    def _in_waves(self, of: Mapping[str, Array]) -> Array:
        """Return speeds of contacts over those of transverse waves in the looser part next to them; 0: unknown."""
        pull, speed = of["contact_tension"].min(axis=2), np.abs(of["contact_speed"])
        known = np.isfinite(pull) & (speed > 0.0)
        return np.where(known, speed * self._slowness / np.sqrt(np.where(known, np.maximum(pull, 1e-300), 1.0)), 0.0)

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        of, energy, speed = frames.of, frames.of["energy"], self._in_waves(frames.of)
        if self._first is None:
            self._first = self._last = energy[0].copy()
        pull = np.nan_to_num(of["tension"])
        contacts = speed.shape[1] > 0
        speed = np.where((speed > SLACK) & ~self._bodies, 0.0, speed)  # without mass nothing grows on a slack line
        self._rounding = max(self._rounding, rounding(self.scenario, energy))
        forms = np.delete(np.concatenate([self._last[None], energy]), AUDITED, axis=1)
        found = {
            "time": frames.path,
            "residual": np.abs(energy[:, AUDITED]),
            "throughput": turnover(energy, self._first),
            "exchanged": 0.5 * np.nansum(np.abs(np.diff(forms, axis=0)), axis=1),
            "compression": -pull.min(axis=1, initial=0.0) / np.maximum(np.abs(pull).max(axis=1, initial=0.0), 1e-300),
            "pushed": pull.argmin(axis=1) if pull.shape[1] else np.zeros(len(frames)),
            "speed": speed.max(axis=1, initial=0.0),
            "fastest": speed.argmax(axis=1) if contacts else np.zeros(len(frames)),
            "xi": of["contact_xi"],
            "on": of["contact_state"] != OFF_LINE,
            "force": np.linalg.norm(of["contact_force"], axis=2),
        }  # fmt: skip
        for name, values in found.items():
            self._of[name].frombytes(np.ascontiguousarray(values, dtype=np.float64).tobytes())
        self._last = energy[-1].copy()

    def xi(self, k: int) -> Array:
        """Return the coordinates of contact `k` at the output instants, m."""
        return np.array(self._of["xi"]).reshape(-1, len(self.loads))[:, k]

    def doubts(self, run_info: RunInfo) -> Iterator[Doubt]:
        """Yield a doubt if the residual is a large part of the energy throughput, or grows to the end."""
        yield from (found for found, is_large in self._findings(run_info) if is_large)

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """Yield a warning if the residual is a notable part of the energy throughput."""
        yield from (str(found) for found, is_large in self._findings(run_info) if not is_large)

    def _findings(self, run_info: RunInfo) -> Iterator[tuple[Doubt, bool]]:
        """Yield the fault of the audit, if there is one, and whether it makes the run doubtful."""
        if self.layout.path != "time" or run_info.audit or len(self._of["time"]) < 2:
            return
        of = {name: np.array(values) for name, values in self._of.items()}
        for name in ("xi", "on", "force"):
            of[name] = of[name].reshape(of["time"].size, len(self.loads))
        residual, scale = of["residual"], float(of["throughput"].max())
        if not np.isfinite(residual).all():
            remedy = "check forces and deflections by another calculation"
            yield Doubt("no energy audit was kept", "it is not implemented for this combination", "run", remedy), True
            return
        worst = int(residual.argmax())
        size = float(residual[worst])
        if size <= max(NOTABLE * scale, self._rounding):
            return
        share = f"{_percent(size / scale)} of the energy throughput {amount(scale)}" if scale else "no throughput"
        growing = late_growth(residual, of["exchanged"], NOTABLE * scale)
        what = f"{RESIDUAL} {amount(size)} at t = {of['time'][worst]:.4g} s ({share})"
        if growing > LARGE:
            what += f", growing by {_percent(growing)} of the energy exchanged in the last third of the run"
        yield Doubt(what, *self._cause(of, worst, run_info)), size > LARGE * scale or growing > LATE

    def _cause(self, of: dict[str, Array], worst: int, run_info: RunInfo) -> Cause:
        """The event that most of the growth of the residual coincides with, the key to blame, and the remedy."""
        growth = np.maximum(np.diff(of["residual"][: worst + 1], prepend=0.0), 0.0)
        known = np.flatnonzero(growth > 0.0)
        shares = np.cumsum(growth[known]) / growth[known].sum()
        begin, end = (int(known[min(int(i), known.size - 1)]) for i in np.searchsorted(shares, (0.1, 0.9)))
        when = f"between t = {of['time'][max(begin - 1, 0)]:.4g} and {of['time'][end]:.4g} s"

        def mostly(happens: Booleans) -> bool:
            """Whether most of the growth is in frames in which something happens, or in the next."""
            either = happens | np.concatenate([happens[:1], happens[:-1]])
            return bool(growth[either[: worst + 1]].sum() > _MOSTLY * growth.sum())

        for find in (self._crossing, self._near_an_end, self._leaving, self._faster_than_waves, self._pushing):
            if (cause := find(of, mostly, when)) is not None:
                return cause
        step = run_info.step if run_info.method != "implicit" else float("nan")  # that chooses its steps itself
        finer = f"run.step: {0.5 * step:.3g} s (half of its value)" if step > 0.0 else "run.step"
        smaller, more, but = f"a smaller {finer}", "more elements", "; if the residual does not fall, write "
        given = getattr(self.scenario.run, "step", None) is not None  # else the step follows from the accuracy
        remedy = "write " + (smaller + but + more if given else more + but + smaller)
        return f"not identified, the residual grows {when}", "run.step" if given else "lines", remedy

    def _since(self, of: dict[str, Array]) -> float:
        """Time from which on the residual counts, s."""
        counts = of["residual"] > NOTABLE * float(of["throughput"].max())
        return float(of["time"][max(int(counts.argmax()) - 1, 0)])

    def _crossing(self, of: dict[str, Array], mostly: Callable[[Booleans], bool], when: str) -> Cause | None:
        for k, name in enumerate(self.loads):
            if mostly(self._attachments.blamed(k, of["xi"][:, k])):
                load = self.scenario.loads[name]
                text = f"load {self.layout.contact_load[k]} is located at an attachment of line {load.on} {when}"
                return text, f"loads.{name}.travel", self._attachments.remedy_for(k)
        return None

    def _near_an_end(self, of: dict[str, Array], mostly: Callable[[Booleans], bool], when: str) -> Cause | None:
        """A body whose contact force grows next to an end of its line."""
        for k, name in enumerate(self.loads):
            load = self.scenario.loads.get(name)
            line = None if load is None else self.scenario.lines.get(load.on)
            if line is None or line.has_bending_stiffness or not isinstance(load, Rolling):
                continue
            own = self.layout.link_xi[[one == load.on for one in self.layout.link_line]]
            xi, force = of["xi"][:, k], np.nan_to_num(of["force"][:, k])
            pressing, length = force[force > 0.0], float(own.max() + own.min())
            away = np.where(of["on"][:, k] > 0.0, np.minimum(xi, length - xi), length)
            approaches = np.diff(away, prepend=away[0]) < 0.0
            reach = _NEAR * length
            typical = float(np.median(pressing)) if pressing.size else np.inf
            if not mostly(approaches & (away < reach) & (force > _PEAK * typical)):
                continue
            text = f"the contact force of load {self.layout.contact_load[k]} grows next to an end of {load.on} {when}"
            remedy, last = f"end the run before t = {self._since(of):.4g} s", float(xi[away < reach][-1])
            begins = float(abs(xi[0] - (length if last > reach else 0.0)))  # m from the end that it comes to
            margin = getattr(load.travel, "margin", reach)  # trains have none
            if (margin or 0.0) < reach < begins:
                remedy = f"write a larger travel.margin, such as {reach:.3g} m, or {remedy}"
            return text, f"loads.{name}.travel", remedy
        return None

    def _leaving(self, of: dict[str, Array], mostly: Callable[[Booleans], bool], when: str) -> Cause | None:
        for k, name in enumerate(self.loads):
            on = of["on"][:, k] > 0.0
            changed = np.concatenate([[False], on[1:] != on[:-1]])
            if changed.sum() > _ONCE:
                continue  # as a foot that steps
            if mostly(changed & ~on):
                text = f"load {self.layout.contact_load[k]} leaves its line {when}"
                return text, f"loads.{name}.travel", f"end the run before t = {self._since(of):.4g} s"
        return None

    def _faster_than_waves(self, of: dict[str, Array], mostly: Callable[[Booleans], bool], when: str) -> Cause | None:
        fast = of["speed"] > FAST
        if not mostly(fast):
            return None
        i = int(of["speed"].argmax())
        k, times = int(of["fastest"][i]), float(of["speed"][i])
        name, key = self.layout.contact_load[k], f"loads.{self.loads[k]}.travel.speed"
        if getattr(getattr(self.scenario.loads.get(self.loads[k]), "travel", None), "kind", "") == "free":
            key, remedy = f"loads.{self.loads[k]}.travel", f"end the run before t = {self._since(of):.4g} s"
            more = f"{remedy}, or write more tension"
        else:
            remedy, more = "write a lower speed", "write a lower speed, or more tension"
        if times > SLACK:
            return f"the line is slack at load {name} {when}", key, remedy
        cause = f"load {name} moves at {times:.3g} times the speed of transverse waves {when}"
        return cause, key, more

    def _pushing(self, of: dict[str, Array], mostly: Callable[[Booleans], bool], when: str) -> Cause | None:
        pushed = of["compression"] > _PUSHED
        if not mostly(pushed):
            return None
        name = self.layout.link_line[int(of["pushed"][int(of["compression"].argmax())])]
        line = self.scenario.lines.get(name)
        if line is None or line.has_bending_stiffness:
            return None
        remedy = f"write more axial_damping (now {line.axial_damping:.3g} N*s), or more elements"
        return f"line {name} is in compression {when}", f"lines.{name}.axial_damping", remedy


def late_growth(residual: Array, exchanged: Array, least: float) -> float:
    """Return the growth of a residual over the last third of a run, as a part of the energy exchanged there.

    Args:
        residual: (frame,) J.
        exchanged: (frame,) J, half the sum of all changes of forms of energy since the frame before.
        least: J, a growth that counts. It must go on in both halves of the third.
    """
    n = residual.size
    first, middle = residual[2 * n // 3 :][: n // 6], residual[n - max(n // 6, 1) :]
    if n < _FEW or residual[-1] - residual[2 * n // 3] < least:
        return 0.0
    if np.median(middle) <= np.median(first) or residual[-1] < np.median(middle):
        return 0.0
    return float((residual[-1] - residual[2 * n // 3]) / max(exchanged[2 * n // 3 + 1 :].sum(), 1e-300))


def amount(energy: float) -> str:
    """Return an energy with its unit and two or three digits, as 0.92 µJ."""
    size, prefix = next(((size, prefix) for size, prefix in _PREFIXES if energy >= 0.9 * size), (0.0, ""))
    return f"{energy / size:.3g} {prefix}J" if size else f"{energy:.3g} J"


def _percent(part: float) -> str:
    return f"{100.0 * part:.2g} %" if part < 0.995 else f"{100.0 * part:.0f} %"
