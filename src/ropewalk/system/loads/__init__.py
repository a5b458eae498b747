"""Loads: bodies at contacts, payloads, carriages and what hauls them, crabs."""
