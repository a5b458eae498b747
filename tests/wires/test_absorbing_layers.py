"""Layers of windows take up waves across wires: what comes back of a pulse on a long string, and of a damped one.

Source: the telegraph equation u.. + (sigma(x) + drag) u. = c^2 u'' of a layer, solved for each frequency.
"""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.results.frame import RunInfo
from ropewalk.wires import absorbing_layer
from ropewalk.wires.frames import Wires
from ropewalk.wires.plan import Contact, TravellingLoad, WirePlan
from ropewalk.wires.prescribed_motion import PrescribedMotion, inputs_of
from ropewalk.wires.task import WireTask
from wire_cases import NONE, straight

LENGTH, TENSION, MASS = 2400.0, 20e3, 1.35  # m, N, kg/m
SPEED = np.sqrt(TENSION / MASS)  # m/s
THICK, STRENGTH = 0.4, 2.0  # as in `absorbing_layer.py`, which gives them their reasons


def pulse(tau: float, window: float, drag: float = 0.0, back: float | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Height over time under a standing force that makes a pulse of Gaussian shape, tau in s; links of 0.5 m.

    It ends when the pulse has come back from the borders of the window, or from as far away as `back` in m.
    """
    middle = 5.0 * tau

    def given(t: np.ndarray) -> np.ndarray:
        return (-(t - middle) / tau**2 * np.exp(-0.5 * ((t - middle) / tau) ** 2))[:, None]

    wire = straight(LENGTH, TENSION, MASS, drag=drag)
    load = TravellingLoad("push", NONE, NONE, NONE, (Contact(0, stiffness=0.0),))
    motion = PrescribedMotion(load, lambda t: np.full(t.size, 0.5 * LENGTH), given=given)
    until = 10.0 * tau + 2.0 * (window if back is None else back) / SPEED
    task = WireTask(WirePlan((wire,), gravity=0.0), (motion,), ("push",), element=0.5, geometry="linearised",
                    window=window)  # fmt: skip
    run = Wires(task, np.array([0.0, until]), RunInfo())
    rows = round(until / run.sample)
    inputs = inputs_of(run.task.plan, run.task.prescribed_motions, run.sample * np.arange(rows + 1.0))
    return run.sample * np.arange(rows), run.motion.go(inputs, run.steps).height[:, 0]


def comes_back(tau: float, window: float, drag: float = 0.0) -> float:
    """What comes back of the pulse from both borders, over the pulse itself; minus: reversed. Beside the whole line."""
    t, z = pulse(tau, window, drag)
    whole = pulse(tau, np.inf, drag, back=window)[1]  # whose ends are too far away
    back = (z - whole)[t > 2.0 * (1.0 - THICK) * window / SPEED]
    return float(back[np.abs(back).argmax()] / whole.max())


def expected(tau: float, window: float, drag: float = 0.0) -> float:
    """The same by the telegraph equation, for each frequency in a thousand pieces of the layer from the border on."""
    n, thick, pieces = 8192, THICK * window, 1000
    dt = 10.0 * (10.0 * tau + 2.0 * window / SPEED) / n
    t = dt * (np.arange(n) - n // 4)
    omega = 2.0 * np.pi * np.fft.rfftfreq(n, dt)
    omega[0] = 1e-6 * omega[1]

    def wave_number(sigma: float) -> np.ndarray:
        k = np.sqrt(omega * (omega - 1j * sigma)) / SPEED
        return np.where(k.imag > 0.0, -k, k)

    Y = np.zeros(omega.size, dtype=complex)  # displacement over slope: nothing at the border
    for part in 1.0 - (np.arange(pieces) + 0.5) / pieces:
        k = wave_number(STRENGTH * SPEED / thick * part**2 + drag)
        tan = np.tan(k * thick / pieces)
        Y = (Y - tan / k) / (1.0 + k * tan * Y)
    k = wave_number(drag)
    r = (1.0 + 1j * k * Y) / (1j * k * Y - 1.0) * np.exp(-2j * k * (window - thick))
    shape = np.fft.rfft(np.exp(-0.5 * (t / tau) ** 2)) * omega / (SPEED * k)
    back = np.fft.irfft(2.0 * r * shape, n)
    return float(back[np.abs(back).argmax()] / np.fft.irfft(shape, n).max())


@pytest.mark.parametrize("drag", [0.0, 0.2])
@pytest.mark.parametrize(("tau", "window"), [(0.03, 120.0), (0.06, 120.0), (0.12, 120.0), (0.12, 240.0), (0.12, 60.0)])
def test_what_comes_back_from_a_layer_is_that_of_the_telegraph_equation(tau: float, window: float, drag: float) -> None:
    found, wanted = comes_back(tau, window, drag), expected(tau, window, drag)
    print(f"pulse of {SPEED * tau:.1f} m, window of {window:g} m: {found:.4f}, by the equation {wanted:.4f}")
    assert found == pytest.approx(wanted, rel=0.01)  # links of a seventh of the shortest pulse


def test_what_comes_back_falls_to_that_of_short_waves_with_the_first_order_of_the_width() -> None:
    """Of short waves both layers let back exp(-strength / 3) each: sigma / 2 c, there and back, on all of the way."""
    limit = -2.0 * np.exp(-STRENGTH / 3.0)
    above = [comes_back(0.04, window) / limit - 1.0 for window in (60.0, 120.0, 240.0)]
    orders = np.log2(np.array(above[:-1]) / above[1:])
    print("above that of short waves:", above, "orders:", orders)
    assert np.all((orders > 0.9) & (orders < 1.1))
    assert above[-1] < 0.08


def test_without_layers_all_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(absorbing_layer, "_STRENGTH", 0.0)
    assert comes_back(0.06, 120.0) == pytest.approx(-2.0, rel=0.01)
