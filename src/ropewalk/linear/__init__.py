"""The standard approach: a scenario answered by the classical theory of small deflections (`run: {kind: linear}`).

Every line is a taut string, or with bending stiffness a beam on two simple supports, along the chord between its
supports, with the mean tension that it has at rest. Its material points move across the chord only, which the loads do
not stretch; deflections of all forces add up. A mass, an oscillator or a vehicle is coupled with its line in both
directions and travels over it alone, with constant speed. This is what the nonlinear answer is compared with: exact
within the theory, and wrong where the theory is (near supports, at finite angles, beyond the wave speed).

What is joined, held on its way or a surface has no closed form, nor have some loads with a mass, as those that start
on a string between its ends or run uphill: there lines swing in the modes of their own stiffness and masses about rest
(`solve/modal.py`, `solve/superposition.py`), in all directions, with what stands on it.
"""
