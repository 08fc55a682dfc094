"""A benchmark of the diagnosis: an effect is hidden in a random rig, and what is found is held against the truth."""
