"""Cross-check of the switchid FMUs: plant and identifier stepped together under fmpy, gated and reported.

Sees only `.fmu` files. The truth (a scenario's parameters) is known to the plant and to the figures, never to an
identifier.
"""
