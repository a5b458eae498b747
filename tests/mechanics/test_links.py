"""Compiled link forces and stiffness against plain NumPy, against the stored energy, and under rotation."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ropewalk.mechanics import law, link
from ropewalk.mechanics.assembly import pack
from ropewalk.mechanics.stiffness import link_damping, link_stiffness, strand_blocks
from ropewalk.model import Hooke, Polynomial, SecondPiolaKirchhoff, Tabulated, TensionOnly

EA, C = 3e4, 40.0
LAWS = {
    "hooke": pack(Hooke(), EA),
    "tension_only": pack(TensionOnly(), EA),
    "second_piola_kirchhoff": pack(SecondPiolaKirchhoff(), EA),
    "quintic": pack(Polynomial(coefficients=(EA, 1e4, 2e5, 0.0, 1e5)), None),
    "table": pack(Tabulated(strain=(-0.3, 0.0, 0.1, 0.25), tension=(-500.0, 0.0, 900.0, 4e3)), None),
}
every_law = pytest.mark.parametrize("name", LAWS)
plane_and_space = pytest.mark.parametrize("dim", [2, 3])
damped_or_not = pytest.mark.parametrize("c", [0.0, C])


def chain(dim: int, seed: int = 0, nodes: int = 9, h: float = 0.5) -> tuple[np.ndarray, np.ndarray]:
    """Positions and velocities of a crooked chain: links between 0.6 and 1.4 times as long as unstrained."""
    rng = np.random.default_rng(seed)
    steps = rng.normal(size=(dim, nodes - 1))
    steps *= h * rng.uniform(0.6, 1.4, nodes - 1) / np.sqrt((steps**2).sum(axis=0))
    r = np.concatenate([np.zeros((dim, 1)), np.cumsum(steps, axis=1)], axis=1)
    return r, rng.normal(size=(dim, nodes))


def plain(p: np.ndarray, c: float, h: float, r: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The twin: force vectors (axis, link) and strain rates of all links."""
    d, u = np.diff(r, axis=1), np.diff(w, axis=1)
    length = np.sqrt((d * d).sum(axis=0))
    rate = (d * u).sum(axis=0) / length / h
    return (law.tensions(p, length / h - 1.0) + c * rate) * d / length, rate


def compiled(p: np.ndarray, c: float, h: float, r: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, float]:
    q, f = np.zeros(r.shape[1]), np.zeros_like(r)
    total = link.pull(p, c, h, 0, r.shape[1] - 1, r, w, q)
    link.link_force_vectors(0, r.shape[1] - 1, r, q, f)
    assert q[-1] == 0.0
    assert np.all(f[:, -1] == 0.0)
    return f[:, :-1], total


def forces_on_nodes(p: np.ndarray, c: float, h: float, r: np.ndarray, w: np.ndarray) -> np.ndarray:
    f, _ = compiled(p, c, h, r, w)
    nothing = np.zeros((r.shape[0], 1))
    return np.diff(np.concatenate([nothing, f, nothing], axis=1), axis=1)


def energy(p: np.ndarray, h: float, r: np.ndarray) -> float:
    length = np.sqrt((np.diff(r, axis=1) ** 2).sum(axis=0))
    return float(law.stored_total(p, length / h - 1.0, np.full(length.size, h)))


@every_law
@plane_and_space
@damped_or_not
def test_compiled_pull_equals_its_plain_twin(name: str, dim: int, c: float) -> None:
    p, h = LAWS[name], 0.5
    r, w = chain(dim)
    expected, rate = plain(p, c, h, r, w)
    f, total = compiled(p, c, h, r, w)
    # a dozen roundings of forces up to EA; slack links keep a rounding of the strain
    assert f == pytest.approx(expected, rel=1e-13, abs=1e-14 * EA)
    assert total == pytest.approx(float((rate**2).sum()) if c else 0.0, rel=1e-13)


@every_law
@plane_and_space
@damped_or_not
@pytest.mark.parametrize("change", [0.0, 1e-3, 0.05, 0.6, np.inf])  # inf: nothing is known yet
def test_the_pull_in_a_loop_over_time_equals_its_plain_twin_however_far_lengths_have_changed(
    name: str, dim: int, c: float, change: float
) -> None:
    p, h, nodes = LAWS[name], 0.5, 40
    r, w = chain(dim, nodes=nodes)
    per_length, q, f = np.zeros(nodes), np.zeros(nodes), np.zeros_like(r)
    if np.isfinite(change):
        before = r * (1.0 + change * np.linspace(0.0, 1.0, nodes))
        link.add_link_forces_again(p, c, h, 0, nodes - 1, before, w, per_length, q, f)
    total = link.add_link_forces_again(p, c, h, 0, nodes - 1, r, w, per_length, q, f)
    expected, rate = plain(p, c, h, r, w)
    # of the length's error of 2e-11 at most, where it has changed by less than 1 %, the stiffness makes 1e-10 EA
    assert f[:, :-1] == pytest.approx(expected, rel=1e-10, abs=1e-10 * EA)
    assert total == pytest.approx(float((rate**2).sum()) if c else 0.0, rel=1e-9)
    assert np.all(f[:, -1] == 0.0)
    lengths = np.sqrt((np.diff(r, axis=1) ** 2).sum(axis=0))
    if p[0] == law.CUBIC:
        assert per_length[:-1] * lengths == pytest.approx(np.ones(nodes - 1), abs=1e-10)


@plane_and_space
def test_the_rate_of_the_length_of_some_links_equals_its_plain_twin(dim: int) -> None:
    r, w = chain(dim)
    d, v = np.diff(r, axis=1)[:, 2:6], np.diff(w, axis=1)[:, 2:6]
    expected = float(((d * v).sum(axis=0) / np.sqrt((d**2).sum(axis=0))).sum())
    assert link.growth(2, 6, r, w) == pytest.approx(expected, rel=1e-13)  # a dozen roundings
    assert link.growth(4, 4, r, w) == 0.0


@every_law
@damped_or_not
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_finite_does_not_get_lost(name: str, c: float, bad: float) -> None:
    p, h = LAWS[name], 0.5
    r, w = chain(2)
    per_length, q, f = np.zeros(9), np.zeros(9), np.zeros_like(r)
    link.add_link_forces_again(p, c, h, 0, 8, r, w, per_length, q, f)
    r[0, 4] = bad
    link.add_link_forces_again(p, c, h, 0, 8, r, w, per_length, q, f)
    assert not np.isfinite(f[:, 3:5]).all(axis=0).any()


@every_law
@plane_and_space
def test_a_single_link_pulls_as_it_does_in_the_chain(name: str, dim: int) -> None:
    p, h = LAWS[name], 0.5
    r, w = chain(dim)
    expected, rate = plain(p, C, h, r, w)
    for i in range(r.shape[1] - 1):
        q = link.link_force(p, C, h, rate[i], r, i)
        assert q * np.diff(r, axis=1)[:, i] == pytest.approx(expected[:, i], rel=1e-13, abs=1e-14 * EA)
        assert link.stretch(r, i) == pytest.approx(float(np.linalg.norm(np.diff(r, axis=1)[:, i])), rel=1e-15)
        assert link.stretch_rate(r, w, i) / h == pytest.approx(rate[i], rel=1e-12, abs=1e-13)


@every_law
@plane_and_space
@damped_or_not
def test_only_the_links_asked_for_are_written(name: str, dim: int, c: float) -> None:
    p, h = LAWS[name], 0.5
    r, w = chain(dim)
    q, f = np.full(r.shape[1], -7.0), np.full_like(r, -7.0)
    total = link.pull(p, c, h, 2, 6, r, w, q)
    link.link_force_vectors(2, 6, r, q, f)
    expected, rate = plain(p, c, h, r, w)
    assert f[:, 2:6] == pytest.approx(expected[:, 2:6], rel=1e-13, abs=1e-14 * EA)
    assert total == pytest.approx(float((rate[2:6] ** 2).sum()) if c else 0.0, rel=1e-13)
    for untouched in (q[:2], q[6:], f[:, :2], f[:, 6:]):
        assert np.all(untouched == -7.0)


@every_law
@plane_and_space
@settings(deadline=None, max_examples=10)
@given(seed=st.integers(0, 10**6))
def test_forces_are_minus_the_gradient_of_the_stored_energy(name: str, dim: int, seed: int) -> None:
    p, h, step = LAWS[name], 0.5, 1e-6
    r, w = chain(dim, seed, nodes=5)
    f = forces_on_nodes(p, 0.0, h, r, w)
    for a in range(dim):
        for i in range(r.shape[1]):
            ahead, behind = r.copy(), r.copy()
            ahead[a, i] += step
            behind[a, i] -= step
            slope = (energy(p, h, ahead) - energy(p, h, behind)) / (2.0 * step)
            # roundings of an energy of 1e4 J over step; across a kink half a step times the jump of slope EA/h
            assert f[a, i] == pytest.approx(-slope, abs=1e-16 * 1e4 / step * 4.0 + step * EA / h)


@every_law
@damped_or_not
@settings(deadline=None, max_examples=10)
@given(seed=st.integers(0, 10**6))
def test_forces_turn_with_the_chain(name: str, c: float, seed: int) -> None:
    p, h = LAWS[name], 0.5
    for dim in (2, 3):
        r, w = chain(dim, seed)
        turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(dim, dim)))
        f, _ = compiled(p, c, h, r, w)
        turned, _ = compiled(p, c, h, np.ascontiguousarray(turn @ r), np.ascontiguousarray(turn @ w))
        assert turned == pytest.approx(turn @ f, abs=1e-13 * EA)  # roundings of positions of some metres


@every_law
def test_space_without_sideways_motion_is_the_plane_bit_for_bit(name: str) -> None:
    p, h = LAWS[name], 0.5
    r, w = chain(2)
    flat, still = np.insert(r, 1, 0.0, axis=0), np.insert(w, 1, 0.0, axis=0)
    f, _ = compiled(p, 0.0, h, r, w)
    g, _ = compiled(p, 0.0, h, flat, still)
    assert np.array_equal(g[[0, 2]], f)
    assert np.all(g[1] == 0.0)
    f, _ = compiled(p, C, h, r, w)
    g, _ = compiled(p, C, h, flat, still)
    assert g[[0, 2]] == pytest.approx(f, rel=1e-13, abs=1e-14 * EA)  # damped sums may be re-ordered
    assert np.all(g[1] == 0.0)


@every_law
@plane_and_space
def test_link_blocks_are_the_derivatives_of_the_link_force(name: str, dim: int) -> None:
    p, h, step = LAWS[name], 0.5, 1e-6
    r, w = chain(dim)
    block = np.zeros((dim, dim))
    for i in range(r.shape[1] - 1):
        for kernel, moved, expected in ((link_stiffness, r, p), (link_damping, w, C)):
            numbers = np.empty((dim, dim))
            for a in range(dim):
                sides = []
                for sign in (1.0, -1.0):
                    changed = moved.copy()
                    changed[a, i + 1] += sign * step
                    pair = (changed, w) if moved is r else (r, changed)
                    sides.append(plain(p, C if moved is w else 0.0, h, *pair)[0][:, i])
                numbers[:, a] = (sides[0] - sides[1]) / (2.0 * step)
            kernel(expected, h, r, i, block)
            # stiffness EA/h = 6e4 N/m: roundings of forces of 1e4 N over step, and step^2 terms
            assert block == pytest.approx(numbers, abs=1e-4)


@every_law
@plane_and_space
def test_strand_blocks_are_the_derivatives_of_the_forces_on_the_inner_nodes(name: str, dim: int) -> None:
    p, h, step = LAWS[name], 0.5, 1e-6
    r, w = chain(dim, nodes=6)
    m = r.shape[1] - 2
    diagonal, damping = np.full((m, dim, dim), 9.0), np.full((m, dim, dim), 9.0)
    off, damping_off = np.full((m - 1, dim, dim), 9.0), np.full((m - 1, dim, dim), 9.0)
    strand_blocks(p, C, np.full(m + 1, h), r, diagonal, off, damping, damping_off)
    for blocks, beside, moved in ((diagonal, off, r), (damping, damping_off, w)):
        full = np.zeros((m, dim, m, dim))
        for i in range(m):
            full[i, :, i] = blocks[i]
            if i < m - 1:
                full[i, :, i + 1] = beside[i]
                full[i + 1, :, i] = beside[i].T
        for j in range(m):
            for a in range(dim):
                sides = []
                for sign in (1.0, -1.0):
                    changed = moved.copy()
                    changed[a, j + 1] += sign * step
                    pair = (changed, w) if moved is r else (r, changed)
                    sides.append(forces_on_nodes(p, C if moved is w else 0.0, h, *pair)[:, 1:-1])
                slope = -(sides[0] - sides[1]) / (2.0 * step)
                assert full[:, :, j, a] == pytest.approx(slope.T, abs=1e-4)  # as above


def test_the_links_work_without_the_compiler() -> None:
    if os.environ.get("NUMBA_DISABLE_JIT") == "1":
        pytest.skip("this is the run without the compiler")
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--import-mode=importlib", str(Path(__file__)),
         "-k", "twin or asked_for or bit_for_bit or blocks"],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stdout + run.stderr
    assert "passed" in run.stdout
