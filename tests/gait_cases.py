"""The gait of theory section 9, which several files of tests compare with: found once in a process."""

from __future__ import annotations

import numpy as np

from closed_forms import spring_legs

# 80 kg, 1 m, 14 kN/m, 69 degrees, 816 J.
LEGS = spring_legs.SpringLegs(mass=80.0, leg_length=1.0, stiffness=14e3, attack_angle=np.radians(69.0))
GAIT = spring_legs.gaits(LEGS, energy=816.0)[0]
