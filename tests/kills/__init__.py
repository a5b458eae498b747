"""Commands that are killed at any moment, and taken up again."""
