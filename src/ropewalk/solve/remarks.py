"""What an engineer should know of a slow motion although it went through: each remark once, where it begins."""

from __future__ import annotations

from ropewalk.mechanics.chain import CLAMPED, COULOMB
from ropewalk.solve.quasistatic import Place
from ropewalk.solve.start import Setting

# A tension below this part of that on the other side is none.
_SLACK = 1e-6


class Remarks:
    """Watches the places of a walk."""

    def __init__(self, setting: Setting, names: tuple[str, ...]) -> None:
        self.setting, self.names = setting, names
        self._made: set[tuple[int, str]] = set()
        self._last: Place | None = None

    def on(self, place: Place) -> list[str]:
        """The remarks that are new with this place."""
        found = []
        for s, rest in enumerate(place.stands):
            first, last = float(rest.r[0, 0]), float(rest.r[0, -1])
            low, high, span = min(first, last), max(first, last), float(rest.X[-1])
            for k, load in enumerate(self.setting.on[s]):
                x, both = float(rest.r[0, rest.contact[k]]), rest.beside[k].tolist()
                if not low - 1e-9 * span <= x <= high + 1e-9 * span:
                    found.append((load, "beyond", f"hangs beyond the support, at x = {x:.4g} m"))
                least, most = min(both), max(both)
                if least <= _SLACK * most and most > 0.0:
                    side = "ahead of" if both[1] < both[0] else "behind"
                    found.append((load, "slack", f"leaves the part {side} it slack"))
                found += self._friction(int(load), float(rest.friction[k]), float(rest.hold[k]))
                if self._last is not None:
                    before = self._last.stands[s]
                    step = x - float(before.r[0, before.contact[k]])
                    along = (place.xi[load] - self._last.xi[load]) * (last - first)
                    if step * along < 0.0 and abs(step) > 1e-9 * span:
                        found.append((load, "back", f"runs back, at x = {x:.4g} m"))
        self._last = place
        new = [(int(load), kind, text) for load, kind, text in found if (int(load), kind) not in self._made]
        self._made |= {(load, kind) for load, kind, _ in new}
        return [f"from load path {place.path:.4g} m on, load {self.names[load]} {text}" for load, _, text in new]

    def _friction(self, load: int, needed: float, hold: float) -> list[tuple[int, str, str]]:
        given, kind = float(self.setting.loads.friction[load]), self.setting.loads.contact[load]
        if kind == CLAMPED and needed > given:
            text = f"needs a friction coefficient of {needed:.3g}: the {given:g} that was given does not suffice"
            return [(load, "friction", text)]
        if kind == COULOMB and hold != 0.0:
            return [(load, "friction", f"slips: friction {given:g} does not hold it, a force of {hold:.4g} N does")]
        return []
