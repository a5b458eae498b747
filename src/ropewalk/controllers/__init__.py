"""Guides: who decide on the way what loads do that have a gait, or a model, of their own; whatever the engine."""
