"""Property tests: relations that mechanics guarantees between the results of two related scenarios."""
