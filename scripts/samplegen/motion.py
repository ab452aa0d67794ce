"""Hands: one takes the pump through the bay in ten seconds, pressing where it should not; one lifts a
part of the gearbox off.

world_from_handle at 100 Hz as `t_s,x_m,y_m,z_m,qw,qx,qy,qz`; the grip is the pump's own frame.
Commanded poses go 6 to 8 mm into the exact surfaces, so that forces build up.
"""

import math

RATE_HZ = 100

# (end time in s, position in mm, turn about z in degrees, tilt about x in degrees)
PRESS = [
    (0.0, (280, 0, 500), 0, 0),
    (0.2, (280, 0, 500), 0, 0),        # free space above the floor
    (1.2, (280, 0, 303), 0, 0),        # down through the opening
    (1.9, (280, 205, 303), 0, 0),      # against the left floor beam's lower flange, 8 mm deep
    (2.5, (280, 205, 303), 0, 0),
    (3.1, (200, 20, 310), 0, 0),
    (3.7, (50, 0, 330), 0, 0),         # under the floor plate
    (4.1, (50, 0, 358), 0, 0),         # up against it, 6 mm deep
    (5.2, (-150, 0, 358), 0, 0),       # slide along it
    (5.6, (-150, 0, 310), 0, 0),
    (6.0, (-150, -100, 290), 0, 0),    # above the hydraulic line
    (6.5, (-150, -100, 232), 0, 0),    # down on it, 8 mm deep
    (7.3, (-150, -100, 232), 60, 15),  # turn on it
    (7.7, (-150, -100, 300), 60, 15),
    (8.9, (280, 0, 310), 0, 0),        # back to the opening
    (9.8, (280, 0, 500), 0, 0),        # and out
    (10.0, (280, 0, 500), 0, 0),
]

LIFT = [
    (0.0, (0, 0, 0), 0, 0),  # the assembly's own frame: where each part of it is installed
    (0.3, (0, 0, 0), 0, 0),
    (2.3, (0, 0, 60), 0, 0),
    (2.5, (0, 0, 60), 0, 0),
]


def _ease(t):
    """Minimum-jerk fraction of the way: at rest at both ends."""
    return t * t * t * (10 - 15 * t + 6 * t * t)


def _pose_at(keys, time_s):
    for before, after in zip(keys, keys[1:]):
        if time_s <= after[0]:
            fraction = _ease((time_s - before[0]) / (after[0] - before[0]))
            mix = lambda a, b: a + (b - a) * fraction
            position = [mix(a, b) for a, b in zip(before[1], after[1])]
            return position, mix(before[2], after[2]), mix(before[3], after[3])
    raise ValueError(f"no key after {time_s} s")


def _quaternion(turn_deg, tilt_deg):
    """Tilt about x, then turn about z."""
    a, b = math.radians(turn_deg) / 2, math.radians(tilt_deg) / 2
    return (math.cos(a) * math.cos(b), math.cos(a) * math.sin(b), math.sin(a) * math.sin(b),
            math.sin(a) * math.cos(b))


def motion_csv(keys):
    lines = ["t_s,x_m,y_m,z_m,qw,qx,qy,qz"]
    for tick in range(round(keys[-1][0] * RATE_HZ) + 1):
        time_s = tick / RATE_HZ
        position, turn, tilt = _pose_at(keys, time_s)
        # Adding zero turns -0 into 0: the sign of a zero is not the same on every machine.
        numbers = [f"{round(c / 1000, 6) + 0.0:.6f}" for c in position]
        numbers += [f"{round(c, 9) + 0.0:.9f}" for c in _quaternion(turn, tilt)]
        lines.append(",".join([f"{time_s:.2f}", *numbers]))
    return "\n".join(lines) + "\n"
