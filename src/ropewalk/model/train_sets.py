"""Trains by name from published tables: their vehicles on springs, and the loads of their axles."""

from __future__ import annotations

from itertools import accumulate, pairwise
from typing import Literal, NamedTuple

SprungTrainName = Literal["ICE 3", "Shinkansen S300"]
MeasuredTrainName = Literal["ICE 2", "Talgo 350"]

G = 9.81  # m/s^2, of axle loads


class BogieVehicle(NamedTuple):
    """A vehicle on two bogies, each on two wheelsets, of both sides together."""

    length: float  # m, from buffer to buffer
    front: float  # m, from its front to the middle of the first bogie
    bogies: float  # m, between their middles
    wheelbase: float  # m, of a bogie
    body: float  # kg
    body_inertia: float  # kg m^2, of pitch
    bogie: float  # kg, frame
    bogie_inertia: float  # kg m^2, of pitch
    wheelset: float  # kg
    primary: tuple[float, float]  # N/m and N s/m, of an axle
    secondary: tuple[float, float]  # N/m and N s/m, of a bogie

    @property
    def axles(self) -> tuple[float, ...]:
        """Places of its axles, m ahead of its middle, from the front."""
        first = 0.5 * self.length - self.front
        return tuple(b + side * 0.5 * self.wheelbase for b in (first, first - self.bogies) for side in (1.0, -1.0))

    @property
    def axle_load(self) -> float:
        """Weight on each axle, N; its centre is halfway between its bogies."""
        return (0.25 * self.body + 0.5 * self.bogie + self.wheelset) * G


# J. M. Goicolea, Simplified mechanical description of AVE S-103 - ICE3 Velaro E high speed train, UPM, 2014
# (oa.upm.es/43946), as tabulated for plane models in TTB-2D (D. Cantero, SoftwareX 20, 2022), which is what was seen.
_VELARO = BogieVehicle(
    24.775, 3.7, 17.375, 2.5, 47800.0, 1957888.0, 3500.0, 1715.0, 1800.0, (2.4e6, 20e3), (700e3, 40e3)
)
_VELARO_MIDDLE = _VELARO._replace(body=41200.0, body_inertia=1687552.0, bogie_inertia=1372.0)
_VELARO_FIRST = _VELARO._replace(length=25.835, front=4.76)
_VELARO_LAST = _VELARO._replace(length=25.835)
# Y.-S. Wu and Y.-B. Yang, Engineering Structures 25, 2003, 251-265, as tabulated in TTB-2D; there is one vehicle,
# sixteen of them are the train.
_S300 = BogieVehicle(
    25.0, 3.75, 17.5, 2.5, 41750.0, 2080000.0, 3040.0, 3930.0, 1780.0, (1180e3, 39.2e3), (530e3, 90.2e3)
)

VEHICLES: dict[str, dict[str, BogieVehicle]] = {
    "ICE 3": {"first": _VELARO_FIRST, "heavy": _VELARO, "light": _VELARO_MIDDLE, "last": _VELARO_LAST},
    "Shinkansen S300": {"coach": _S300},
}
"""Vehicles of each train, by name."""
ORDER: dict[str, tuple[str, ...]] = {
    "ICE 3": ("first", "heavy", "heavy", "light", "light", "heavy", "heavy", "last"),
    "Shinkansen S300": ("coach",) * 16,
}
"""Names of the vehicles of each train from the front."""

# IAPF-07, Spanish code of actions on railway bridges, annex C.2, as tabulated in xc (L. C. Perez Tato and A. Ortega,
# github.com/xcfem/xc), which is what was seen: distances between axles in m, forces of all in N.
_TALGO = (2.65, 8.35, 2.65, 5.48, 8.97, *(13.14,) * 9, 8.97, 5.47, 2.65, 8.35, 2.65)
_MEASURED: dict[str, list[tuple[float, float]]] = {
    "ICE 2": [
        (at, 195e3 if at < 15.0 or at > 336.0 else 112e3)
        for at in (
            *(0.0, 3.0, 11.46, 14.46),
            *(19.31 + 26.4 * i + bogie for i in range(12) for bogie in (0.0, 2.5, 19.0, 21.5)),
            *(336.06, 339.06, 347.52, 350.52),
        )
    ],
    "Talgo 350": [(at, 170e3) for at in accumulate((*_TALGO, 7.15, *_TALGO), initial=0.0)],
}


def axle_loads(name: str) -> list[tuple[float, float]]:
    """The axles of a train of a name: distances behind the first one in m, and forces in N, downwards."""
    if name in _MEASURED:
        return _MEASURED[name]
    own = [VEHICLES[name][vehicle] for vehicle in ORDER[name]]
    found = [
        (middle - at, vehicle.axle_load)
        for vehicle, middle in zip(own, middles([vehicle.length for vehicle in own]), strict=True)
        for at in vehicle.axles
    ]
    return [(at - found[0][0], force) for at, force in found]


def middles(lengths: list[float]) -> list[float]:
    """How far behind the front of a train the middles of its vehicles of some lengths are, m."""
    return [0.5 * (begin + end) for begin, end in pairwise(accumulate(lengths, initial=0.0))]
