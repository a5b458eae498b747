"""The matrix of what works: scenarios made of the vocabulary, each with a verdict; `python -m tests.conformance`."""
