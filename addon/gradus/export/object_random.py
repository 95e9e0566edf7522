"""Random numbers of objects and particles, which are hashes as in Cycles."""

from __future__ import annotations


def name_hash(name: str) -> int:
    """Returns Object Info > Random of an object that is no instance, in 32 bits.

    It is a multiplicative hash of the bytes of the name, followed by a mixing step.

    The mixing step is final() of lookup3 by Bob Jenkins (public domain), with a second word of 0.
    """
    value = 0
    for byte in name.encode("utf-8", "surrogateescape"):
        value = (value * 37 + byte) & 0xFFFFFFFF
    return _mix(value)


def unit_hash(value: int) -> float:
    """Returns Particle Info > Random of a particle's index, in 0…1."""
    return _mix(value) / 0xFFFFFFFF


def _rotate(value: int, bits: int) -> int:
    return ((value << bits) | (value >> (32 - bits))) & 0xFFFFFFFF


def _mix(value: int) -> int:
    start = (0xDEADBEEF + (2 << 2) + 13) & 0xFFFFFFFF
    a, b, c = (start + value) & 0xFFFFFFFF, start, start
    for bits in ((14, 11, 25), (16, 4, 14, 24)):
        for step, count in enumerate(bits):
            target = step % 3
            if target == 0:
                c = ((c ^ b) - _rotate(b, count)) & 0xFFFFFFFF
            elif target == 1:
                a = ((a ^ c) - _rotate(c, count)) & 0xFFFFFFFF
            else:
                b = ((b ^ a) - _rotate(a, count)) & 0xFFFFFFFF
    return c
