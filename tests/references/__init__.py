"""References: traces and numbers of every case of the matrix and every example, and the comparison with them."""
