"""Products A diag(c) B whose pattern is found once, beside those of SciPy."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sparse

from ropewalk.system.elements.link_forms import Products, scaled


@pytest.mark.parametrize(("rows", "factors", "columns"), [(7, 5, 9), (1, 3, 2), (4, 6, 4), (3, 0, 2)])
def test_it_is_the_product_for_all_factors(rows: int, factors: int, columns: int) -> None:
    numbers = np.random.default_rng(rows)
    A, B = (sparse.random(*shape, 0.5, rng=numbers) for shape in ((rows, factors), (factors, columns)))
    product = Products(A, B)
    for _ in range(2):
        c = numbers.normal(size=factors)
        found = product.of(c)
        assert found.has_canonical_format
        assert found.toarray() == pytest.approx(A.toarray() * c @ B.toarray(), abs=1e-15)


def test_rows_are_scaled() -> None:
    rows = sparse.csr_matrix([[1.0, 0.0, 2.0], [0.0, 0.0, 0.0], [3.0, 4.0, 0.0]])
    assert scaled(rows, np.array([2.0, 5.0, -1.0])).toarray().tolist() == [[2, 0, 4], [0, 0, 0], [-3, -4, 0]]
