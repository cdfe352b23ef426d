"""Renders models with Cycles for contact_sheet.py, in Blender:

    blender --background --factory-startup --python cycles.py -- JOBS.json

JOBS.json: what cycles_picture.py takes, environment (an equirectangular .hdr) and models, each with a name, a file for
Blender, the picture to write and suns, which have a direction, towards the sun, and an irradiance, in the model's axes. The camera is
chosen here, so that it sees all of the model from a little above; JOBS.json.cameras receives those of the models that
could be rendered, as pocketray's --camera takes them, and of the others the reason. Axes of files are glTF's, y up.
"""
import json
import math
import os
import sys

import bpy
import numpy
from mathutils import Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from cycles_picture import write_picture  # noqa: E402

numpy.bool = bool  # Debian's Blender 3.4 still uses the name that its numpy dropped

FIELD_OF_VIEW = 40.0  # degrees, vertical
VIEW = Vector((0.55, 0.35, 1.0)).normalized()  # from the model to the camera


def to_blender(v):
    return Vector((v[0], -v[2], v[1]))


def from_blender(v):
    return Vector((v[0], v[2], -v[1]))


def load(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.endswith(".obj"):
        bpy.ops.import_scene.obj(filepath=path, axis_forward="-Z", axis_up="Y")
    else:
        bpy.ops.import_scene.gltf(filepath=path)
    for item in list(bpy.data.objects):
        if item.type in ("LIGHT", "CAMERA"):
            bpy.data.objects.remove(item)
    if not path.endswith(".obj"):
        give_default_material()
    for material in bpy.data.materials:
        if material.use_nodes:
            if path.endswith(".obj"):
                use_color_and_texture(material.node_tree)
            use_gltf_alpha(material)
            use_gltf_diffuse(material.node_tree)
            use_gltf_sides(material)
    for image in bpy.data.images:
        image.alpha_mode = "CHANNEL_PACKED"  # alpha leaves the colours alone
    bpy.context.scene.frame_set(0)


def corners():
    """The model's bounds in glTF's axes."""
    points = []
    graph = bpy.context.evaluated_depsgraph_get()
    for instance in graph.object_instances:
        if instance.object.type == "MESH" and instance.show_self:
            points += [from_blender(instance.matrix_world @ Vector(c)) for c in instance.object.bound_box]
    if not points:
        raise ValueError("no mesh")
    low = [min(p[k] for p in points) for k in range(3)]
    high = [max(p[k] for p in points) for k in range(3)]
    return Vector(low), Vector(high)


def camera_for(aspect):
    """Eye and target such that the bounds' sphere fills the picture."""
    low, high = corners()
    target, radius = (low + high) / 2, (high - low).length / 2
    half = math.radians(FIELD_OF_VIEW) / 2
    half = min(half, math.atan(math.tan(half) * aspect))
    return target + VIEW * (radius / math.sin(half)), target


def place_camera(eye, target):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle_y = "VERTICAL", math.radians(FIELD_OF_VIEW)
    distance = (eye - target).length
    data.clip_start, data.clip_end = distance / 1000, distance * 1000
    camera = bpy.data.objects.new("camera", data)
    bpy.context.scene.collection.objects.link(camera)
    back = (to_blender(eye) - to_blender(target)).normalized()
    right = to_blender((0, 1, 0)).cross(back).normalized()
    camera.matrix_world = Matrix.Translation(to_blender(eye)) @ Matrix(
        (right, back.cross(right), back)).transposed().to_4x4()
    bpy.context.scene.camera = camera


def light(jobs, suns):
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    picture = nodes.new("ShaderNodeTexEnvironment")
    picture.image = bpy.data.images.load(jobs["environment"])
    # Blender has +x in the middle of the picture, pocketray -z, which is Blender's +y.
    turn, place = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
    turn.inputs["Rotation"].default_value[2] = -math.pi / 2
    links.new(place.outputs["Generated"], turn.inputs["Vector"])
    links.new(turn.outputs["Vector"], picture.inputs["Vector"])
    links.new(picture.outputs["Color"], nodes["Background"].inputs["Color"])
    for sun in suns:
        data = bpy.data.lights.new("sun", "SUN")
        data.energy, data.angle = sun["irradiance"], 0
        item = bpy.data.objects.new("sun", data)
        item.rotation_euler = to_blender(sun["direction"]).to_track_quat("Z", "Y").to_euler()
        scene.collection.objects.link(item)


def feed(tree, source, target):
    """Gives an input of a node what another one has."""
    if source.is_linked:
        tree.links.new(source.links[0].from_socket, target)
    else:
        target.default_value = source.default_value


def scaled(tree, color, factor):
    """The product of two outputs or inputs."""
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = "MULTIPLY"
    for socket, target in zip((color, factor), node.inputs):
        if socket.is_output or socket.is_linked:
            tree.links.new(socket if socket.is_output else socket.links[0].from_socket, target)
        else:
            value = socket.default_value
            target.default_value = value[:3] if hasattr(value, "__len__") else (value,) * 3
    return node.outputs[0]


def give_default_material():
    """Meshes without a material get glTF's: a white metal of roughness 1, times the colours of vertices. Blender's is grey."""
    for mesh in bpy.data.meshes:
        if any(mesh.materials):
            continue
        material = bpy.data.materials.new("default")
        material.use_nodes = material.use_backface_culling = True
        tree = material.node_tree
        shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
        shader.inputs["Base Color"].default_value = (1, 1, 1, 1)
        shader.inputs["Metallic"].default_value = shader.inputs["Roughness"].default_value = 1
        if mesh.color_attributes:
            colors = tree.nodes.new("ShaderNodeVertexColor")
            colors.layer_name = mesh.color_attributes[0].name
            tree.links.new(colors.outputs["Color"], shader.inputs["Base Color"])
        mesh.materials.clear()
        mesh.materials.append(material)


def use_color_and_texture(tree):
    """An OBJ's Kd and map_Kd are multiplied; Blender leaves out Kd where there is a texture."""
    for node in [node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"]:
        color = node.inputs["Base Color"]
        if not color.is_linked:
            continue
        factor = tree.nodes.new("ShaderNodeRGB")
        factor.outputs[0].default_value = color.default_value
        tree.links.new(scaled(tree, color, factor.outputs[0]), color)


def use_gltf_sides(material):
    """Single-sided faces are not seen from behind; they cast shadows either way."""
    if not material.use_backface_culling:
        return
    tree = material.node_tree
    surface = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL").inputs["Surface"]
    if not surface.is_linked:
        return
    side, path = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeLightPath")
    seen, mix = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMixShader")
    seen.operation = "SUBTRACT"
    seen.use_clamp = True
    tree.links.new(side.outputs["Backfacing"], seen.inputs[0])
    tree.links.new(path.outputs["Is Shadow Ray"], seen.inputs[1])
    tree.links.new(seen.outputs[0], mix.inputs[0])
    tree.links.new(surface.links[0].from_socket, mix.inputs[1])
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], surface)


def use_gltf_alpha(material):
    """Cycles ignores how a material's alpha is meant: not at all, as a mask, or as coverage."""
    tree = material.node_tree
    for node in [node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"]:
        alpha = node.inputs["Alpha"]
        if not alpha.is_linked:
            continue
        source = alpha.links[0].from_socket
        if material.blend_method == "OPAQUE":
            tree.links.remove(alpha.links[0])
            alpha.default_value = 1
        elif material.blend_method == "CLIP":
            mask = tree.nodes.new("ShaderNodeMath")
            mask.operation = "GREATER_THAN"
            mask.inputs[1].default_value = material.alpha_threshold
            tree.links.new(source, mask.inputs[0])
            tree.links.new(mask.outputs[0], alpha)


def use_gltf_diffuse(tree):
    """Replaces the diffuse lobe of Blender's shader, which is Disney's and a third brighter at grazing angles, by
    glTF's: Lambert's, less what the specular lobe reflects head on. By metallic, a metal is mixed with both."""
    for metal in [node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"]:
        transmission = metal.inputs["Transmission"]
        if transmission.is_linked or transmission.default_value > 0:
            continue
        coat, diffuse = tree.nodes.new("ShaderNodeBsdfPrincipled"), tree.nodes.new("ShaderNodeBsdfDiffuse")
        both, mix = tree.nodes.new("ShaderNodeAddShader"), tree.nodes.new("ShaderNodeMixShader")
        for socket in metal.inputs:
            feed(tree, socket, coat.inputs[socket.identifier])
        metal.distribution = coat.distribution = "MULTI_GGX"  # with the light that microfacets scatter more than once
        for name, value in (("Base Color", (0, 0, 0, 1)), ("Metallic", 0)):
            for link in coat.inputs[name].links:
                tree.links.remove(link)
            coat.inputs[name].default_value = value
        color = scaled(tree, metal.inputs["Base Color"], metal.inputs["Alpha"])
        under = tree.nodes.new("ShaderNodeValue")
        under.outputs[0].default_value = 0.96
        tree.links.new(scaled(tree, color, under.outputs[0]), diffuse.inputs["Color"])
        feed(tree, metal.inputs["Normal"], diffuse.inputs["Normal"])
        targets = [link.to_socket for link in metal.outputs[0].links]
        feed(tree, metal.inputs["Metallic"], mix.inputs[0])
        for link in metal.inputs["Metallic"].links:
            tree.links.remove(link)
        metal.inputs["Metallic"].default_value = 1
        for source, target in ((diffuse.outputs[0], both.inputs[0]), (coat.outputs[0], both.inputs[1]),
                               (both.outputs[0], mix.inputs[1]), (metal.outputs[0], mix.inputs[2])):
            tree.links.new(source, target)
        for target in targets:
            tree.links.new(mix.outputs[0], target)


def main():
    path = sys.argv[sys.argv.index("--") + 1]
    with open(path) as file:
        jobs = json.load(file)
    cameras, reasons = {}, {}
    for model in jobs["models"]:
        try:
            load(model["blender file"])
            eye, target = camera_for(jobs["width"] / jobs["height"])
            if not os.path.exists(model["picture"]):
                place_camera(eye, target)
                light(jobs, model["suns"])
                write_picture(jobs, model["picture"])
            numbers = lambda v: ",".join(f"{x:.9g}" for x in v)
            cameras[model["name"]] = f"{numbers(eye)} {numbers(target)} 0,1,0 {FIELD_OF_VIEW:g}"
        except (RuntimeError, ValueError) as error:  # a model that Blender does not read
            reasons[model["name"]] = str(error).strip().splitlines()[-1]
    with open(path + ".cameras", "w") as file:
        json.dump({"cameras": cameras, "reasons": reasons}, file)


main()
