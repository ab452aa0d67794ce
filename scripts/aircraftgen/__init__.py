"""Generator of a large CAD-like scene: the underfloor bay of an aircraft, 8 m long.

Needs numpy; lengths in millimetres; right-handed frames, x along the bay, z up.
"""
