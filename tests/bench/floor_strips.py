#!/usr/bin/env python3
"""Writes ggx.obj and phong.obj: a polished floor in five strips before a standing lamp, for the table of highlights.

Usage: floor_strips.py FOLDER
"""
import pathlib
import sys

LAMP = [(-2.5, 0.4, -2.2), (2.5, 0.4, -2.2), (2.5, 1.4, -2.2), (-2.5, 1.4, -2.2)]
FLOORS = {
    "ggx": ["Ks .04 .04 .04\nPr %g\nPm .5" % roughness for roughness in (0.25, 0.35, 0.5, 0.7, 0.95)],
    "phong": ["illum 2\nKs .5 .5 .5\nNs %d" % exponent for exponent in (10, 24, 60, 200, 800)],
}


def write_scene(folder, name, strips):
    width = 6 / len(strips)
    quads = []
    materials = []
    for i, strip in enumerate(strips):
        left = -3 + width * i
        right = left + width
        quads.append(("strip%d" % i, [(left, 0, 3), (right, 0, 3), (right, 0, -2), (left, 0, -2)]))
        materials.append("newmtl strip%d\nKd .2 .2 .2\n%s\n" % (i, strip))
    quads.append(("lamp", LAMP))
    materials.append("newmtl lamp\nKd 0 0 0\nKe 4 4 4\n")
    lines = ["mtllib %s.mtl" % name]
    for i, (material, corners) in enumerate(quads):
        lines += ["v %g %g %g" % corner for corner in corners]
        lines += ["usemtl " + material, "f %d %d %d %d" % tuple(4 * i + k for k in (1, 2, 3, 4))]
    (folder / (name + ".obj")).write_text("\n".join(lines) + "\n")
    (folder / (name + ".mtl")).write_text("".join(materials))


if len(sys.argv) != 2:
    sys.exit(__doc__.strip())
for scene, strips in FLOORS.items():
    write_scene(pathlib.Path(sys.argv[1]), scene, strips)
