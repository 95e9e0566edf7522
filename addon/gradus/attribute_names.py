"""Prefixes of the names under which materials read attributes of instances."""

OBJECT = "object:"
"""Properties of the instance's object."""
INSTANCER = "instancer:"
"""What the instancer gives an instance, or else properties of its object."""
PARTICLE = "particle:"
"""Outputs of Particle Info."""
