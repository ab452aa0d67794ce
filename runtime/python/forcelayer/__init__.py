"""Forcelayer: how near does this part come to what?

Opens what `voxelize` and `pointshell` baked, asks for clearance at many poses at once, and steps or
replays the haptic simulation. Lengths are meters; a pose is x y z and a quaternion qw qx qy qz.

>>> import forcelayer
>>> scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
>>> frames = forcelayer.replay(scene, part, "run.flr").frames
>>> clearance = scene.clearance(part, frames["world_from_part"])["clearance_m"]
>>> clearance.shape == frames.shape
True
"""

try:
    import numpy as _numpy  # the extension asks for it in fewer words
except ModuleNotFoundError as _missing:
    raise ImportError("forcelayer needs numpy: install python3-numpy, or pip install numpy") from _missing

from ._forcelayer import (Error, Moment, Part, Replay, Scene, Simulation, __version__, replay)

__all__ = ["Error", "Moment", "Part", "Replay", "Scene", "Simulation", "replay"]
