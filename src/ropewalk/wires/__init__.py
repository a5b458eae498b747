"""Wires: lines with bending stiffness under tension, without rotations as unknowns, and what is tied to them.

The nodes are the control points of a uniform cubic B-spline, and the spline is the wire: whatever is attached or
travels pulls at the spline and is shared by its four control points. See docs/notes/wires.md.
"""
