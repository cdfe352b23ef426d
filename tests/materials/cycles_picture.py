"""Renders Blender's scene with Cycles to a picture of 8 bits, in which radiance 1 is white."""
import bpy


def write_picture(jobs, path, seed=0):
    """jobs: width, height, samples, depth (of mirrors and glass), diffuse_bounces and clamp, of indirect light; 0: none."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", jobs["samples"]
    scene.cycles.seed = seed
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 1
    scene.cycles.sample_clamp_indirect = jobs["clamp"]
    scene.cycles.max_bounces = scene.cycles.glossy_bounces = scene.cycles.transmission_bounces = jobs["depth"]
    scene.cycles.transparent_max_bounces, scene.cycles.diffuse_bounces = 64, jobs["diffuse_bounces"]
    scene.render.resolution_x, scene.render.resolution_y = jobs["width"], jobs["height"]
    scene.render.resolution_percentage, scene.render.film_transparent = 100, False
    scene.view_settings.view_transform, scene.view_settings.look = "Standard", "None"
    scene.render.image_settings.file_format, scene.render.image_settings.color_mode = "PNG", "RGB"
    scene.render.image_settings.color_depth, scene.render.dither_intensity = "8", 0
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
