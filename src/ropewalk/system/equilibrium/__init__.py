"""Rest under loads, and slow motion from rest to rest."""
