"""boxes() and cracked_box(): meshes of boxes for the tests of the commands."""

FACES = (-8, -6, -5, -7), (-4, -3, -1, -2), (-8, -7, -3, -4), (-6, -2, -1, -5), (-8, -4, -2, -6), (-7, -5, -1, -3)


def boxes(name, *low_high):
    """Writes an OBJ file of boxes, each given by its lowest and its highest corner."""
    with open(name, "w", encoding="ascii") as obj:
        for corners in low_high:
            for n in range(8):
                obj.write("v %g %g %g\n" % tuple(corners[n >> axis & 1][axis] for axis in range(3)))
            obj.writelines("f %d %d %d %d\n" % face for face in FACES)


def cracked_box(name, low, high, crack):
    """Writes an OBJ file of one box whose side towards +x stands off by `crack`: no two sides share a corner."""
    with open(name, "w", encoding="ascii") as obj:
        for face in FACES:
            side = [[(low, high)[8 + corner >> axis & 1][axis] for axis in range(3)] for corner in face]
            is_off = all(corner[0] == high[0] for corner in side)
            for x, y, z in side:
                obj.write("v %.9g %g %g\n" % (x + crack if is_off else x, y, z))
            obj.write("f -4 -3 -2 -1\n")
