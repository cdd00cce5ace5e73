"""What each effect supposes beyond its name, a sentence each: another model might choose otherwise.

The one place of these sentences: the pages of reports and the answers of the command line quote it,
and the classes of the effects say the same beside their laws.
"""

from types import MappingProxyType

from models.effects import Effects

MODELLING_CHOICES = MappingProxyType(
    {
        "slip": (
            "Friction has one coefficient, static equal to kinetic, and a cone of its own: what "
            "drilling and rolling resistance take is not taken from it."
        ),
        "compliance": (
            "A compliant contact is a linear spring and damper that never pulls, whatever the "
            "depth and its rate."
        ),
        "restitution": (
            "An impact gives back the same share of the normal velocity however fast it is "
            "(Newton's law)."
        ),
        "drilling": (
            "Drilling friction has a limit of its own, its arm times the normal force, beside the "
            "cone of friction, and holds with as large a moment as it slows with."
        ),
        "rolling_resistance": (
            "Rolling resistance has a limit of its own, its arm times the normal force, beside the "
            "cone of friction, and holds with as large a moment as it slows with."
        ),
        "damping": (
            "Drag is against the motion relative to the plane, also where the plane is shaken: the "
            "air is supposed to move with it; its linear part acts at the centre of mass."
        ),
        "rim": (
            "A rounded rim is a rigid arc inside the declared radius and height; mass and moments "
            "stay as declared."
        ),
        "tilt": "A tilted plane is a tilted gravity in the frame of the plane.",
        "shake": (
            "A shaken plane is a gravity that changes with time in the frame of the plane: the "
            "release and every velocity are relative to it."
        ),
        "point_mass": (
            "A point mass is added to the mass and the moments of the can, which stay as declared."
        ),
    }
)
"""By the keys of the effects in a scene file."""


def modelling_choices(effects: Effects) -> tuple[str, ...]:
    """Return a sentence for each effect that is declared, in the order of the fields."""
    return tuple(MODELLING_CHOICES[name] for name in effects.declared())
