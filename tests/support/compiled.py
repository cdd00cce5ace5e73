"""What the tests of compiled code need."""

import os

import pytest

from reference.numerics.compiled import available

# continuous integration installs numba with the tests: there they fail without it
needs_numba = pytest.mark.skipif(
    not available() and os.environ.get("CI") != "true",
    reason="numba, the extra `fast`, is missing",
)
