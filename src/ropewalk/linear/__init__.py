"""Linear theory of small deflections (`run: {kind: linear}`), with which the nonlinear answer is compared.

Every line is a taut string or a simply supported beam along its chord, with its mean tension at rest; loads do not
stretch it, and their deflections add up. A load with a mass is coupled with its line in both directions, alone and at
constant speed. Structures without closed forms swing in the modes of their own stiffness and masses about equilibrium
(`solve/modal.py`, `solve/superposition.py`).
"""
