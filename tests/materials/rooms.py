"""Furnishes five lit rooms in Blender, as an artist would, and renders them with Cycles, for room_sheet.py:

    blender --background --factory-startup --python rooms.py -- JOBS.json

JOBS.json: what cycles_picture.py takes, and rooms, each with a name, the .blend to save and the pictures to write by
different seeds, which are kept if they exist. Axes are Blender's, z up, and metres; a room is x from -w/2 to w/2 and y from
0, where the camera stands, to d. Radiance 1 is white: the lamps are as bright as that asks for.
"""
import json
import math
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from cycles_picture import write_picture  # noqa: E402
from furniture import (BRASS, BRUSHED, CHROME, GLASS, ball, box, camera, chair, floor, frame_window, head, light,
                      material, matt, painting, planks, rod, shell, stripes, table, tiles, turned, vase, world)  # noqa: E402

ROOMS = {}


def room(function):
    ROOMS[function.__name__] = function


@room
def office():
    """Two area lights under the ceiling."""
    world((0, 0, 0))
    white = matt(0.75, 0.75, 0.72)
    shell(4.6, 5, 2.7, {"left": matt(0.18, 0.38, 0.42), "right": white,
                       "back": white, "front": white, "ceiling": matt(0.8, 0.8, 0.8)})
    floor(4.6, 5, material((1, 1, 1), 0.35, texture=planks((0.72, 0.52, 0.34))), 0.5)
    for y in (1.1, 2.9):
        light("AREA", (0, y, 2.66), 55, (1, 0.96, 0.9), shape="RECTANGLE", size=1.5, size_y=0.4)
    wood = material((0.42, 0.24, 0.12), 0.4)
    table((-0.7, 2.6, 0), (1.7, 0.8, 0.74), wood, BRUSHED())
    chair((0.1, 3.8, 0), 0.35, material((0.6, 0.08, 0.06), 0.6), BRUSHED())
    box((0.05, 2.95, 0.74), (0.3, 0.2, 0.02), BRUSHED())
    box((-0.07, 3.05, 0.86), (0.54, 0.03, 0.33), material((0.02, 0.02, 0.025), 0.1))
    rod((0.2, 3.09, 0.74), (0.2, 3.09, 0.9), 0.02, BRUSHED())
    vase((-0.45, 2.9, 0.74), 0.26, material((0.1, 0.25, 0.6), 0.1))
    ball((0.75, 2.85, 0.84), 0.1, CHROME())
    box((1.5, 3.2, 0), (0.7, 1.7, 1.9), material((0.75, 0.73, 0.68), 0.5), bevel=0.01)
    for z in (0.5, 1.0, 1.45):
        box((1.48, 3.25, z), (0.03, 1.6, 0.02), BRUSHED())
    painting((-1.6, 4.96, 1.1), (1.1, 0.9), [(0.9, 0.75, 0.2), (0.8, 0.3, 0.2), (0.2, 0.3, 0.5), (0.9, 0.9, 0.85)])
    box((-2.2, 4.3, 0), (0.45, 0.45, 0.4), material((0.5, 0.5, 0.5), 0.7))
    head((-1.97, 4.52, 0.68), 0.45, 0.6, material((0.75, 0.45, 0.2), 0.3))
    camera((0.6, 0.35, 1.55), (-0.15, 3.6, 0.95), 58)


@room
def bedroom():
    """Point lamps: a pendant under the ceiling, and one beside the bed."""
    world((0, 0, 0))
    wall = matt(0.62, 0.55, 0.48)
    shell(4.2, 4.6, 2.6, {"left": wall, "right": matt(0.45, 0.16, 0.14),
                       "back": wall, "front": wall, "ceiling": matt(0.8, 0.8, 0.78)})
    floor(4.2, 4.6, material((1, 1, 1), 0.5, texture=planks((0.5, 0.36, 0.24))), 0.5)
    light("POINT", (0, 2.2, 2.0), 90, (1, 0.85, 0.65), shadow_soft_size=0.06)
    light("POINT", (1.72, 4.2, 0.92), 25, (1, 0.75, 0.45), shadow_soft_size=0.04)
    turned((0, 2.2, 2.08), ((0.02, 0.19), (0.07, 0.18), (0.22, 0.01), (0.24, 0), (0.08, 0.2), (0.02, 0.21)),
           material((0.25, 0.3, 0.28), 0.4))
    rod((0, 2.2, 2.28), (0, 2.2, 2.6), 0.008, matt(0.05, 0.05, 0.05))
    cloth, linen = matt(0.2, 0.28, 0.42), matt(0.8, 0.78, 0.74)
    wood = material((0.35, 0.2, 0.1), 0.35)
    box((-0.4, 2.5, 0.08), (1.7, 2.05, 0.2), wood, bevel=0.02)
    box((-0.37, 2.53, 0.28), (1.64, 2.0, 0.22), linen, bevel=0.06)
    box((-0.4, 2.45, 0.4), (1.7, 1.3, 0.14), cloth, bevel=0.05)
    box((-0.4, 4.5, 0.0), (1.7, 0.08, 1.05), wood, bevel=0.02)
    for x in (-0.28, 0.53):
        box((x, 4.0, 0.5), (0.65, 0.4, 0.14), linen, bevel=0.06)
    box((1.45, 3.95, 0), (0.5, 0.5, 0.5), wood, bevel=0.01)
    rod((1.72, 4.2, 0.5), (1.72, 4.2, 0.8), 0.02, BRASS())
    rod((1.72, 4.2, 0.5), (1.72, 4.2, 0.52), 0.09, BRASS())
    rod((1.72, 4.2, 0.8), (1.72, 4.2, 1.06), 0.16, matt(0.8, 0.7, 0.55), caps=False)
    box((-2.1, 2.9, 0), (0.6, 1.5, 2.1), material((0.7, 0.68, 0.62), 0.4), bevel=0.01)
    for y in (3.6, 3.7):
        rod((-1.47, y, 0.9), (-1.47, y, 1.2), 0.012, BRASS())
    box((2.07, 1.85, 0.35), (0.03, 1.0, 1.7), wood)
    box((2.05, 1.9, 0.4), (0.03, 0.9, 1.6), CHROME())
    box((-1.1, 1.2, 0.0), (1.9, 1.1, 0.015), material((1, 1, 1), 1, specular=0,
                                                     texture=stripes([(0.75, 0.65, 0.5), (0.5, 0.2, 0.18)])))
    table((-1.75, 1.75, 0), (0.6, 0.6, 0.5), material((0.02, 0.02, 0.02), 0.1), BRASS(), 0.015)
    vase((-1.45, 2.05, 0.5), 0.3, material((0.75, 0.75, 0.7), 0.2))
    camera((-0.5, 0.3, 1.6), (0.15, 3.4, 0.85), 58)


@room
def kitchen():
    """The sun through a window, under a blue sky."""
    world((0.35, 0.55, 1.0), 3)
    wall = matt(0.72, 0.7, 0.64)
    window = ((1.5, 0.95), (3.7, 2.25))
    shell(4.4, 5, 2.6, {"left": wall, "right": matt(0.65, 0.32, 0.18),
                       "back": wall, "front": wall, "ceiling": matt(0.8, 0.8, 0.8)},
          {"left": [window]})
    frame_window("left", 4.4, *window, material((0.8, 0.8, 0.8), 0.4), 2)
    floor(4.4, 5, material((1, 1, 1), 0.25, texture=tiles((0.82, 0.8, 0.76), (0.42, 0.44, 0.46))), 1)
    light("SUN", (0, 0, 5), 20, (1, 0.9, 0.75), direction=(1, 0.12, -0.62), angle=math.radians(0.53))
    front, top = material((0.28, 0.38, 0.3), 0.5), material((0.65, 0.63, 0.6), 0.2)
    box((-1.0, 4.4, 0), (3.2, 0.6, 0.86), front, bevel=0.01)
    box((-1.02, 4.36, 0.86), (3.22, 0.64, 0.04), top)
    for x in (-0.7, 0.1, 0.9, 1.7):
        rod((x, 4.37, 0.6), (x + 0.25, 4.37, 0.6), 0.012, CHROME())
    box((-1.0, 4.6, 1.5), (2.2, 0.4, 0.7), front, bevel=0.01)
    turned((0.0, 4.65, 0.9), ((0.15, 0), (0.15, 0.2), (0.14, 0.2), (0.14, 0.01)), BRUSHED())
    vase((0.6, 4.65, 0.9), 0.28, GLASS())
    ball((1.2, 4.65, 1.02), 0.12, material((0.75, 0.3, 0.08), 0.3))
    box((1.45, 4.5, 0.86), (0.55, 0.45, 1.1), BRUSHED(), bevel=0.02)
    wood = material((0.5, 0.3, 0.16), 0.4)
    table((-0.6, 2.3, 0), (1.5, 0.9, 0.75), wood, wood)
    chair((0.15, 3.5, 0), 0.1, material((0.75, 0.7, 0.2), 0.5), CHROME())
    chair((1.35, 2.6, 0), -1.4, material((0.75, 0.7, 0.2), 0.5), CHROME())
    turned((0.1, 2.75, 0.75), ((0.08, 0), (0.2, 0.1), (0.19, 0.1), (0.07, 0.01)), CHROME())
    for x, y in ((0.06, 2.72), (0.15, 2.74), (0.1, 2.82)):
        ball((x, y, 0.82), 0.055, material((0.7, 0.12, 0.06), 0.3))
    vase((-0.3, 2.6, 0.75), 0.24, material((0.8, 0.8, 0.78), 0.15))
    camera((0.75, 0.35, 1.55), (-0.1, 3.6, 0.95), 58)


@room
def bar():
    """Emissive surfaces: tubes, a lit back of shelves, and a lamp of a cube."""
    world((0, 0, 0))
    wall = matt(0.3, 0.28, 0.34)
    shell(4.4, 5, 2.7, {"left": matt(0.2, 0.25, 0.45), "right": wall,
                       "back": wall, "front": wall, "ceiling": matt(0.5, 0.5, 0.5)})
    floor(4.4, 5, material((1, 1, 1), 0.15, texture=tiles((0.5, 0.48, 0.46), (0.12, 0.12, 0.13))), 1)
    wood = material((0.3, 0.16, 0.08), 0.3)
    box((-1.2, 3.0, 0), (3.4, 0.5, 1.05), wood, bevel=0.01)
    box((-1.3, 2.9, 1.05), (3.5, 0.65, 0.05), material((0.05, 0.05, 0.05), 0.1), bevel=0.01)
    rod((-1.2, 2.85, 0.25), (2.2, 2.85, 0.25), 0.025, BRASS())
    box((-0.6, 4.97, 1.1), (2.4, 0.02, 1.2), material((1, 0.72, 0.4), emission=4))
    for z in (1.1, 1.5, 1.9, 2.3):
        box((-0.7, 4.65, z - 0.03), (2.6, 0.3, 0.03), wood)
    colors = ((0.1, 0.5, 0.2), (0.6, 0.1, 0.1), (0.1, 0.2, 0.6), (0.7, 0.5, 0.1), (0.4, 0.4, 0.4), (0.1, 0.4, 0.5))
    for k, color in enumerate(colors):
        for z in (1.1, 1.5):
            rod((-0.4 + 0.38 * k, 4.78, z), (-0.4 + 0.38 * k, 4.78, z + 0.28), 0.05, material(color, 0.1))
    rod((-2.12, 1.2, 2.2), (-2.12, 4.2, 2.2), 0.03, material((0.25, 0.5, 1), emission=20))
    rod((2.12, 1.2, 2.2), (2.12, 4.2, 2.2), 0.03, material((1, 0.2, 0.5), emission=20))
    box((-1.75, 3.8, 0.35), (0.5, 0.5, 0.5), material((1, 0.85, 0.6), emission=4))
    box((-1.8, 3.75, 0), (0.6, 0.6, 0.34), wood)
    for x in (-0.7, 0.2, 1.1):
        rod((x, 2.3, 0), (x, 2.3, 0.7), 0.03, CHROME())
        rod((x, 2.3, 0), (x, 2.3, 0.02), 0.2, CHROME())
        rod((x, 2.3, 0.7), (x, 2.3, 0.78), 0.19, material((0.5, 0.06, 0.06), 0.35))
    vase((-0.9, 3.15, 1.1), 0.2, GLASS())
    ball((1.5, 3.15, 1.2), 0.1, CHROME())
    head((0.6, 3.2, 1.22), 0.3, 0.3, BRASS())
    camera((0.4, 0.3, 1.6), (0.0, 3.4, 1.1), 58)


@room
def gallery():
    """The sky through three openings of the ceiling and one of a wall, with Cycles' portals in them."""
    tree = world((1, 1, 1), 0.7)
    sky = tree.nodes.new("ShaderNodeTexSky")
    sky.sky_type, sky.sun_disc, sky.sun_elevation, sky.sun_rotation = "NISHITA", False, math.radians(35), math.radians(120)
    tree.links.new(sky.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    white = matt(0.78, 0.78, 0.76)
    skylights = [((-0.6, 0.9), (0.6, 1.9)), ((-2.1, 3.0), (-0.9, 4.4)), ((0.9, 3.0), (2.1, 4.4))]
    window = ((1.2, 0.4), (3.2, 2.6))
    shell(5.4, 5.6, 3.2, {"left": white, "right": white,
                       "back": matt(0.55, 0.2, 0.15), "front": white, "ceiling": white},
          {"ceiling": skylights, "right": [window]})
    frame_window("right", 5.4, *window, material((0.1, 0.1, 0.1), 0.4), 1)
    floor(5.4, 5.6, material((1, 1, 1), 0.3, texture=planks((0.78, 0.66, 0.5))), 0.4)

    def portal(place, size, direction):
        made = light("AREA", place, 10, (1, 1, 1), direction, shape="RECTANGLE", size=size[0], size_y=size[1])
        made.cycles.is_portal = True

    for (x0, y0), (x1, y1) in skylights:
        portal(((x0 + x1) / 2, (y0 + y1) / 2, 3.2), (x1 - x0, y1 - y0), (0, 0, -1))
    (y0, z0), (y1, z1) = window
    portal((2.7, (y0 + y1) / 2, (z0 + z1) / 2), (y1 - y0, z1 - z0), (-1, 0, 0))
    plinth = matt(0.7, 0.7, 0.7)
    for x, y, z in ((-1.5, 3.6, 1.0), (0.2, 4.2, 0.7), (1.6, 3.2, 0.9)):
        box((x - 0.25, y - 0.25, 0), (0.5, 0.5, z), plinth, bevel=0.01)
    head((-1.5, 3.6, 1.32), 0.55, 0.5, BRASS())
    vase((0.2, 4.2, 0.7), 0.6, material((0.1, 0.3, 0.5), 0.1))
    ball((1.6, 3.2, 1.2), 0.3, CHROME())
    box((-0.6, 2.0, 0), (1.3, 0.45, 0.42), material((0.06, 0.05, 0.05), 0.4), bevel=0.04)
    painting((-2.2, 5.56, 1.1), (1.4, 1.1), [(0.15, 0.3, 0.55), (0.9, 0.8, 0.6), (0.2, 0.5, 0.4), (0.85, 0.85, 0.8)])
    painting((0.9, 5.56, 1.1), (1.2, 1.4), [(0.85, 0.6, 0.1), (0.5, 0.1, 0.1), (0.9, 0.9, 0.85)])
    camera((0.3, 0.4, 1.65), (-0.1, 4.0, 1.35), 60)


def main():
    with open(sys.argv[sys.argv.index("--") + 1]) as file:
        jobs = json.load(file)
    for job in jobs["rooms"]:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        ROOMS[job["name"]]()
        bpy.ops.wm.save_as_mainfile(filepath=job["blend"])
        for seed, picture_path in enumerate(job["pictures"]):
            if not os.path.exists(picture_path):
                write_picture(jobs, picture_path, seed)


main()
