"""Spoilt scenario files, by the thousand: each is read or refused, and nothing else happens."""
