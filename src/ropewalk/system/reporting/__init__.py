"""From states to frames of results, and what must not be trusted of them."""
