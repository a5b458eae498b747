"""Networks of lines, nets and membranes in space."""
