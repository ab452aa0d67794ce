"""Generators of the sample scene: solids, mesh files, the bay, the part and a hand motion.

Python's standard library alone; lengths in millimetres; right-handed frames, z up.
"""
