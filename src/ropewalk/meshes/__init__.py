"""How far a result is from the continuum: coarser meshes beside it, and meshes chosen for an accuracy."""
