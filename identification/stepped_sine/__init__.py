"""Steady vibration under a sine whose frequency is stepped: first harmonics, and what they say about missing physics.

A stepped-sine test leaves, for every frequency, the amplitude of the force and the amplitude and phase of the
response. Such lines hold no time history that could be simulated against a measured force; the model's own steady state
is found by harmonic balance instead, with the same laws that the time stepper moves.
"""
