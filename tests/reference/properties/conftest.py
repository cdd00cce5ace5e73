"""The same examples in every run, and a busy machine does not fail them."""

from hypothesis import settings

settings.register_profile("reference", derandomize=True, deadline=None, max_examples=60)
settings.load_profile("reference")
