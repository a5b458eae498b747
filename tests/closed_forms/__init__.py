"""Closed forms that only tests compare with; those that commands compare with are in `ropewalk.theory`."""
