"""Spectrum of the straight chain, "Walking the Line. Traveling Forces vs Moving Masses", eq. 12.

Reference numbers are derived in docs/notes.
"""

import numpy as np
import pytest

from ropewalk.theory import chain

CHAIN = {"links": 50, "length": 20.0, "axial_stiffness": 1e4, "mass": 0.1, "stretch": 1.02}


@pytest.mark.parametrize(
    ("law", "lowest", "highest"),
    [("hooke", 6.954458951426, 1580.358633518), ("second_piola_kirchhoff", 7.023659252, 1611.655902)],
)
def test_extreme_frequencies_are_those_of_the_catalogue(law: chain.AxialLaw, lowest: float, highest: float) -> None:
    across = chain.transverse_frequencies(**CHAIN, law=law)
    along = chain.longitudinal_frequencies(**CHAIN, law=law)
    # half a unit of the last digit given
    assert across[0] == pytest.approx(lowest, abs=5e-13 if law == "hooke" else 5e-10)
    assert along[-1] == pytest.approx(highest, abs=5e-10 if law == "hooke" else 5e-7)


def test_ratio_of_extremes_grows_with_the_cotangent() -> None:
    ratio = chain.longitudinal_frequencies(**CHAIN)[-1] / chain.transverse_frequencies(**CHAIN)[0]
    assert ratio == pytest.approx(227.244, abs=5e-4)  # 6 digits are given
    # T' lam / T = 1.02 / 0.02
    assert ratio == pytest.approx(np.sqrt(51.0) / np.tan(np.pi / 100), rel=1e-13)  # roundings


@pytest.mark.parametrize("law", ["hooke", "second_piola_kirchhoff"])
def test_frequencies_are_the_eigenvalues_of_the_second_energy_derivative(law: chain.AxialLaw) -> None:
    """The Hessian of the links' energy, written down by hand and fed to an eigenvalue solver."""
    n, h, stiffness, mass, lam = 7, 3.0 / 7, 1e4, 0.1, 1.3
    tension = stiffness * (lam - 1) * (1.0 if law == "hooke" else lam)
    tangent = stiffness * (1.0 if law == "hooke" else 2 * lam - 1)
    shape = 2 * np.eye(n - 1) - np.eye(n - 1, k=1) - np.eye(n - 1, k=-1)
    given = {
        "links": n,
        "length": 3.0,
        "axial_stiffness": stiffness,
        "mass": mass,
        "stretch": lam,
        "law": law,
    }
    for frequencies, spring in (
        (chain.transverse_frequencies(**given), tension / (lam * h)),
        (chain.longitudinal_frequencies(**given), tangent / h),
    ):
        expected = np.sqrt(np.linalg.eigvalsh(spring * shape / (mass * h)))
        assert frequencies == pytest.approx(expected, rel=1e-12)  # accuracy of the eigenvalue solver


def test_many_links_sound_like_the_string() -> None:
    many = chain.transverse_frequencies(**{**CHAIN, "links": 5000})[:3]
    c = np.sqrt(1e4 * 0.02 / (1.02 * 0.1))
    assert many == pytest.approx(np.pi * c / 20.0 * np.arange(1, 4), rel=2e-7)  # (j pi / 2n)^2 / 6


def test_limits_are_values_and_not_nan() -> None:
    slack = {**CHAIN, "stretch": 1.0}
    assert np.all(chain.transverse_frequencies(**slack) == 0.0)
    assert chain.transverse_frequencies(**{**CHAIN, "links": 1}).size == 0
    limp = {**CHAIN, "stretch": 0.5, "law": "second_piola_kirchhoff"}
    assert np.all(chain.longitudinal_frequencies(**limp) == 0.0)
    assert np.all(np.diff(chain.transverse_frequencies(**CHAIN)) > 0.0)
    for stiffness in 10.0 ** np.arange(0, 9):
        frequencies = chain.transverse_frequencies(**{**CHAIN, "axial_stiffness": stiffness})
        reference = chain.transverse_frequencies(**CHAIN) * np.sqrt(stiffness / 1e4)
        assert frequencies == pytest.approx(reference, rel=1e-14)  # roundings


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"stretch": 0.99}, "compression"),
        ({"links": 0}, "^links must"),
        ({"mass": 0.0}, "^mass must"),
        ({"length": -1.0}, "^length must"),
        ({"axial_stiffness": np.nan}, "^axial_stiffness must"),
        ({"law": "hook"}, "^law must"),
    ],
)
def test_nonsense_is_refused(changed: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        chain.transverse_frequencies(**(CHAIN | changed))


def test_softening_law_is_refused_along_the_chain() -> None:
    with pytest.raises(ValueError, match="softens"):
        chain.longitudinal_frequencies(**{**CHAIN, "stretch": 0.4}, law="second_piola_kirchhoff")
    with pytest.raises(ValueError, match="law"):
        chain.longitudinal_frequencies(**CHAIN, law="none")
