"""Two ways to draw examples for property tests, for every test there is.

``fixed`` is what `make test` takes: the same examples in every run, so that a change that fails is
the change's own fault. It finds what it found yesterday and nothing else.

``explore`` is what `make explore` takes: five times as many examples from fresh seeds, those that
failed kept in `.hypothesis` and tried first the next time. What it finds becomes part of `fixed`:

1. Hypothesis prints the smallest example that fails, and an `@reproduce_failure` line that brings
   it back in any checkout.
2. Find the mechanism, and write a test of it beside the code that is at fault.
3. Give the example to the property test as `@example(...)` above its `@given`, with a comment on
   what went wrong; it then runs in every `make test`.

A test that costs more than others per example takes a share of the profile's number of examples,
`@settings(max_examples=settings.default.max_examples // 4)`, and so grows with it.
"""

from hypothesis import settings
from hypothesis.database import DirectoryBasedExampleDatabase

# a busy machine fails neither of them
settings.register_profile("fixed", derandomize=True, deadline=None, max_examples=100)
settings.register_profile(
    "explore",
    derandomize=False,
    deadline=None,
    max_examples=500,
    database=DirectoryBasedExampleDatabase(".hypothesis/examples"),
    print_blob=True,
)
# `pytest --hypothesis-profile=explore` takes the other
settings.load_profile("fixed")
