"""Makes the scenes of blender_test.sh, in Blender: --python scenes.py -- FOLDER. pictures.py knows their numbers."""
import math
import os
import sys

import bpy
import numpy


def start(world=(0, 0, 0), strength=1):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*world, 1)
    background.inputs["Strength"].default_value = strength
    return scene


def add(name, data, location=(0, 0, 0), rotation=(0, 0, 0)):
    item = bpy.data.objects.new(name, data)
    item.location, item.rotation_euler = location, [math.radians(a) for a in rotation]
    bpy.context.scene.collection.objects.link(item)
    return item


def add_camera(name, location, rotation, degrees):
    data = bpy.data.cameras.new(name)
    data.sensor_fit, data.angle_y = "VERTICAL", math.radians(degrees)
    return add(name, data, location, rotation)


def add_light(kind, location, watts, color, **fields):
    data = bpy.data.lights.new(kind, kind)
    data.energy, data.color = watts, color
    for field, value in fields.items():
        setattr(data, field, value)
    return add(kind, data, location)


def material(color):
    made = bpy.data.materials.new("material")
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1)
    shader.inputs["Roughness"].default_value, shader.inputs["Specular"].default_value = 1, 0
    return made


def add_plane(color):
    bpy.ops.mesh.primitive_plane_add(size=20)
    bpy.context.object.data.materials.append(material(color))
    return bpy.context.object


def add_cube(location, color):
    bpy.ops.mesh.primitive_cube_add(size=1, location=location)
    bpy.context.object.data.materials.append(material(color))
    return bpy.context.object


def picture(name, pixels):
    height, width = pixels.shape[:2]
    made = bpy.data.images.new(name, width, height)
    made.pixels.foreach_set(numpy.concatenate((pixels, numpy.ones((height, width, 1))), 2).astype("f4").ravel())
    made.pack()
    return made


def missing_picture():
    made = bpy.data.images.new("gone", 8, 8)
    made.source, made.filepath = "FILE", "//gone.png"
    return made


def save(name):
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(sys.argv[-1], name + ".blend"))


def stage():
    """Two cubes, one of them moving from frame 11 to 35, 24 frames a second, on a floor that is blue on the right."""
    scene = start((0.05, 0.1, 0.2), 2)
    add_camera("a camera that is not active", (0, 0, 30), (0, 0, 0), 40)
    scene.camera = add_camera("camera", (0, -10, 4), (70, 0, 0), 40)
    floor = add_plane((1, 1, 1))
    pixels = numpy.zeros((8, 8, 3))
    pixels[:, :4] = (1, 1, 0)
    pixels[:, 4:] = (0, 0, 1)
    tree = floor.active_material.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = picture("floor", pixels)
    tree.links.new(texture.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    green = add_cube((0, 2, 0.5), (0.05, 0.8, 0.05))
    colors = green.data.color_attributes.new("colours that no material shows", "BYTE_COLOR", "CORNER")
    colors.data.foreach_set("color", (0, 0, 0, 1) * len(colors.data))
    mover = add_cube((-2, 0, 0.5), (0.8, 0.05, 0.05))
    array = mover.modifiers.new("a second one on top", "ARRAY")
    array.relative_offset_displace = (0, 0, 1)
    hidden = add_cube((3, -2, 0.5), (1, 1, 1))
    hidden.hide_render = True
    for frame, x in ((11, -2), (35, 2)):
        mover.location.x = x
        mover.keyframe_insert("location", frame=frame)
    for curve in mover.animation_data.action.fcurves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
    add_light("POINT", (0, -2, 5), 800, (1, 1, 1))
    scene.frame_start, scene.frame_end, scene.render.fps, scene.render.fps_base = 11, 35, 48, 2
    scene.frame_set(20)
    save("stage")


def lamps():
    """Every kind of light in a colour of its own, above a floor."""
    scene = start()
    add_plane((0.5, 0.5, 0.5))
    scene.camera = add_camera("camera", (0, 0, 3), (0, 0, 0), 2)
    add_light("POINT", (0, 0, 4), 300, (1, 0, 0), shadow_soft_size=0)
    add_light("SUN", (0, 0, 9), 3, (0, 1, 0), angle=0)
    add_light("SPOT", (0, 0, 5), 500, (0, 0, 1), shadow_soft_size=0)
    save("lamps")
    scene = start()
    floor = add_plane((0.5, 0.5, 0.5))
    scene.camera = add_camera("camera", (0, 0, 3), (0, 0, 0), 2)
    light = add_light("AREA", (0, 0, 4), 200, (1, 0.5, 0.25), shape="RECTANGLE", size=2, size_y=1)
    light.scale = (1.5, 1.5, 1)
    add_light("AREA", (0, 0, 2), 100, (1, 1, 1), size=1).data.cycles.is_portal = True  # shines on nothing
    save("area")
    floor.data.materials.clear()
    light.data.shape, light.data.size, light.data.size_y = "ELLIPSE", 3, 1
    save("ellipse")


def surroundings():
    """A picture all around, turned about every axis, of half its radiance."""
    scene = start()
    u, v = (numpy.arange(256) + 0.5) / 256, (numpy.arange(128) + 0.5) / 128
    wave = lambda phase: numpy.broadcast_to(0.5 + 0.5 * numpy.cos(2 * math.pi * (u - phase)), (128, 256))
    pixels = numpy.stack((wave(0), wave(0.25), numpy.broadcast_to(v[:, None], (128, 256))), 2)
    tree = scene.world.node_tree
    texture, turn = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
    place = tree.nodes.new("ShaderNodeTexCoord")
    texture.image = picture("surroundings", pixels)
    turn.inputs["Rotation"].default_value = (0.3, 0.2, 0.7)
    tree.nodes["Background"].inputs["Strength"].default_value = 0.5
    tree.links.new(place.outputs["Generated"], turn.inputs["Vector"])
    tree.links.new(turn.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    scene.camera = add_camera("camera", (0, 0, 0), (95, 0, 20), 90)
    add_cube((0, -10, 0), (1, 1, 1))
    save("surroundings")
    texture.image = missing_picture()
    save("gone")


def simple():
    start()
    save("empty")
    cube = add_cube((0, 0, 0), (1, 1, 1))
    cube.modifiers.new("bevel", "BEVEL")
    cube.shape_key_add(name="basis")
    cube.shape_key_add(name="key").keyframe_insert("value", frame=1)
    cube.keyframe_insert("location", frame=1)
    cube.animation_data.nla_tracks.new().strips.new("strip", 1, cube.animation_data.action)
    nodes = cube.active_material.node_tree.nodes
    nodes.clear()
    nodes.new("ShaderNodeBsdfToon")
    nodes.new("ShaderNodeTexImage").image = missing_picture()
    cube.active_material.name = "toon"
    save("no_camera")


stage()
lamps()
surroundings()
simple()
