"""A model of one's own for the matrix: it presses on the line and goes along it."""

from typing import Any


class Pressing:
    """Presses downwards with a constant force at constant speed."""

    def __init__(self, force: float, start: float, speed: float) -> None:
        self.force, self.start, self.speed = force, start, speed

    def step(self, t: float, h: float, line: Any) -> list[tuple[float, tuple[float, ...], float]]:
        """One contact (xi, force, speed)."""
        xi = self.start + self.speed * t
        level = len(line.at(xi)[0]) - 1
        return [(xi, (*[0.0] * level, -self.force), self.speed)]

    def get_state(self) -> None:
        """Nothing to remember."""

    def set_state(self, state: None) -> None:
        """Nothing to forget."""
