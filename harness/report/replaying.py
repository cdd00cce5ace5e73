"""A replay as the page plays it: arrays of single precision, as many as there are frames."""

import base64
from typing import Any

import numpy as np

from harness.artefact import Floats, Replay


def frames(replay: Replay) -> dict[str, Any]:
    """Return a replay in what JSON can hold.

    Returns
    -------
    dict
        Lengths in radii, so that what single precision rounds is far below a pixel; times in s,
        as doubles: frames in a bounce are nanoseconds apart.
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
                "phi": _packed(body.phi),
                "psi": _packed(body.psi),
                "theta": _packed(body.theta),
                "x": _packed((body.contact[:, 0] - middle[0]) / replay.radius),
                "y": _packed((body.contact[:, 1] - middle[1]) / replay.radius),
            }
            for body in replay.bodies
        ],
    }


def _middle(replay: Replay) -> Floats:
    """Return the middle of the first can's locus, from which positions are measured."""
    contact = replay.bodies[0].contact
    middle: Floats = (np.nanmin(contact, axis=0) + np.nanmax(contact, axis=0)) / 2.0
    return middle


def _packed(values: Floats, kind: str = "f4") -> dict[str, str]:
    data = base64.b64encode(np.asarray(values).astype(f"<{kind}").tobytes()).decode("ascii")
    return {"dtype": kind, "bdata": data}
