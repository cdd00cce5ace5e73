"""A replay as the page plays it: arrays as coarse as a screen, as many as there are frames."""

import base64
from typing import Any

import numpy as np

from harness.artefact import Floats, Replay


def frames(replay: Replay) -> dict[str, Any]:
    """Return a replay in what JSON can hold.

    Returns
    -------
    dict
        Lengths in radii; angles and places in steps of 1/65535 of their range, a tenth of a pixel
        at most. phi in single precision, as its least value is where the bounce is; times in s, as
        doubles: frames in a bounce are nanoseconds apart.
    """
    middle = _middle(replay)
    return {
        "radius": replay.radius,
        "height": replay.height / replay.radius,
        "tilt": replay.tilt,
        "time": _packed(replay.time, "f8"),
        "bodies": [
            {
                "kind": body.kind,
                "phi": _packed(body.phi, "f4"),
                "psi": _stepped(body.psi),
                "theta": _stepped(body.theta),
                "x": _stepped((body.contact[:, 0] - middle[0]) / replay.radius),
                "y": _stepped((body.contact[:, 1] - middle[1]) / replay.radius),
            }
            for body in replay.bodies
        ],
    }


def _middle(replay: Replay) -> Floats:
    """Return the middle of the first can's locus, from which positions are measured."""
    contact = replay.bodies[0].contact
    middle: Floats = (np.nanmin(contact, axis=0) + np.nanmax(contact, axis=0)) / 2.0
    return middle


_STEPS = 65535


def _stepped(values: Floats) -> dict[str, Any]:
    """Return numbers in two bytes each, of a range that has no gap; else in four."""
    if not np.isfinite(values).all():
        return _packed(values, "f4")
    low, width = float(values.min()), float(np.ptp(values))
    step = width / _STEPS if width > 0.0 else 1.0
    return {**_packed(np.rint((values - low) / step), "u2"), "low": low, "step": step}


def _packed(values: Floats, kind: str) -> dict[str, Any]:
    data = base64.b64encode(np.asarray(values).astype(f"<{kind}").tobytes()).decode("ascii")
    return {"dtype": kind, "bdata": data}
