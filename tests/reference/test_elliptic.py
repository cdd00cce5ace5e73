"""The elliptic clock against forty digits."""

import mpmath as mp
import numpy as np
import pytest

from reference.integrable.elliptic import EllipticSubstitution, squared_sn_cn

FRACTIONS = np.linspace(0.01, 0.99, 9)[:, None]


@pytest.mark.parametrize("complementary", [1e-24, 1e-9, 0.1, 0.45, 0.6, 0.99])
def test_squares_to_relative_round_off(complementary: float) -> None:
    sn2, cn2 = squared_sn_cn(FRACTIONS, np.array([complementary]))
    with mp.workdps(40):
        m = 1 - mp.mpf(complementary)
        for row, fraction in enumerate(FRACTIONS[:, 0].tolist()):
            u = mp.mpf(fraction) * mp.ellipk(m)
            # some forty operations, and theta functions of arguments up to 15
            assert sn2[row, 0] == pytest.approx(
                float(mp.ellipfun("sn", u, m=m) ** 2), rel=1e-14, abs=0
            )
            assert cn2[row, 0] == pytest.approx(
                float(mp.ellipfun("cn", u, m=m) ** 2), rel=1e-14, abs=0
            )


@pytest.mark.parametrize("low", [1e-12, 1e-3, 0.2])
def test_nutation_obeys_its_equation(low: float) -> None:
    """dphi/du against the quartic, by central differences, and the two distances against phi."""
    clock = EllipticSubstitution(
        low=np.array([low]),
        high=np.array([0.3]),
        swing=np.array([0.3 - low]),
        fourth_root=np.array([0.31]),
    )
    K, step = clock.quarter, 1e-6
    before, now, after = (clock.nutation(FRACTIONS + d) for d in (-step, 0.0, step))
    slope = (after[0] - before[0]) / (2 * step * K)
    phi, rise, gap = now
    quartic = rise * (phi + low) * gap * (0.01 + gap)
    # the difference errs by step^2 K^2 phi''' and by round-off over the step
    assert np.allclose(slope, clock.scale * np.sqrt(quartic), rtol=1e-7)
    assert np.allclose(rise + gap, 0.3 - low, rtol=1e-14)
