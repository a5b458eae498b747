"""The engine whose step loop is compiled ahead of time."""
