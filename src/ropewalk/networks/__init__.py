"""Webs: networks of lines, nets and membranes in space."""
