"""Overhead lines: from their declaration to a plan of wires, dropper lengths, elasticity, and pantographs on them."""
