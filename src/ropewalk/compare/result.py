"""The model hierarchy with all its simpler models: numbers, assumptions, verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ropewalk.compare.assumptions import Assumptions
from ropewalk.compare.quantities import QUANTITIES, Quantities
from ropewalk.compare.simpler_models import FULL, MODELS
from ropewalk.compare.stretches import Reach
from ropewalk.compare.trace import Difference, Trace
from ropewalk.compare.verdict import is_adequate, places, recommendation, sentence
from ropewalk.coupling import percent
from ropewalk.results.display_units import number
from ropewalk.results.extremes import Summary

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class LevelResult:
    """What came of one model."""

    name: str
    quantities: Quantities | None = None  # None: it could not be run, or coincides with another model
    errors: dict[str, float | None] = field(default_factory=dict)  # relative distance from the full model
    rms: float | None = None  # of the deflection under the load, over its largest value; of the worst wheel
    reach: dict[str, Reach] = field(default_factory=dict)  # where the local error is allowed, by wheel
    result: xr.Dataset | None = None
    traces: Mapping[str, Trace] = field(default_factory=dict)
    ways: Mapping[str, Difference] = field(default_factory=dict)
    same_as: str = ""
    remark: str = ""
    reason: str = ""  # why there is nothing, or why it broke off
    doubts: tuple[str, ...] = ()  # why what there is must not be trusted

    def as_dict(self) -> Summary:
        """Plain values that fit into JSON."""
        return {
            "quantities": self.quantities.as_dict() if self.quantities is not None else None,
            "errors": self.errors, "path_rms": self.rms,
            "reach": {wheel: reach.as_dict() for wheel, reach in self.reach.items()},
            "same_as": self.same_as or None, "remark": self.remark or None, "reason": self.reason or None,
            "doubts": list(self.doubts),
        }  # fmt: skip


@dataclass(frozen=True)
class ModelHierarchy:
    """A scenario on all simpler models."""

    title: str
    allowed: dict[str, float]  # tolerated distance of each quantity that is judged
    models: dict[str, LevelResult]
    assumptions: Assumptions

    @property
    def errors(self) -> dict[str, dict[str, float | None]]:
        """Relative distance from the full model, of each model that was run and each of QUANTITIES."""
        return {name: self.of(name).errors for name in self.models if self.of(name).errors}

    def of(self, model: str) -> LevelResult:
        """What came of a model; of one that coincides with another, of that.

        Raises:
            KeyError: there is no such model.
        """
        step = self.models[model]
        return self.of(step.same_as) if step.same_as else step

    def adequate(self, model: str) -> bool:
        """Whether all that is judged of a model is within the tolerance, it came to its end, and is not doubtful."""
        step = self.of(model)
        if step.name == FULL:
            return True
        return not step.reason and not step.doubts and is_adequate(step.errors, self.allowed)

    @property
    def verdict(self) -> str:
        """What the simpler models are good for, in words: one line for each, and which to take."""
        text = []
        for name, step in self.models.items():
            if step.doubts and not step.same_as:
                other = "its numbers and all distances from them cannot be trusted" if name == FULL else "not adequate"
                text.append(f"{name}: doubtful: {'; '.join(step.doubts)}: {other}")
            elif name == FULL and step.reason:
                text.append(f"{name}: {step.reason}")
            elif name == FULL:
                text += [f"{name}: {step.remark}"] if step.remark else []
            elif step.same_as:
                text.append(f"{name}: the same as {step.same_as}" + (f" ({step.remark})" if step.remark else ""))
            elif step.reason:
                kept = f"; until then {sentence('', step.errors, self.allowed)[2:]}" if step.errors else ""
                text.append(f"{name}: not available: {step.reason}{kept}")
            else:
                text.append(sentence(name, step.errors, self.allowed))
        if self.models[FULL].doubts:
            return "\n".join([*text, "No model can be recommended as long as the full scenario is doubtful."])
        text += places(self.assumptions.linear)
        adequate = {name: self.adequate(name) for name in self.models}
        same = {name: self.of(name).name for name in self.models}
        feedback = same.get("feedback cut") != FULL
        return "\n".join([*text, recommendation(adequate, same, feedback=feedback)])

    def table(self) -> list[tuple[str, ...]]:
        """Rows of a table, a column for each model that was run: quantities, then distances, `!` where too large."""
        displayed = [name for name in MODELS if name in self.models and self.models[name].quantities is not None]
        rows: list[tuple[str, ...]] = [("", *displayed)]
        steps = [self.models[name].quantities for name in displayed]
        for quantity, (label, unit) in _LABELS.items():
            for name in self._names(quantity):
                found = [step.values(quantity).get(name) if step is not None else None for step in steps]
                if any(value is not None for value in found) and not (quantity == "hold force" and not any(found)):
                    rows.append((f"{label} {name}, {unit}", *(number(value) for value in found)))
        for key, label in (("mean", "mean contact force of"), ("deviation", "its standard deviation,")):
            for name in self._names("contact force"):
                found = [(s.wheels.get(name, {}).get("contact_force") or {}).get(key) if s else None for s in steps]
                rows.append((f"{label} {name}, N", *(number(value) for value in found)))
        rows.append(("", *("" for _ in displayed)))
        for quantity in QUANTITIES:
            errors = [self.models[name].errors.get(quantity) for name in displayed]
            if any(error is not None for error in errors):
                mark = self.allowed.get(quantity)
                rows.append((f"distance: {_DISTANCES[quantity]}", *(_cell(error, mark) for error in errors)))
        rms = [self.models[name].rms for name in displayed]
        if any(value is not None for value in rms):
            rows.append(("distance: path, rms", *(_cell(value, None) for value in rms)))
        rows.append(("adequate", *(("yes" if self.adequate(name) else "no") for name in displayed)))
        return rows

    def as_dict(self) -> Summary:
        """All numbers as plain values that fit into JSON."""
        return {
            "title": self.title,
            "allowed": self.allowed,
            "models": {
                name: {**step.as_dict(), "adequate": self.adequate(name)} for name, step in self.models.items()
            },
            "assumptions": self.assumptions.as_dict(),
            "verdict": self.verdict,
        }  # fmt: skip

    def figure(self) -> Figure:
        """Draw the model hierarchy: deflections under the load, local errors, distances."""
        from ropewalk.compare.figure import figure  # lazy: numbers need no Matplotlib

        return figure(self)

    def _names(self, quantity: str) -> list[str]:
        full: Any = self.models[FULL].quantities
        found = full.values(quantity)
        if len(found) <= MANY:
            return list(found)
        strongest = sorted(found, key=lambda name: -abs(found[name] or 0.0))[:FEW]
        return [name for name in found if name in strongest]


MANY, FEW = 6, 3  # of more lines, supports or wheels than the first, the table shows the second number


_LABELS = {
    "deflection": ("largest deflection of", "m"), "tension": ("largest tension of", "N"),
    "support force": ("largest force at", "N"), "contact force": ("largest contact force of", "N"),
    "hold force": ("largest hold force of", "N"), "speed": ("last speed of", "m/s"),
}  # fmt: skip
_DISTANCES = {
    "deflection": "largest deflection", "path": "deflection under the load", "tension": "largest tension",
    "support force": "largest support force", "contact force": "largest contact force", "speed": "last speed",
    "hold force": "largest hold force",
}  # fmt: skip


def _cell(error: float | None, allowed: float | None) -> str:
    return percent(error) + (" !" if error is not None and allowed is not None and error > allowed else "")
