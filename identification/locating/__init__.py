"""Where along the beam the missing force acts, how it runs in time, and its shape over the motion there."""
