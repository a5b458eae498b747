"""ropewalk: what travels along slender flexible structures."""

__version__ = "0.1.0"
