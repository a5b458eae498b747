"""One mode under polynomial forces: the three routes of the exact step, and the step by collocation, by quadrature."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ropewalk.theory import beam_response

NODES, WEIGHTS = np.polynomial.legendre.leggauss(30)


def duhamel(frequency: float, decay: float, t: float, h: float, power: int) -> float:
    """Convolution with the impulse response, in panels that follow the fastest pole."""
    pair = beam_response.poles(np.array([frequency]), decay)
    panels = 2 + int(abs(pair[1][0]) * t / 4.0)
    edges = np.linspace(0.0, t, panels + 1)
    half = 0.5 * np.diff(edges)[:, np.newaxis]
    tau = (edges[:-1, np.newaxis] + half * (1 + NODES)).ravel()
    kernel = beam_response.difference(pair[0], pair[1], t - tau).real
    return float(np.sum((half * WEIGHTS).ravel() * kernel * (tau / h) ** power))


@settings(deadline=None, max_examples=80)
@given(
    st.floats(-3.0, 3.5),
    st.sampled_from([0.0, 0.01, 0.3, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.2, 5.0, 40.0]),
    st.floats(0.05, 1.0),
    st.integers(0, 3),
)
def test_polynomial_forces_by_quadrature(scale: float, ratio: float, share: float, power: int) -> None:
    h, frequency = 0.1, 10.0**scale
    decay = min(ratio * frequency, 3e3)
    pair, t = beam_response.poles(np.array([frequency]), decay), share * h
    value, rate = beam_response.forced(pair, np.array([t]), h, 3)
    static = abs(duhamel(frequency, decay, t, h, 0)) + 1e-300
    # rounding; 1/(phase 4)^3 3! of it where polynomial and free vibration cancel
    assert value[0, 0, power] == pytest.approx(duhamel(frequency, decay, t, h, power), abs=1e-12 * static)
    # q'' = f - 2 d q' - w^2 q integrates to the rate
    inner = 0.5 * t * (1 + NODES)
    if abs(pair[1][0]) * t < 6.0:
        q, v = beam_response.forced(pair, inner, h, 3)
        acceleration = (inner / h) ** power - 2.0 * decay * v[:, 0, power] - frequency**2 * q[:, 0, power]
        assert rate[0, 0, power] == pytest.approx(0.5 * t * WEIGHTS @ acceleration, abs=1e-11 * t)


@pytest.mark.parametrize("ratio", [0.0, 0.5, 1.0, 3.0])
def test_both_steps_agree_where_the_mode_is_resolved(ratio: float) -> None:
    frequency, h = np.array([2.0, 4.0]), 0.02
    t = np.array([0.0, 0.008, 0.02])
    exact, gauss = (kind(frequency, ratio * 2.0, h) for kind in (beam_response.ExactStep, beam_response.GaussStep))
    for one, other in zip(exact.response(t), gauss.response(t), strict=True):
        if one.ndim == 3:  # one constant force instead of four, of which each alone changes too fast
            one, other = one.sum(axis=2), other.sum(axis=2)
        assert other[-1] == pytest.approx(one[-1], abs=1e-9)  # at the end of the step, order 8
        assert other == pytest.approx(one, abs=1e-4)  # within it, order 5


def test_collocation_neither_damps_nor_excites() -> None:
    for frequency in (1.0, 30.0, 1e4):
        step = beam_response.GaussStep(np.array([frequency]), 0.0, 0.1)
        q_q, q_v, v_q, v_v = (a[0, 0] for a in step.response(np.array([0.1]))[:4])
        assert q_q * v_v - q_v * v_q == pytest.approx(1.0, abs=1e-9)  # rounding, of numbers up to 1e4
        assert q_q**2 + (v_q / frequency) ** 2 == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("spread", [0.0, 1e-9, 1e-3, 2.9e-3, 3.1e-3, 0.5, 20.0])
@pytest.mark.parametrize("decay", [0.0, 1.0])
def test_second_difference_is_its_integral_over_the_triangle(spread: float, decay: float) -> None:
    """Hermite and Genocchi: t^2 times the integral of exp over all weighted means of the three points."""
    t = 0.7
    pair = (np.array([-decay + 0.3j * spread]), np.array([-decay - 0.3j * spread]))
    s = np.array([-decay + 0.9j * spread])
    u, v = 0.5 * (1 + NODES)[:, np.newaxis], 0.5 * (1 + NODES)
    a, b = u * (1 - v), u * v  # weights of the poles; the rest is that of s
    inside = np.exp(t * (s * (1 - a - b) + pair[0] * a + pair[1] * b))
    expected = t**2 * np.sum(0.25 * np.outer(WEIGHTS, WEIGHTS) * u * inside)
    value = beam_response.second_difference(s, pair, np.array([[t]]), np.zeros(1))[0, 0]
    assert value == pytest.approx(expected, rel=1e-10)  # rounding by the square of the spread, 2e-11
