"""External models: the step protocol, how a line and a model take turns, and adapters."""
