"""Models of somebody else's: the step protocol, how a line and a model take turns, and adapters."""
