"""Small motion about rest: spectra, and superposition of modes."""
