"""Renders the scene with Cycles, direct light alone: blender SCENE --python cycles.py -- WIDTHxHEIGHT OUT.pfm"""
import sys
import tempfile

import bpy
import numpy

size, out = sys.argv[-2:]
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.device, scene.cycles.samples, scene.cycles.diffuse_bounces = "CPU", 256, 0
scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
scene.render.resolution_x, scene.render.resolution_y = map(int, size.split("x"))
scene.render.resolution_percentage, scene.render.image_settings.file_format = 100, "OPEN_EXR"
with tempfile.TemporaryDirectory() as folder:
    scene.render.filepath = folder + "/picture.exr"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = numpy.array(image.pixels[:], "<f4").reshape(-1, 4)[:, :3]
with open(out, "wb") as file:
    file.write(f"PF\n{image.size[0]} {image.size[1]}\n-1.0\n".encode() + pixels.tobytes())
