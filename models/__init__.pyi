from .body_effects import Damping, PointMass, Shake, Tilt
from .can import Can
from .catalogue import hard_names, load, names
from .contact_effects import (
    AirFilm,
    Compliance,
    ContourFriction,
    Drilling,
    Restitution,
    RollingResistance,
    RoundedRim,
    Slip,
)
from .effects import (
    IDEAL,
    KINDS,
    MODELLING_CHOICES,
    NO_SLIP_FRICTION,
    Effects,
    modelling_choices,
)
from .errors import (
    InvalidValueError,
    ModelError,
    RecordShapeError,
    SceneFileError,
    UnknownSceneError,
)
from .kinematics import (
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
from .release import Release
from .rim import (
    contact_offset,
    contact_point,
    contact_velocity,
    release_state,
    rolling_velocity,
)
from .scene import Horizon, Scene
from .scene_file import read_scene, write_scene
from .state import Pose, Twist
from .to_mjcf import DEPTH_SENSOR, NET_SENSOR, mjcf
from .to_urdf import GROUND_FRICTION, ground_urdf, urdf

__all__ = [
    "DEPTH_SENSOR",
    "GROUND_FRICTION",
    "IDEAL",
    "KINDS",
    "MODELLING_CHOICES",
    "NET_SENSOR",
    "NO_SLIP_FRICTION",
    "RESOLVED_STEP",
    "AirFilm",
    "Angles",
    "Can",
    "Compliance",
    "ContourFriction",
    "Damping",
    "Drilling",
    "Effects",
    "Horizon",
    "InvalidValueError",
    "ModelError",
    "PointMass",
    "Pose",
    "RecordShapeError",
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
