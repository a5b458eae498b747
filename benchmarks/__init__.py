"""Benchmarks: ``python -m benchmarks`` (or ``make bench``) prints them all; see ``--help``."""
