"""From states of the chain to frames of the result: material nodes, tensions, contacts, reactions, energy."""

from __future__ import annotations

import numpy as np

from ropewalk.chains import many_frames as many
from ropewalk.chains.many_bodies import displayed, energies_of_loads
from ropewalk.chains.many_ends import let_yield
from ropewalk.checkpoint import Tree, copied
from ropewalk.mechanics.bodies import Bodies, are_weightless
from ropewalk.mechanics.chain import (
    CONTACT,
    DRIVE,
    FRICTION,
    HOLD_WORK,
    LINE_DAMPING,
    LOAD_DAMPING,
    LOAD_WORK,
    SUPPORT_WORK,
    Array,
    ChainState,
)
from ropewalk.results.audit import Audit
from ropewalk.results.frame import OFF_LINE, Frame, Layout, uniform
from ropewalk.results.frames import Frames
from ropewalk.solve.ends import ends_of
from ropewalk.solve.start import PreparedRun


def layout_of(setting: PreparedRun, path: str = "time") -> Layout:
    """Names and coordinates of the result of a run."""
    strands = setting.strands
    return Layout(
        axes=setting.axes,
        **uniform(setting.lines, strands.links, strands.h),
        contact_load=tuple(wheel.name for wheel in setting.wheels),
        body=tuple(body.name for body in setting.multibody_system.displayed)
        if setting.multibody_system is not None
        else (),
        support=tuple(f"{name}.{end}" for name in setting.lines for end in ("start", "end")),
        path=path,
        weight=-float((strands.rho * strands.h * strands.links).sum() * strands.gravity[-1]),
    )


_WORKS = {
    "line_damping": LINE_DAMPING, "contact_dissipation": CONTACT, "load_damping": LOAD_DAMPING, "friction": FRICTION,
    "load_work": LOAD_WORK, "hold_work": HOLD_WORK, "support_work": SUPPORT_WORK, "drive_work": DRIVE,
}  # fmt: skip


class ChainFrameBuilder:
    """Builds frames of a motion; the energy at the first one is the origin of the audit."""

    def __init__(self, setting: PreparedRun, bodies: Bodies | None = None) -> None:
        self.setting, self.bodies = setting, bodies
        self._weightless = bodies is not None and are_weightless(bodies)
        self.together = not self._weightless  # whether frames of many instants are built at once
        self._audit = Audit()
        self._work: Array | None = None  # at the first frame, J
        self._restrained: tuple[float, Array] = (0.0, np.zeros(setting.xi.size))

    def get_state(self) -> Tree:
        """The origin of the audit, and when hold forces were looked at last."""
        return copied({"audit": self._audit.get_state(), "work": self._work, "held": self._restrained})

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._audit.set_state(tree["audit"])
        self._work, (since, impulse) = copied(tree["work"]), tree["held"]
        self._restrained = since, impulse.copy()

    def build(self, state: ChainState) -> Frame:
        """The frame of the present state."""
        return self.build_many(many.ManyStates.now(state, self.bodies))[0]

    def build_many(self, states: many.ManyStates) -> Frames:
        """The frames of some states that follow one another, see `many_frames.py`."""
        setting = self.setting
        links, (r, w) = many.ManyLinks.of(setting, states), many.material_nodes(setting, states)
        since, impulse = np.append(self._restrained[0], states.t), np.vstack([self._restrained[1], states.hold])
        step, pushed = np.diff(since)[:, None], np.diff(impulse, axis=0)
        mean_hold = np.where(step > 0.0, pushed / np.where(step > 0.0, step, 1.0), 0.0)
        self._restrained = float(since[-1]), impulse[-1].copy()
        self._work = states.work[0].copy() if self._work is None else self._work
        works = {form: states.work[:, at] - self._work[at] for form, at in _WORKS.items()}
        reaction = many.reactions(setting, links)
        seen = many.contacts(setting, states, links, mean_hold, reaction, self._weightless)
        if (ends := ends_of(setting.strands, setting.supports)) is not None:
            let_yield(setting, ends, states.t, states.X, states.r, states.w, reaction)
        beside, of_loads = (np.zeros((states.t.size, 0, r.shape[1])),) * 2, dict[str, Array]()
        if states.bodies is not None:
            beside = displayed(setting, states.r, states.bodies, seen.state != OFF_LINE)
            of_loads = energies_of_loads(setting, states.bodies)
        energy = self._audit.of(**many.energies_of_lines(setting, states, links.elastic, w), **of_loads, **works)
        return Frames(
            states.t,
            {
                "position": r.swapaxes(1, 2), "velocity": w.swapaxes(1, 2),
                "tension": many.links_only(setting, links.T), "strain": many.links_only(setting, links.eps),
                **seen.fields(), "body_position": beside[0], "body_velocity": beside[1], "reaction": reaction,
                "energy": energy,
            },
        )  # fmt: skip
