"""Does the accuracy knob tell the truth: the error asked for against the error delivered."""
