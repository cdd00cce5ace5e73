"""Periodic functions by their harmonics: integrals term by term, exact to round-off."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct

from reference.states import Floats

# Harmonics below this share of the greatest cannot be told from round-off.
SILENT = 1e-16


@dataclass(frozen=True, slots=True, kw_only=True)
class Harmonics:
    """An integral over u: slope u + sum of waves sin(k pi u/K)."""

    slope: float
    waves: Floats

    def at(self, phase: Floats) -> Floats:
        """Value at u = phase K, shape of `phase`."""
        k = np.arange(1, self.waves.size + 1)
        return np.asarray(self.slope * phase + np.sin(np.pi * phase[:, None] * k) @ self.waves)


def harmonics_of(rate: Floats) -> Harmonics:
    """Integrate an even periodic function given at the midpoints of [0, 1] in u/K."""
    n = rate.size
    waves = dct(rate)[1:] / (n * np.pi * np.arange(1, n))
    heard = np.flatnonzero(np.abs(waves) > SILENT * np.abs(waves).max(initial=0.0))
    last = int(heard[-1]) + 1 if heard.size else 0
    return Harmonics(slope=float(rate.mean()), waves=waves[:last])


def locus_harmonics(rotation: Floats, precession: Harmonics) -> NDArray[np.complex128]:
    """Fourier coefficients of theta' exp(i (psi - mean)), from midpoints of a half period."""
    n = rotation.size
    phase = (np.arange(-n, n) + 0.5) / n
    wobble = precession.at(phase) - precession.slope * phase
    signal = np.concatenate([rotation[::-1], rotation]) * np.exp(1j * wobble)
    # the first midpoint is at -1 + 1/(2 n): a half turn back, and half a step on, in every wave
    shift = np.exp(-1j * np.pi * np.arange(-n, n) * phase[0])
    return np.asarray(shift * np.fft.fftshift(np.fft.fft(signal)) / (2 * n))
