"""Turns: how a line and an external model go on one after the other, and what of energy gets lost between them.

The interval between two exchanges (macro step) is h. On the line acts, linear over the interval,

    order 0   F_n
    order 1   F_n            ..  2 F_n - F_{n-1}
    order 2   F_n - d        ..  3 F_n - 3 F_{n-1} + F_{n-2} - d,    d = (F_n - 2 F_{n-1} + F_{n-2}) / 12

where the last carries the impulse of the parabola through three forces. Beside it act the spring and the damper of the
interface, at every step of the line: with the height q of a contact that the model gives, or with that which the
contact would have if the line went on as foreseen. See docs/notes/cosimulation.md.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ropewalk.checkpoint import Tree, copied
from ropewalk.errors import RopewalkError
from ropewalk.external.protocol import LineView, Touch, touches
from ropewalk.external.seen import Foreseen, ForeseenContact, Seen
from ropewalk.mechanics.chain import Array
from ropewalk.model.exchange import Exchange
from ropewalk.model.travel import AtEnd

SETTLED = 50  # intervals, before which nothing is said of energy: what is put down suddenly rings


class TravelEndedError(RopewalkError):
    """A load has come to an end of its line where it may go neither on nor off."""


class ContactPush(NamedTuple):
    """What a contact does on the line until the next exchange."""

    xi: float  # m
    speed: float  # m/s along the line
    first: Array  # (axis,) N at the beginning of the interval
    last: Array  # (axis,) N at its end, linear in between
    height: float = 0.0  # m, of the far end of the interface's spring and damper at the beginning
    rise: float = 0.0  # m/s, of the same


Pushes = list[ContactPush | None]


class Bearer:
    """The line as what bears an external model: to be looked at, copied, and sent ahead."""

    @property
    def line(self) -> LineView:
        """The line."""
        raise NotImplementedError

    def frozen(self) -> LineView:
        """The line as it is now, to be looked at later."""
        raise NotImplementedError

    def ahead(self, pushes: Pushes, h: float) -> LineView | None:
        """The line as it would be after h seconds with these forces; it stays where it is. None: not to be had yet."""
        raise NotImplementedError


@dataclass(slots=True)
class _KeptContact:
    """Stored state of a contact that stays where it is or slides along."""

    place: Array  # (axis,) m, at the last exchange
    seen: Array  # (axis,) m, as the model saw it
    forces: list[Array]  # N, at the last exchanges, the newest first
    rates: list[Array]  # (axis,) m/s, its mean velocity in the last intervals, the newest first
    push: ContactPush
    motion: tuple[float, float] | None

    def get_state(self) -> Tree:
        """All of it."""
        own = {name: getattr(self, name) for name in ("place", "seen", "forces", "rates", "motion")}
        return copied({**own, "push": self.push._asdict()})

    @staticmethod
    def of(tree: Tree) -> _KeptContact:
        """The same once more."""
        own = copied(tree)
        return _KeptContact(**{**own, "push": ContactPush(**own["push"])})


@contextmanager
def closing(cosimulation: Sequence[CosimulationMaster]) -> Iterator[None]:
    """Let all models go at the end, however it comes."""
    try:
        yield
    finally:
        for partner in cosimulation:
            partner.close()


@contextmanager
def begun(cosimulation: Sequence[CosimulationMaster]) -> Iterator[None]:
    """Let all models go if they do not even begin."""
    try:
        yield
    except BaseException:
        for partner in cosimulation:
            partner.close()
        raise


@dataclass
class CosimulationMaster:
    """An external model and a line, exchange by exchange.

    Args:
        name: of the load.
        model: with the step protocol.
        every: interval, s.
        exchange: how they take turns.
        at_end: what a contact does that comes to an end of the line.
        most: contacts that it may have at a time.
        dim: number of axes.
        reach: m, a contact that is said to be further from where it has slid to is put down anew.
    """

    name: str
    model: Any
    every: float
    exchange: Exchange
    at_end: AtEnd
    most: int
    dim: int
    reach: float
    asked: int = 0
    work: float = 0.0  # J, that has gone through the interface, in whatever direction
    residual: float = 0.0  # J, that the exchange has made so far (negative: lost)
    peak: float = 0.0  # J, the largest part of it in one interval since `exchanged`
    diagnostics: list[str] = field(default_factory=list)
    _contacts: list[_KeptContact | None] = field(default_factory=list)
    _frozen: LineView | None = None
    _agreed: list[Touch] | None = None
    _disagreed: bool = False

    def __post_init__(self) -> None:
        self._degree = self.exchange.degree
        self._foresees = bool(self.exchange.scheme != "sequential" or self.exchange.stiffness or self.exchange.damping)

    def begin(self, line: LineView) -> None:
        """Reset the model.

        Raises:
            RopewalkError: it cannot go back in time although it is to, or its reset fails.
        """
        if self.exchange.scheme == "iterated":
            for method in ("get_state", "set_state"):
                if not callable(getattr(self.model, method, None)):
                    raise RopewalkError(
                        f"load {self.name}: exchange.scheme: iterated repeats intervals, and its model has no "
                        f"{method}; give it get_state() and set_state(state), or write sequential"
                    )
        self._contacts = [None] * self.most
        if hasattr(self.model, "reset"):
            self._guarded("its reset failed", 0.0, lambda: self.model.reset(self._seen(line)))

    @property
    def next(self) -> float:
        """When it is to be asked next, s."""
        return self.asked * self.every

    def exchanged(self) -> tuple[float, float, float]:
        """Work and residual so far, and the largest residual of an interval since this was asked last, J."""
        peak, self.peak = self.peak, 0.0
        return self.work, self.residual, peak

    def ask(self, t: float, bearer: Bearer) -> Pushes:
        """Ask the model at time t what its contacts do until the next exchange.

        Raises:
            RopewalkError: the model fails or gives what cannot be used.
            TravelEndedError: a contact has come to an end of the line where it is refused.
        """
        self.asked += 1
        line = seen = self._seen(bearer.line)
        if self.exchange.scheme == "parallel" and self._frozen is not None:
            seen = self._seen(self._foreseen(self._frozen))
        answer, self._agreed = self._step(t, seen) if self._agreed is None else self._agreed, None
        self._settle(line, seen, answer)
        if self.exchange.scheme == "parallel":
            self._frozen = bearer.frozen()
        if self.exchange.scheme == "iterated":
            return self.agree(t, bearer)
        pushes = [self._foresee(contact) for contact in self._contacts]
        self._remember(pushes)
        return pushes

    @property
    def made(self) -> float:
        """Energy that the exchange has made up to now, as a part of the work that went through it, if it counts."""
        counts = self.asked > SETTLED and self.residual > self.exchange.warn * self.work
        return self.residual / max(self.work, 1e-300) if counts else 0.0

    @property
    def verdict(self) -> str:
        """What is to be said of the energy that the exchange has made up to now."""
        return (
            f"load {self.name}: the exchange with its model has made {self.residual:.3g} J of energy, with "
            f"{self.work:.3g} J of work that went through it"
        )

    def close(self) -> None:
        """Let the model go."""
        if hasattr(self.model, "close"):
            self.model.close()

    def get_state(self, stored: Callable[[Any], Tree]) -> Tree:
        """All that changes, and the state of the model as data.

        Args:
            stored: what makes data of a line that is to be looked at later.

        Raises:
            RopewalkError: the model gives no state, or none that is data.
        """
        lacks = [name for name in ("get_state", "set_state") if not callable(getattr(self.model, name, None))]
        if lacks:
            raise RopewalkError(f"load {self.name}: its model has no {' and no '.join(lacks)}")
        model = self._guarded("its state cannot be read", 0.0, self.model.get_state)
        if callable(pack := getattr(self.model, "pack_state", None)):
            model = self._guarded("its state cannot be read as data", 0.0, lambda: pack(model))
        return {
            "asked": self.asked, "work": self.work, "residual": self.residual, "peak": self.peak,
            "contacts": [None if contact is None else contact.get_state() for contact in self._contacts],
            "frozen": None if self._frozen is None else stored(self._frozen),
            "agreed": None if self._agreed is None else [copied(touch._asdict()) for touch in self._agreed],
            "disagreed": self._disagreed, "model": copied(model),
        }  # fmt: skip

    def set_state(self, tree: Tree, line: Callable[[Tree], LineView]) -> None:
        """Be what it was when `get_state` gave this.

        Args:
            tree: the state.
            line: makes a line of what was stored of it.
        """
        self.asked, self._disagreed = tree["asked"], tree["disagreed"]
        self.work, self.residual, self.peak = tree["work"], tree["residual"], tree["peak"]
        self._contacts = [None if own is None else _KeptContact.of(own) for own in tree["contacts"]]
        self._frozen = None if tree["frozen"] is None else line(tree["frozen"])
        self._agreed = None if tree["agreed"] is None else [Touch(**copied(touch)) for touch in tree["agreed"]]
        model = copied(tree["model"])
        if callable(unpack := getattr(self.model, "unpack_state", None)):
            model = self._guarded("it does not take its state", 0.0, lambda: unpack(model))
        self._guarded("it does not take its state", 0.0, lambda: self.model.set_state(model))

    # -- Asking --------------------------------------------------------------------------------------------------

    def _step(self, t: float, line: Seen) -> list[Touch]:
        def step() -> Any:
            return self.model.step(t, self.every, line)

        return touches(self.name, self._guarded("its model failed", t, step), t, self.most, self.dim)

    def _seen(self, line: LineView) -> Seen:
        return Seen(line, self._mean_force)

    def _guarded(self, wrong: str, t: float, act: Callable[[], Any]) -> Any:
        try:
            return act()
        except RopewalkError as error:
            if type(error) is RopewalkError and not str(error).startswith("load "):
                raise RopewalkError(f"load {self.name}: {error}") from error
            raise
        except (Exception, SystemExit) as error:
            raise RopewalkError(
                f"load {self.name}: {wrong} at t = {t:g} s ({type(error).__name__}: {error})"
            ) from error

    def _on_line(self, touch: Touch, length: float) -> float | None:
        """Where on the line a contact is, None if it has left it."""
        if 0.0 <= touch.xi <= length:
            return touch.xi
        if self.at_end == "refuse":
            raise TravelEndedError(f"load {self.name} reaches the end of its line")
        return None if self.at_end == "leave" else min(max(touch.xi, 0.0), length)

    # -- Accounts ------------------------------------------------------------------------------------------------

    def _settle(self, line: Seen, seen: Seen, answer: Sequence[Touch]) -> None:
        """Close the accounts of the interval that ends now, and note where all contacts are."""
        made = 0.0
        for number in range(self.most):
            before = self._contacts[number]
            xi = self._on_line(answer[number], line.length) if number < len(answer) else None
            if xi is None:
                self._contacts[number] = None
                continue
            touch = answer[number]
            place, force = line.at(xi)[0], touch.force
            seen_place = place if seen is line else seen.at(xi)[0]
            now = _KeptContact(place, seen_place, [force], [], ContactPush(xi, touch.speed, force, force), touch.motion)
            if before is not None:
                slid = before.push.xi + before.push.speed * self.every
                if abs(xi - slid) <= self.reach:
                    made += self._made(before, now)
                    now.forces += before.forces[: self._degree]
                    if self._foresees:
                        now.rates = [(place - before.place) / self.every, *before.rates[:1]]
            self._contacts[number] = now
        self.residual += made
        self.peak = made if abs(made) > abs(self.peak) else self.peak

    def _mean_force(self, line: LineView, number: int) -> Array:
        """Mean force of a contact on the line since the last exchange, N."""
        contact = self._contacts[number]
        if contact is None:
            return np.zeros(self.dim)
        xi = min(max(contact.push.xi + contact.push.speed * self.every, 0.0), line.length)
        return self._pressed(contact, line.at(xi)[0])

    def _pressed(self, before: _KeptContact, place: Array) -> Array:
        """The same, of a contact that is at a place now."""
        k, c, push = self.exchange.stiffness, self.exchange.damping, before.push
        mean: Array = push.first if push.last is push.first else 0.5 * (push.first + push.last)
        if k or c:
            apart = push.height - before.place[-1], push.height + push.rise * self.every - place[-1]
            mean = mean.copy()
            mean[-1] += 0.5 * k * (apart[0] + apart[1]) + c * (apart[1] - apart[0]) / self.every
        return mean

    def _made(self, before: _KeptContact, now: _KeptContact) -> float:
        """Energy in J that the exchange has made in the last interval: the line's gain less the model's loss."""
        on_line, way = self._pressed(before, now.place), now.place - before.place
        gain = float(on_line @ way)
        self.work += abs(gain)
        if before.motion is None or now.motion is None:
            seen = way if now.seen is now.place and before.seen is before.place else now.seen - before.seen
            return gain - 0.5 * float((before.forces[0] + now.forces[0]) @ seen)
        # A contact that gives its motion: the spring of the interface stores, its damper loses.
        apart = before.motion[0] - before.place[-1], now.motion[0] - now.place[-1]
        stored = 0.5 * self.exchange.stiffness * (apart[1] ** 2 - apart[0] ** 2)
        lost = self.exchange.damping * (apart[1] - apart[0]) ** 2 / self.every
        return float(gain + stored + lost - on_line[-1] * (now.motion[0] - before.motion[0]))

    # -- Looking ahead -------------------------------------------------------------------------------------------

    def _foresee(self, contact: _KeptContact | None) -> ContactPush | None:
        """What a contact does until the next exchange, extrapolated."""
        if contact is None:
            return None
        F, order = contact.forces, min(self._degree, len(contact.forces) - 1)
        if order == 0 and not self._foresees and contact.motion is None:
            return contact.push
        first = last = F[0]
        if order == 1:
            last = 2.0 * F[0] - F[1]
        elif order == 2:
            bend = F[0] - 2.0 * F[1] + F[2]
            first, last = F[0] - bend / 12.0, F[0] + (F[0] - F[1]) + bend - bend / 12.0
        if contact.motion is not None:
            return contact.push._replace(first=first, last=last, height=contact.motion[0], rise=contact.motion[1])
        rise = self._rate(contact, self._degree + 1)[-1] if contact.rates else 0.0
        return contact.push._replace(first=first, last=last, height=float(contact.place[-1]), rise=float(rise))

    def _foreseen(self, frozen: LineView) -> Foreseen:
        """The line at the end of the interval that is now over, as it could be foreseen at its beginning."""
        h, order = self.every, self._degree
        if self.exchange.stiffness or self.exchange.damping:  # a line that holds still would pull at its dampers
            order = max(order, 1)
        courses = [
            ForeseenContact(c.push.xi + c.push.speed * h, c.place + h * self._rate(c, order))
            for c in self._contacts
            if c is not None and c.rates
        ]
        return Foreseen(frozen, h if order else 0.0, courses, self.reach)

    def _rate(self, contact: _KeptContact, order: int) -> Array:
        """Velocity of a contact in the interval after its last exchange, extrapolated."""
        rates = contact.rates
        if order == 0:
            return np.zeros(self.dim)
        return rates[0] if order == 1 or len(rates) == 1 else 2.0 * rates[0] - rates[1]

    def _remember(self, pushes: Pushes) -> None:
        for contact, push in zip(self._contacts, pushes, strict=True):
            if contact is not None and push is not None:
                contact.push = push

    def agree(self, t: float, bearer: Bearer) -> Pushes:
        """Repeat the interval ahead until line and model agree on what happens at its end.

        If the line cannot be sent ahead yet, nothing is agreed on, and this may be asked once more.
        """
        h, state = self.every, self.model.get_state()
        pushes = [self._foresee(contact) for contact in self._contacts]
        relax, before, change = 1.0, None, np.inf
        for _ in range(self.exchange.iterations):
            self._remember(pushes)
            there = bearer.ahead(pushes, h)
            if there is None:
                return pushes
            line = self._seen(there)
            self.model.set_state(state)
            ahead = self._step(t + h, line)
            wanted = self._towards(pushes, ahead, line)
            weight = self.exchange.stiffness * h + self.exchange.damping  # N s/m, of velocities among forces
            target = _numbers(wanted, weight)
            off = target - _numbers(pushes, weight)
            change = float(np.linalg.norm(off)) / max(float(np.linalg.norm(target)), 1e-300)
            if change <= self.exchange.tolerance:
                break
            if before is not None and before.size == off.size and (turn := off - before) @ turn > 0.0:
                relax = float(np.clip(-relax * (before @ turn) / (turn @ turn), 1e-3, 1.0))  # Aitken
            pushes, before = _between(pushes, wanted, relax), off
        else:
            if not self._disagreed:
                self.diagnostics.append(
                    f"load {self.name}: at t = {t:.4g} s line and model do not agree after {self.exchange.iterations} "
                    f"iterations (forces still change by {change:.1g} of their size); shorten `every`, raise "
                    "exchange.iterations, or give exchange.damping"
                )
            self._disagreed = True
        self._agreed = ahead
        self._remember(pushes)
        return pushes

    def _towards(self, pushes: Pushes, ahead: list[Touch], line: LineView) -> Pushes:
        """The same pushes with what the model answers at the end of the interval."""
        found: Pushes = []
        for number, push in enumerate(pushes):
            contact = self._contacts[number]
            if push is None or contact is None or number >= len(ahead):
                found.append(push)
                continue
            touch = ahead[number]
            end = contact.motion and touch.motion
            if end:
                rise = (end[0] - push.height) / self.every
            else:
                xi = min(max(push.xi + push.speed * self.every, 0.0), line.length)
                rise = (float(line.at(xi)[0][-1]) - push.height) / self.every
            last = touch.force
            first = contact.forces[0] if self._degree else last
            found.append(push._replace(first=first, last=last, rise=rise))
        return found


def _numbers(pushes: Pushes, weight: float) -> Array:
    """What iterations change, in N."""
    parts = [np.append(push.last, weight * push.rise) for push in pushes if push is not None]
    return np.concatenate([np.zeros(0), *parts])


def _between(pushes: Pushes, wanted: Pushes, part: float) -> Pushes:
    found: Pushes = []
    for a, b in zip(pushes, wanted, strict=True):
        if a is None or b is None:
            found.append(b)
        else:
            first, last = a.first + part * (b.first - a.first), a.last + part * (b.last - a.last)
            found.append(b._replace(first=first, last=last, rise=a.rise + part * (b.rise - a.rise)))
    return found
