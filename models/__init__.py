"""The simulated scene: the can, its release, its effects, and the models that engines open."""

from models.body_effects import Damping, PointMass, Shake, Tilt
from models.can import Can
from models.catalogue import hard_names, load, names
from models.contact_effects import (
    Compliance,
    Drilling,
    Restitution,
    RollingResistance,
    RoundedRim,
    Slip,
)
from models.effects import (
    IDEAL,
    KINDS,
    MODELLING_CHOICES,
    NO_SLIP_FRICTION,
    Effects,
    modelling_choices,
)
from models.errors import InvalidValueError, ModelError, SceneFileError, UnknownSceneError
from models.kinematics import (
    RESOLVED_STEP,
    Angles,
    angle_rates,
    angles,
    angles_of_record,
    angular_velocity,
    principal,
    quaternion,
    to_body,
)
from models.mjcf import DEPTH_SENSOR, NET_SENSOR, mjcf
from models.rim import (
    contact_offset,
    contact_point,
    contact_velocity,
    release_state,
    rolling_velocity,
)
from models.scene import Horizon, Scene
from models.scene_file import read_scene, write_scene
from models.state import Pose, Release, Twist
from models.urdf import GROUND_FRICTION, ground_urdf, urdf

__all__ = [
    "DEPTH_SENSOR",
    "GROUND_FRICTION",
    "IDEAL",
    "KINDS",
    "MODELLING_CHOICES",
    "NET_SENSOR",
    "NO_SLIP_FRICTION",
    "RESOLVED_STEP",
    "Angles",
    "Can",
    "Compliance",
    "Damping",
    "Drilling",
    "Effects",
    "Horizon",
    "InvalidValueError",
    "ModelError",
    "PointMass",
    "Pose",
    "Release",
    "Restitution",
    "RollingResistance",
    "RoundedRim",
    "Scene",
    "SceneFileError",
    "Shake",
    "Slip",
    "Tilt",
    "Twist",
    "UnknownSceneError",
    "angle_rates",
    "angles",
    "angles_of_record",
    "angular_velocity",
    "contact_offset",
    "contact_point",
    "contact_velocity",
    "ground_urdf",
    "hard_names",
    "load",
    "mjcf",
    "modelling_choices",
    "names",
    "principal",
    "quaternion",
    "read_scene",
    "release_state",
    "rolling_velocity",
    "to_body",
    "urdf",
    "write_scene",
]
