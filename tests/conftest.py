"""Set-up of all tests."""

import os

from hypothesis import settings

# The same examples in every run, so that a green tree stays green; HYPOTHESIS_PROFILE=default looks for new ones.
settings.register_profile("repeatable", derandomize=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))
