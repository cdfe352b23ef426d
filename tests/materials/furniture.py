"""Materials, furniture, walls and lights of rooms.py, in Blender. Axes are Blender's, z up, and metres."""
import math

import bpy
import numpy
from mathutils import Vector

THICKNESS = 0.2  # of walls


# Materials.

def material(color, roughness=0.5, metallic=0.0, texture=None, transmission=0.0, emission=0.0, specular=0.5):
    made = bpy.data.materials.new("material")
    made.use_nodes = True
    tree = made.node_tree
    inputs = tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*color, 1)
    for name, value in (("Roughness", roughness), ("Metallic", metallic), ("Transmission", transmission), ("IOR", 1.5),
                        ("Specular", specular)):
        inputs[name].default_value = value
    if emission:
        inputs["Base Color"].default_value = (0, 0, 0, 1)
        inputs["Emission"].default_value, inputs["Emission Strength"].default_value = (*color, 1), emission
    if texture:
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = texture
        tree.links.new(node.outputs["Color"], inputs["Base Color"])
    return made


matt = lambda *color: material(color, roughness=1, specular=0)


def picture(name, pixels):
    """pixels: sRGB from 0 to 1."""
    height, width = pixels.shape[:2]
    made = bpy.data.images.new(name, width, height)
    made.pixels.foreach_set(numpy.concatenate((pixels, numpy.ones((height, width, 1))), 2).astype("f4").ravel())
    made.pack()
    return made


def planks(base):
    """Boards along v, eight of them across u, each of another shade and with a grain."""
    random = numpy.random.default_rng(7)
    u, v = numpy.meshgrid(numpy.arange(256), numpy.arange(256))
    board = u // 32
    shade = 0.8 + 0.25 * random.random(8)[board] + 0.06 * numpy.sin(u * 1.1 + 3 * numpy.sin(v / 41.0) + board)
    shade[u % 32 == 0] = 0.45
    shade[(v + 64 * (board % 3)) % 256 == 0] = 0.5
    return picture("planks", numpy.clip(shade[..., None] * numpy.array(base), 0, 1))


def tiles(light, dark):
    u, v = numpy.meshgrid(numpy.arange(128) // 64, numpy.arange(128) // 64)
    return picture("tiles", numpy.where(((u + v) % 2 == 0)[..., None], light, dark))


def stripes(colors):
    v = numpy.arange(128) // 16 % len(colors)
    return picture("stripes", numpy.broadcast_to(numpy.array(colors)[v][:, None], (128, 128, 3)))


# Furniture. Boxes are given by their lower corner and their size.

def finish(item, made):
    item.data.materials.append(made)
    return item


def box(low, size, made, bevel=0.0, turn=0.0):
    bpy.ops.mesh.primitive_cube_add(size=1, location=[a + b / 2 for a, b in zip(low, size)], rotation=(0, 0, turn))
    item = bpy.context.object
    item.scale = size
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    if bevel:
        modifier = item.modifiers.new("bevel", "BEVEL")
        modifier.width, modifier.segments = bevel, 3
        bpy.ops.object.shade_smooth(use_auto_smooth=True)
    return finish(item, made)


def floor(width, depth, made, repeat=1.0):
    """A sheet on the ground; repeat: the texture's per metre."""
    bpy.ops.mesh.primitive_plane_add(size=1, location=(0, depth / 2, 0))
    item = bpy.context.object
    item.scale = (width, depth, 1)
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    for corner in item.data.uv_layers[0].data:
        corner.uv = (corner.uv[0] * width * repeat, corner.uv[1] * depth * repeat)
    return finish(item, made)


def ball(center, radius, made):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=center, segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()
    return finish(bpy.context.object, made)


def rod(start, end, radius, made, caps=True):
    start, end = Vector(start), Vector(end)
    bpy.ops.mesh.primitive_cylinder_add(radius=radius, depth=(end - start).length, location=(start + end) / 2, vertices=32,
                                        rotation=(end - start).to_track_quat("Z", "Y").to_euler(),
                                        end_fill_type="NGON" if caps else "NOTHING")
    bpy.ops.object.shade_smooth(use_auto_smooth=True)
    return finish(bpy.context.object, made)


def turned(center, outline, made):
    """A closed solid of revolution about z; outline: radii and heights, from ring to ring."""
    count, points, faces = 40, [], []
    for radius, height in outline:
        points += [(radius * math.cos(2 * math.pi * k / count), radius * math.sin(2 * math.pi * k / count), height)
                   for k in range(count)]
    for ring in range(len(outline) - 1):
        for k in range(count):
            a, b = ring * count + k, ring * count + (k + 1) % count
            faces.append((a, b, b + count, a + count))
    faces += [tuple(reversed(range(count))), tuple(range(len(points) - count, len(points)))]
    mesh = bpy.data.meshes.new("turned")
    mesh.from_pydata(points, [], faces)
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    mesh.use_auto_smooth = True
    item = bpy.data.objects.new("turned", mesh)
    item.location = center
    bpy.context.scene.collection.objects.link(item)
    return finish(item, made)


def vase(center, size, made):
    outline = ((0.3, 0), (0.5, 0.35), (0.42, 0.7), (0.2, 0.9), (0.26, 1.0), (0.22, 1.0), (0.16, 0.9), (0.36, 0.7),
               (0.44, 0.35), (0.26, 0.06))
    return turned(center, [(r * size, z * size) for r, z in outline], made)


def table(low, size, top, legs, radius=0.03):
    x, y, z = low
    width, depth, height = size
    box((x, y, z + height - 0.04), (width, depth, 0.04), top, bevel=0.008)
    for a in (x + 0.08, x + width - 0.08):
        for b in (y + 0.08, y + depth - 0.08):
            rod((a, b, z), (a, b, z + height - 0.04), radius, legs)


def chair(center, turn, seat, legs):
    right, back = Vector((math.cos(turn), math.sin(turn))), Vector((-math.sin(turn), math.cos(turn)))
    place = lambda x, y: Vector(center[:2]) + right * x + back * y
    for x in (-0.19, 0.19):
        for y in (-0.19, 0.19):
            rod((*place(x, y), 0), (*place(x, y), 0.43), 0.018, legs)
    x, y = place(0, 0)
    box((x - 0.22, y - 0.22, 0.43), (0.44, 0.44, 0.05), seat, bevel=0.015, turn=turn)
    x, y = place(0, 0.21)
    box((x - 0.22, y - 0.02, 0.55), (0.44, 0.04, 0.38), seat, bevel=0.015, turn=turn)
    for side in (-0.19, 0.19):
        rod((*place(side, 0.21), 0.45), (*place(side, 0.21), 0.6), 0.018, legs)


def head(center, size, turn, made):
    """Suzanne, Blender's monkey."""
    bpy.ops.mesh.primitive_monkey_add(size=size, location=center, rotation=(0, 0, turn))
    item = bpy.context.object
    item.modifiers.new("subdivision", "SUBSURF").render_levels = 2
    item.modifiers[0].levels = 2
    bpy.ops.object.shade_smooth()
    return finish(item, made)


def painting(low, size, colors):
    """Hangs on the wall at the back."""
    box(low, (size[0], 0.03, size[1]), material((1, 1, 1), 0.4, texture=stripes(colors)))


# Rooms.

def panels(low, high, fixed, openings):
    """Boxes that fill a wall's rectangle but for its openings, of which no two are above one another. fixed: from a box in
    the wall's two axes to one in the room."""
    left = low[0]
    for (x0, y0), (x1, y1) in sorted(openings):
        for a, b in (((left, low[1]), (x0, high[1])), ((x0, low[1]), (x1, y0)), ((x0, y1), (x1, high[1]))):
            if b[0] - a[0] > 1e-6 and b[1] - a[1] > 1e-6:
                yield fixed(a, (b[0] - a[0], b[1] - a[1]))
        left = x1
    yield fixed((left, low[1]), (high[0] - left, high[1] - low[1]))


def shell(width, depth, height, colors, openings=None):
    """Walls and ceiling. colors: of left, right, back, front and ceiling; openings: of each its rectangles, by the two
    coordinates in which it extends."""
    w, t, openings = width / 2, THICKNESS, openings or {}
    sides = {
        "left": ((-t, 0), (depth + t, height), lambda a, s: ((-w - t, a[0], a[1]), (t, s[0], s[1]))),
        "right": ((-t, 0), (depth + t, height), lambda a, s: ((w, a[0], a[1]), (t, s[0], s[1]))),
        "back": ((-w, 0), (w, height), lambda a, s: ((a[0], depth, a[1]), (s[0], t, s[1]))),
        "front": ((-w, 0), (w, height), lambda a, s: ((a[0], -t, a[1]), (s[0], t, s[1]))),
        "ceiling": ((-w - t, -t), (w + t, depth + t), lambda a, s: ((a[0], a[1], height), (s[0], s[1], t))),
    }
    for side, (low, high, fixed) in sides.items():
        for corner, size in panels(low, high, fixed, openings.get(side, ())):
            box(corner, size, colors[side])


def frame_window(side, width, low, high, made, bars=1):
    """A frame of bars in an opening of the left or right wall."""
    x = (width / 2 + 0.05) * (1 if side == "right" else -1)
    (y0, z0), (y1, z1) = low, high
    beams = [((y0, z0), (y1, z0 + 0.05)), ((y0, z1 - 0.05), (y1, z1)),
             ((y0, z0), (y0 + 0.05, z1)), ((y1 - 0.05, z0), (y1, z1))]
    for k in range(bars):
        y = y0 + (y1 - y0) * (k + 1) / (bars + 1)
        beams.append(((y - 0.02, z0), (y + 0.02, z1)))
    for a, b in beams:
        box((x - 0.03, *a), (0.06, b[0] - a[0], b[1] - a[1]), made)


def light(kind, location, energy, color, direction=(0, 0, -1), **fields):
    data = bpy.data.lights.new(kind.lower(), kind)
    data.energy, data.color = energy, color
    for field, value in fields.items():
        setattr(data, field, value)
    item = bpy.data.objects.new(data.name, data)
    item.location, item.rotation_euler = location, Vector(direction).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(item)
    return data


def world(color, strength=1.0):
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value, background.inputs["Strength"].default_value = (*color, 1), strength
    return scene.world.node_tree


def camera(eye, target, degrees):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle_y = "VERTICAL", math.radians(degrees)
    data.clip_start = 0.05
    item = bpy.data.objects.new("camera", data)
    item.location = eye
    item.rotation_euler = (Vector(target) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(item)
    bpy.context.scene.camera = item


CHROME = lambda: material((0.85, 0.85, 0.87), 0.08, 1)
BRUSHED = lambda: material((0.6, 0.6, 0.62), 0.35, 1)
BRASS = lambda: material((0.85, 0.6, 0.25), 0.25, 1)
GLASS = lambda: material((1, 1, 1), 0, transmission=1)
