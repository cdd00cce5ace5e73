"""The comparison study: every engine on every scene, as it ships and as well as it can be run."""
