"""Motion: one loop of kicks and drifts, implicit methods on the same state, and what goes on around them."""
