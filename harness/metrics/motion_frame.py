"""A motion as a tidy table: a row a sample, units in the column names."""

import pandas as pd

from harness.metrics.motion import Motion


def motion_frame(motion: Motion) -> pd.DataFrame:
    """Return a motion as a DataFrame, in the paper's terms and in SI units."""
    angles, trajectory = motion.angles, motion.trajectory
    columns = {"t_s": motion.time}
    for name in ("phi", "psi", "theta"):
        columns[f"{name}_rad"] = getattr(angles, name)
    for name in ("phi", "psi", "theta"):
        columns[f"{name}_dot_rad_s"] = getattr(angles, f"{name}_dot")
    for axis, letter in enumerate("xyz"):
        columns[f"{letter}_m"] = trajectory.position[:, axis]
    for axis, letter in enumerate("wxyz"):
        columns[f"quaternion_{letter}"] = trajectory.quaternion[:, axis]
    for axis, letter in enumerate("xy"):
        columns[f"contact_{letter}_m"] = motion.locus[:, axis]
    for axis, letter in enumerate("xyz"):
        columns[f"force_{letter}_N"] = trajectory.contact_force[:, axis]
    columns["friction_ratio"] = motion.friction_ratio
    columns["slip_m_s"] = motion.slip
    columns["penetration_m"] = trajectory.penetration
    return pd.DataFrame(
        {
            **columns,
            "contact_count": trajectory.contact_count,
            "psi_unresolved": angles.unresolved,
        }
    )
