"""Pass and stop bands of periodically supported lines: Brillouin; Mead, J. Sound Vib. 11 (1970).

Reference numbers are roots of the two equations in the head of `ropewalk.theory.periodic`. The independent route
is the transfer matrix of one span, an exponential of the equations of motion in space.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.linalg import expm

from ropewalk.theory import periodic

STRING = {"spacing": 1.0, "mass": 1.0, "tension": 1.0}
BEAM = {"spacing": 1.0, "mass": 1.0, "bending_stiffness": 1.0}
PI = np.pi


def transfer_matrix(
    omega: complex,
    *,
    spacing: float,
    mass: float,
    support_stiffness: float,
    support_mass: float = 0.0,
    tension: float = 0.0,
    bending_stiffness: float = 0.0,
    damping: float = 0.0,
    support_damping: float = 0.0,
) -> NDArray[np.complex128]:
    """From behind one support to behind the next: jump of the shear force, then the span."""
    load = mass * omega**2 - 1j * omega * damping
    support = support_stiffness - support_mass * omega**2 + 1j * omega * support_damping
    if bending_stiffness == 0.0:  # state w, T w'
        field = np.array([[0.0, 1.0 / tension], [-load, 0.0]], dtype=complex)
        jump = np.array([[1.0, 0.0], [support, 1.0]], dtype=complex)
    else:  # state w, w', EI w'', -EI w''' + T w'
        field = np.array(
            [
                [0, 1, 0, 0],
                [0, 0, 1 / bending_stiffness, 0],
                [0, tension, 0, -1],
                [-load, 0, 0, 0],
            ],
            dtype=complex,
        )
        jump = np.eye(4, dtype=complex)
        jump[3, 0] = support
    return np.asarray(expm(field * spacing) @ jump)


def multipliers(omega: complex, **line: float) -> NDArray[np.complex128]:
    return np.linalg.eigvals(transfer_matrix(omega, **line))


def passes(omega: float, **line: float) -> bool:
    return bool(np.any(np.abs(np.abs(multipliers(omega, **line)) - 1.0) < 1e-7))


@st.composite
def lines(draw: st.DrawFn) -> dict[str, float]:
    """Strings, beams and tensioned beams on soft to hard, light to heavy supports."""
    kind = draw(st.sampled_from(["string", "beam", "tensioned beam"]))
    return {
        "spacing": draw(st.floats(0.5, 2.0)),
        "mass": draw(st.floats(0.5, 2.0)),
        "tension": 0.0 if kind == "beam" else draw(st.floats(0.2, 20.0)),
        "bending_stiffness": 0.0 if kind == "string" else draw(st.floats(0.2, 5.0)),
        "support_stiffness": 10.0 ** draw(st.floats(-2.0, 4.0)),
        "support_mass": draw(st.sampled_from([0.0, 0.05, 1.0, 30.0])),
    }


@pytest.mark.parametrize(
    ("supports", "highest", "edges"),
    [
        (
            {"support_stiffness": 4.0},
            3 * PI,
            [(1.720667178039, PI), (4.057515676221, 2 * PI), (6.851236918963, 3 * PI)],
        ),
        ({"support_stiffness": 1.0}, PI, [(0.960188873915, PI)]),
        (
            {"support_stiffness": 4.0, "support_mass": 0.1},
            12.0,
            [
                (1.67512958968, PI),
                (3.792873467694, 2 * PI),
                (6.290096018109, 8.979744096015),
                (3 * PI, 11.773186614637),
            ],
        ),
    ],
)
def test_bands_of_the_string_are_those_of_the_catalogue(
    supports: dict[str, float], highest: float, edges: list[tuple[float, float]]
) -> None:
    bands = periodic.pass_bands(**STRING, **supports, highest=highest)
    assert bands == pytest.approx(np.array(edges), abs=6e-12)  # 11 to 12 decimals are given


def test_bands_of_the_beam_are_those_of_the_catalogue() -> None:
    bands = periodic.pass_bands(**BEAM, support_stiffness=50.0, highest=60.0)
    assert bands[0] == pytest.approx([6.8186468, PI**2], abs=6e-8)  # as many decimals as given
    assert bands[1] == pytest.approx([13.99616925, 4 * PI**2], abs=6e-9)
    assert bands[2] == pytest.approx([40.75609422, 60.0], abs=6e-9)


@settings(deadline=None, max_examples=12)
@given(lines())
def test_no_band_is_missed_and_none_is_false(line: dict[str, float]) -> None:
    highest = 25.0
    bands = periodic.pass_bands(**line, highest=highest)
    gaps = np.stack([np.append(0.0, bands[:, 1]), np.append(bands[:, 0], highest)], axis=1)
    for inside, ranges in ((True, bands), (False, gaps)):
        for low, high in ranges:
            if high - low > 1e-4:  # thinner ones are below the resolution of this check
                for omega in low + (high - low) * np.array([0.05, 0.35, 0.65, 0.95]):
                    assert passes(omega, **line) == inside, (omega, low, high)


@settings(deadline=None, max_examples=12)
@given(lines(), st.floats(0.0, PI), st.integers(0, 4))
def test_band_frequencies_have_their_multiplier(line: dict[str, float], mu: float, band: int) -> None:
    omega = periodic.band_frequencies(mu, **line, bands=5)[band]
    if omega > 1e-3:
        found = transfer_matrix(omega, **line)
        singular = np.linalg.svd(found - np.exp(-1j * mu) * np.eye(len(found)), compute_uv=False)
        # the exponential of the fading wave, cosh(15) or so, times its rounding
        assert singular[-1] <= 1e-7 * np.linalg.norm(found, 2) ** 0.5
    assert periodic.band_frequencies(-mu, **line, bands=5)[band] == pytest.approx(omega, rel=1e-12)
    assert periodic.band_frequencies(mu + 2 * PI, **line, bands=5)[band] == pytest.approx(omega, rel=1e-9)  # mu's ulp


@settings(deadline=None, max_examples=12)
@given(lines(), st.floats(0.3, 30.0), st.sampled_from([0.0, 0.3]), st.sampled_from([0.0, 2.0]))
def test_propagation_constants_are_those_of_the_transfer_matrix(
    line: dict[str, float], omega: float, damping: float, support_damping: float
) -> None:
    full = line | {"damping": damping, "support_damping": support_damping}
    mu = periodic.propagation_constant(omega, **full)
    assert np.all(mu.imag <= 1e-12)
    expected = multipliers(omega, **full)
    for value in mu:
        # the large multipliers are the accurate ones; a band edge loses half of the digits
        growth = np.exp(1j * value)
        assert np.min(np.abs(expected - growth)) <= 1e-6 * abs(growth)
    assert np.all(np.diff(-mu.imag) >= 0.0)


def test_string_and_softly_bedded_supports_close_the_gap_between_bands_as_they_vanish() -> None:
    free = periodic.pass_bands(**STRING, support_stiffness=0.0, highest=20.0)
    assert free == pytest.approx(np.array([[0.0, 20.0]]), abs=0.0)
    assert np.all(periodic.pass_bands(**BEAM, support_stiffness=0.0, highest=20.0) == [[0.0, 20.0]])
    # first stop band from n pi to n pi + k_s/(T n pi)
    thin = periodic.pass_bands(**STRING, support_stiffness=1e-9, highest=5.0)
    assert len(thin) == 2
    assert thin[1, 0] - thin[0, 1] == pytest.approx(1e-9 / PI, rel=1e-5)  # rounding of the edges
    assert thin[0, 0] == pytest.approx(np.sqrt(1e-9), rel=1e-6)


def test_thin_pass_bands_are_found() -> None:
    hard = periodic.pass_bands(**STRING, support_stiffness=1e9, highest=10.0)
    assert hard[:, 1] == pytest.approx([PI, 2 * PI, 3 * PI], rel=1e-15)
    # from -1 = cos + k_s/(2 T K) sin
    assert np.diff(hard, axis=1)[:, 0] == pytest.approx(4.0 * PI * np.arange(1, 4) / 1e9, rel=1e-4)  # rounding


def test_rigid_supports_are_the_limit_of_hard_ones() -> None:
    rigid = periodic.pass_bands(**BEAM, support_stiffness=np.inf, highest=100.0)
    # between pinned and clamped single spans
    assert rigid[:2] == pytest.approx(np.array([[PI**2, 22.3732854480], [4 * PI**2, 61.6728228679]]), abs=1e-9)
    hard = periodic.pass_bands(**BEAM, support_stiffness=1e10, highest=70.0)
    assert rigid[:2] == pytest.approx(hard[:2], rel=1e-6)  # EI/(k_s d^3), times the order of the band
    string = periodic.pass_bands(**STRING, support_stiffness=np.inf, highest=10.0)
    assert string == pytest.approx(PI * np.array([[1, 1], [2, 2], [3, 3]]), rel=1e-14)
    inside = periodic.propagation_constant(15.0, **BEAM, support_stiffness=np.inf)
    assert inside == pytest.approx(periodic.propagation_constant(15.0, **BEAM, support_stiffness=1e12)[:1], rel=1e-8)
    assert periodic.propagation_constant([15.0, 30.0], **BEAM, support_stiffness=np.inf).shape == (2, 1)
    with pytest.raises(ValueError, match="rigid"):
        periodic.propagation_constant(15.0, **STRING, support_stiffness=np.inf)


@pytest.mark.parametrize("soft", [0.3, 1.0, 3.0])
def test_lowest_band_of_a_softly_supported_beam_begins_inside_the_diagram(soft: float) -> None:
    def lowest(mu: NDArray[np.float64]) -> NDArray[np.float64]:
        return periodic.band_frequencies(mu, **BEAM, support_stiffness=soft, bands=1)[:, 0]

    coarse = np.linspace(0.0, PI, 1001)
    bottom = int(np.argmin(lowest(coarse)))
    fine = np.linspace(coarse[max(bottom - 1, 0)], coarse[bottom + 1], 1001)
    edge = periodic.pass_bands(**BEAM, support_stiffness=soft, highest=5.0)[0, 0]
    assert edge < lowest(np.zeros(1))[0] < lowest(np.array([PI]))[0]
    assert edge == pytest.approx(np.min(lowest(fine)), rel=1e-13)  # the fine grid misses the bottom by 1e-14


def test_a_pole_hit_exactly_by_bisection_belongs_below() -> None:
    """The first guesses for this string are 2 pi and pi, poles of the compliance at both ends of the diagram."""
    ends = periodic.band_frequencies([0.0, PI], **STRING, support_stiffness=1.0, support_mass=1.0, bands=2)
    k = ends[1, 0]
    assert np.cos(k) + (1 - k**2) / (2 * k) * np.sin(k) == pytest.approx(-1.0, abs=1e-14)
    assert ends[1] == pytest.approx([k, PI])
    assert k < 2.0


def test_dense_supports_are_a_foundation() -> None:
    dense = {"spacing": 0.01, "mass": 2.0, "tension": 3.0, "bending_stiffness": 0.5}
    k = np.array([0.5, 2.0, 5.0])
    found = periodic.band_frequencies(k * 0.01, **dense, support_stiffness=0.07, support_mass=0.004, bands=1)[:, 0]
    bed = np.sqrt((0.5 * k**4 + 3.0 * k**2 + 7.0) / (2.0 + 0.4))
    assert found == pytest.approx(bed, rel=1e-4)  # (k d)^2 times the share of the supports


def test_free_line_has_the_wavenumbers_of_the_bare_line() -> None:
    line = {"mass": 1.3, "tension": 2.0, "bending_stiffness": 0.4}
    omega = np.array([0.5, 1.0, 2.0])
    mu = periodic.propagation_constant(omega, **line, spacing=0.7, support_stiffness=0.0)
    # EI k^4 + T k^2 = m omega^2: a wave to the right, and one that decays
    roots = (-2.0 + np.array([1.0, -1.0]) * np.sqrt(4.0 + 1.6 * 1.3 * omega[:, None] ** 2)) / 0.8 + 0.0j
    k = np.sqrt(roots)
    expected = 0.7 * np.where(k.imag > 0.0, -k, k)
    assert mu == pytest.approx(expected, abs=1e-7)  # a root lost to half of the digits


def test_damping_makes_every_wave_fade() -> None:
    omega = np.linspace(0.5, 30.0, 50)
    for damped in ({"damping": 0.1}, {"support_damping": 0.5}):
        mu = periodic.propagation_constant(omega, **BEAM, support_stiffness=50.0, **damped)
        assert np.all(mu.imag < 0.0)
    assert np.all(np.isfinite(periodic.propagation_constant([1e-6, 1e9], **BEAM, support_stiffness=50.0).real))
    assert not np.any(np.isnan(periodic.propagation_constant([1e-6, 1e9], **BEAM, support_stiffness=50.0)))


def test_diagram_holds_its_bands() -> None:
    diagram = periodic.band_diagram(**BEAM, support_stiffness=50.0, support_mass=0.2, bands=3, points=41)
    assert diagram.propagation[[0, -1]] == pytest.approx([0.0, PI])
    assert diagram.frequency.shape == (41, 3)
    assert np.all(np.diff(diagram.frequency, axis=1) >= 0.0)
    for branch in diagram.frequency.T:
        inside = (branch[:, None] >= diagram.pass_bands[:, 0] * (1 - 1e-13)) & (
            branch[:, None] <= diagram.pass_bands[:, 1] * (1 + 1e-13)
        )
        assert np.all(np.any(inside, axis=1))


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"spacing": 0.0}, "^spacing must"),
        ({"mass": np.nan}, "^mass must"),
        ({"tension": -1.0}, "^tension must"),
        ({"tension": 0.0}, "nothing travels"),
        ({"bending_stiffness": -1.0}, "^bending_stiffness must"),
        ({"support_stiffness": -1.0}, "^support_stiffness must"),
        ({"support_stiffness": np.nan}, "^support_stiffness must"),
        ({"support_mass": -1.0}, "^support_mass must"),
        ({"highest": 0.0}, "^highest must"),
        ({"highest": np.inf}, "^highest must"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        periodic.pass_bands(**(STRING | {"support_stiffness": 4.0, "highest": 5.0} | changed))


def test_nonsense_is_refused_elsewhere() -> None:
    line = STRING | {"support_stiffness": 4.0}
    for call, said in (
        (lambda: periodic.band_frequencies(1.0, bands=0, **line), "^bands must"),
        (lambda: periodic.band_frequencies(np.inf, bands=1, **line), "^propagation must"),
        (lambda: periodic.band_diagram(points=1, **line), "^points must"),
        (lambda: periodic.propagation_constant(0.0, **line), "^frequency must"),
        (lambda: periodic.propagation_constant(np.inf, **line), "^frequency must"),
    ):
        with pytest.raises(ValueError, match=said):
            call()
