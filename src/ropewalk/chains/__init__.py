"""Plain ropes: from a scenario to a motion, a slow motion or a rest of chains, and to the frames of its result."""
