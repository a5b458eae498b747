"""Questions that many runs answer: the best design, what matters, unknown values from measured ones, gradients."""
