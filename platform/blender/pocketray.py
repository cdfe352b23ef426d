"""Exports scenes from Blender to pocketray, as an add-on (File > Export) or without a window:

    blender --background scene.blend --python pocketray.py -- OUT.pray [options of `pocketray bake`]

Blender's own exporter writes glTF to a temporary folder, and `pocketray bake` reads it. README.md tells what is carried
over. Errors are one line, exit status 1.
"""
import contextlib
import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile

import bpy
import numpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper
from mathutils import Matrix, Vector

bl_info = {
    "name": "pocketray",
    "description": "Export scenes to the ray tracer for handhelds",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "File > Export > pocketray (.pray)",
    "category": "Import-Export",
}

ADDON = "pocketray"  # the module's name when Blender has installed it
WORLD_WIDTH_MAX = 1024  # of the world's picture: bake keeps no more
WORLD_WIDTH_PROCEDURAL = 512  # as wide as the program's own sky
SHADERS = {"BSDF_PRINCIPLED", "EMISSION", "BACKGROUND", "GROUP"}  # that glTF has; a group may hold one


class ExportError(Exception):
    """One line that says what is wrong and how to mend it."""


def find_program():
    addon = bpy.context.preferences.addons.get(ADDON)
    name = addon.preferences.program if addon and addon.preferences else "pocketray"
    if shutil.which(name) is None:
        raise ExportError(f"the program '{name}' is not found: add its folder to PATH, or set the add-on's preferences")
    return shutil.which(name)


def check_output(path):
    if not path.endswith(".pray"):
        raise ExportError(f"the output is '{path}': its name must end in .pray")
    folder = os.path.dirname(path) or "."
    if not os.path.isdir(folder):
        raise ExportError(f"the folder '{folder}' does not exist: create it, or choose another")
    if not os.access(folder, os.W_OK):
        raise ExportError(f"the folder '{folder}' is not writable: choose another")


@contextlib.contextmanager
def captured_output():
    """Lines that Blender prints, those of its C++ part included, collected when the block ends."""
    lines = []
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as file:
        sys.stdout.flush()
        console = os.dup(1)
        os.dup2(file.fileno(), 1)
        try:
            yield lines
        finally:
            sys.stdout.flush()
            os.dup2(console, 1)
            os.close(console)
            file.seek(0)
            lines += file.read().splitlines()


# Area lights, which glTF lacks, become luminous meshes, children of the lights.

def area_outline(lamp):
    """Corners, counter-clockwise as seen from the lit side, -z."""
    width = lamp.size
    height = lamp.size_y if lamp.shape in ("RECTANGLE", "ELLIPSE") else lamp.size
    if lamp.shape in ("SQUARE", "RECTANGLE"):
        unit = ((-1, -1), (-1, 1), (1, 1), (1, -1))
    else:  # a polygon of the ellipse's area
        angles = [2 * math.pi * k / 16 for k in range(16)]
        radius = math.sqrt(2 * math.pi / (16 * math.sin(angles[1])))
        unit = [(radius * math.cos(angle), -radius * math.sin(angle)) for angle in angles]
    return [Vector((x * width / 2, y * height / 2, 0)) for x, y in unit]


def area_radiance(lamp, matrix, say):
    """Cycles' radiance of an area light of P watts and A square metres is P/4A, however it is scaled."""
    corners = [matrix @ corner for corner in area_outline(lamp)]
    area = sum((b - corners[0]).cross(c - corners[0]).length / 2 for b, c in zip(corners[1:], corners[2:]))
    radiance = Vector(lamp.color) * (lamp.energy / (4 * area) if area > 0 else 0)
    if lamp.use_nodes:
        for node in lamp.node_tree.nodes:
            if node.type == "EMISSION":
                color, strength = node.inputs["Color"], node.inputs["Strength"]
                if color.is_linked or strength.is_linked:
                    say(f"area light '{lamp.name}': the nodes that feed its emission are not carried over")
                radiance = Vector(a * b * strength.default_value for a, b in zip(radiance, color.default_value))
    if lamp.spread < math.pi - 0.01:
        say(f"area light '{lamp.name}': its spread is not carried over; it shines to all sides")
    return radiance


def luminous_mesh(light, say):
    lamp = light.data
    mesh = bpy.data.meshes.new(lamp.name)
    mesh.from_pydata(area_outline(lamp), [], [range(len(area_outline(lamp)))])
    material = bpy.data.materials.new(lamp.name)
    material.use_nodes = material.use_backface_culling = True  # one-sided
    nodes = material.node_tree.nodes
    nodes.clear()
    emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
    radiance = area_radiance(lamp, light.matrix_world, say)
    strength = max(*radiance, 1e-9)
    emission.inputs["Color"].default_value = (*(radiance / strength), 1)
    emission.inputs["Strength"].default_value = strength
    mesh.materials.append(material)
    return mesh


@contextlib.contextmanager
def area_lights_as_meshes(context, say):
    added = []
    try:
        for light in [item for item in bpy.data.objects if item.type == "LIGHT" and item.users_collection]:
            is_portal = "cycles" in light.data and light.data["cycles"].get("is_portal")  # only guides Cycles' rays
            if light.data.type != "AREA" or light.data.energy <= 0 or is_portal:
                continue
            collections = [collection for collection in light.users_collection if collection.library is None]
            if not collections:
                say(f"area light '{light.name}' is linked from another file and not carried over: make it local")
                continue
            item = bpy.data.objects.new(light.name + " area", luminous_mesh(light, say))
            added.append((light, item))
            for collection in collections:
                collection.objects.link(item)
            item.parent, item.matrix_parent_inverse = light, Matrix.Identity(4)
            item.hide_render, item.hide_viewport = light.hide_render, light.hide_viewport
        context.view_layer.update()
        for light, item in added:
            if light.name in context.view_layer.objects:
                item.hide_set(light.hide_get())
                item.select_set(light.select_get())
        yield
    finally:
        for _, item in added:
            mesh = item.data
            material = mesh.materials[0]
            bpy.data.objects.remove(item)
            bpy.data.meshes.remove(mesh)
            bpy.data.materials.remove(material)


# The world: a panorama, rendered by Cycles.

def uniform_radiance(world):
    """None if the world depends on the direction."""
    if not world.use_nodes:
        return Vector(world.color)
    output = world.node_tree.get_output_node("CYCLES")
    if output is None or not output.inputs["Surface"].is_linked:
        return Vector((0, 0, 0))
    node = output.inputs["Surface"].links[0].from_node
    if node.type != "BACKGROUND" or any(socket.is_linked for socket in node.inputs):
        return None
    return Vector(node.inputs["Color"].default_value[:3]) * node.inputs["Strength"].default_value


def world_width(world):
    if uniform_radiance(world) is not None:
        return 8
    widths = [WORLD_WIDTH_PROCEDURAL]
    for node in world.node_tree.nodes:
        if node.type in ("TEX_ENVIRONMENT", "TEX_IMAGE") and any(socket.is_linked for socket in node.outputs):
            if node.image is None or node.image.size[0] == 0:
                name = node.image.filepath if node.image else ""
                raise ExportError(f"the world's picture '{name}' cannot be read: find it with File > External Data, or "
                                  "remove its node")
            widths.append(node.image.size[0])
    return min(max(widths), WORLD_WIDTH_MAX)


def panorama_scene(world, path):
    scene = bpy.data.scenes.new("panorama")
    scene.world = world
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", 16
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1
    scene.render.resolution_x = world_width(world)
    scene.render.resolution_y = scene.render.resolution_x // 2
    scene.render.image_settings.file_format, scene.render.filepath = "HDR", path
    camera = bpy.data.objects.new("panorama", bpy.data.cameras.new("panorama"))
    camera.data.type, camera.data.cycles.panorama_type = "PANO", "EQUIRECTANGULAR"
    # Towards +y, glTF's -z, which is in the middle of the program's environments.
    camera.rotation_euler = (math.pi / 2, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def write_world(world, folder):
    """The path of an equirectangular picture, or None if the world is black."""
    if world is None or uniform_radiance(world) == Vector((0, 0, 0)):
        return None
    if "cycles" not in bpy.context.preferences.addons:
        raise ExportError("the world needs Cycles: enable it in Blender's preferences, or give bake's --environment")
    path = os.path.join(folder, "world.hdr")
    scene = panorama_scene(world, path)
    try:
        with captured_output():
            bpy.ops.render.render(scene=scene.name, write_still=True)
    except RuntimeError as error:
        raise ExportError(f"Blender cannot render the world: {last_line(error)}") from error
    finally:
        camera = scene.camera.data
        bpy.data.objects.remove(scene.camera)
        bpy.data.cameras.remove(camera)
        bpy.data.scenes.remove(scene)
    return path


def last_line(error):
    return [line.strip() for line in str(error).splitlines() if line.strip() and not line.startswith("location:")][-1]


def uses_vertex_colors():
    """The exporter writes colours that no material shows, and glTF multiplies by them."""
    return any(node.type in ("VERTEX_COLOR", "ATTRIBUTE") for material in bpy.data.materials if material.use_nodes
               for node in material.node_tree.nodes)


def write_gltf(context, path, objects, say):
    if "bool" not in vars(numpy):
        numpy.bool = bool  # Blender 3.4's exporter still uses the name
    try:
        with captured_output() as lines:
            bpy.ops.export_scene.gltf(
                filepath=path, export_format="GLB", export_cameras=True, export_lights=True, export_apply=True,
                export_animations=True, export_frame_range=True, export_nla_strips=False, use_active_scene=True,
                convert_lighting_mode="COMPAT", export_colors=uses_vertex_colors(), use_selection=objects == "SELECTED",
                use_visible=objects == "VISIBLE", use_renderable=objects == "RENDERED")
    except (RuntimeError, AttributeError, TypeError) as error:
        raise ExportError(f"Blender's glTF exporter fails: {last_line(error)}") from error
    for line in lines:
        warning = re.search(r"(?:WARNING|ERROR): *(.*)", line)
        if warning and "Draco" not in line and "Unsupported light source AREA" not in line:
            say(f"glTF: {warning[1]}")


def read_glb(path):
    with open(path, "rb") as file:
        data = file.read()
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + size]), bytearray(data[28 + size:])


def write_glb(path, document, binary):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(binary), len(text), 0x4E4F534A))
        file.write(text + struct.pack("<II", len(binary), 0x004E4942) + binary)


def put_camera_first(document, name, say):
    """The program takes the first camera that it meets from the roots on."""
    def bring_forward(children):
        for index in children:
            node = document["nodes"][index]
            if (node.get("name") == name and "camera" in node) or bring_forward(node.get("children", [])):
                children.remove(index)
                children.insert(0, index)
                return True
        return False

    if name is not None and not any([bring_forward(scene["nodes"]) for scene in document.get("scenes", [])]):
        say(f"the camera '{name}' is not exported: show it, or select it with the objects")
    elif name is None:
        say("the scene has no active camera: pocketray takes another, or frames the scene by itself")


def start_at_zero(document, binary, render, frame_start):
    """Blender's exporter puts frame n at n/fps seconds and ignores the base of frames per second."""
    inputs = {sampler["input"] for animation in document.get("animations", []) for sampler in animation["samplers"]}
    for accessor in (document["accessors"][index] for index in inputs):
        view = document["bufferViews"][accessor["bufferView"]]
        offset = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        times = numpy.frombuffer(binary, "<f4", accessor["count"], offset)
        times[:] = numpy.maximum(times - frame_start / render.fps, 0) * render.fps_base
        accessor["min"], accessor["max"] = [float(times.min())], [float(times.max())]


def add_default_material(document):
    """Blender shows surfaces without a material in grey, glTF as metals."""
    materials = document.setdefault("materials", [])
    for mesh in document.get("meshes", []):
        for primitive in mesh["primitives"]:
            primitive.setdefault("material", len(materials))
    materials.append({"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.8, 0.8, 1], "metallicFactor": 0},
                      "extensions": {"KHR_materials_specular": {"specularFactor": 0}}, "doubleSided": True})


def report_losses(scene, say):
    camera = scene.camera and scene.camera.data
    if camera and (camera.shift_x or camera.shift_y):
        say("the camera's shift is not carried over")
    if camera and camera.type == "PANO":
        say("the camera is panoramic: pocketray uses a perspective one")
    if camera and camera.dof.use_dof:
        say("the camera's depth of field is not carried over")
    meshes = [item for item in scene.objects if item.type == "MESH"]
    for item in meshes:
        keys = item.data.shape_keys
        if keys and keys.animation_data and item.modifiers:
            say(f"'{item.name}': its shape keys do not move, since it has modifiers: apply them")
    for item in scene.objects:
        animation = item.animation_data
        if animation and animation.use_nla and any(track.strips and not track.mute for track in animation.nla_tracks):
            say(f"'{item.name}': its NLA strips are not carried over: bake them to one action")
    materials = {slot.material for item in meshes for slot in item.material_slots if slot.material}
    plain = sorted(material.name for material in materials
                   if material.use_nodes and not SHADERS & {node.type for node in material.node_tree.nodes})
    lost = [image.name for image in bpy.data.images if image.source == "FILE" and image.users and image.size[0] == 0]
    if lost:
        say(f"pictures that cannot be read are left out: {', '.join(lost)}")
    if plain:
        say(f"materials without a Principled BSDF become white: {', '.join(plain)}")


def run_bake(command, names, say):
    """names: what to call temporary files in its messages."""
    last = None
    try:
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                              encoding="utf-8", errors="replace") as process:
            for line in process.stdout:
                if last:
                    say(last)
                for path, name in names.items():
                    line = line.replace(path, name)
                last = line.rstrip()
    except OSError as error:
        raise ExportError(f"{command[0]} does not start: {error.strerror}; install pocketray for this computer") from error
    if process.returncode != 0:
        reason = last or f"it ended with status {process.returncode}: try again, or report it"
        raise ExportError(f"bake: {reason.removeprefix('pocketray: ')}")
    if last:
        say(last)


def export(context, path, options=(), objects="RENDERED", say=print):
    program = find_program()
    check_output(path)
    scene, frame = context.scene, context.scene.frame_current
    with tempfile.TemporaryDirectory(prefix="pocketray-") as folder:
        model = os.path.join(folder, "scene.glb")
        names = {model: bpy.path.basename(bpy.data.filepath) or "the scene"}
        report_losses(scene, say)
        try:
            scene.frame_set(scene.frame_start)
            with area_lights_as_meshes(context, say):
                write_gltf(context, model, objects, say)
        finally:
            scene.frame_set(frame)
        document, binary = read_glb(model)
        put_camera_first(document, scene.camera and scene.camera.name, say)
        add_default_material(document)
        start_at_zero(document, binary, scene.render, scene.frame_start)
        write_glb(model, document, binary)
        command = [program, "bake", model, "-o", path, *options]
        if not any(option.split("=")[0] == "--environment" for option in options):
            world = write_world(scene.world, folder)
            command += ["--environment", world or "none"]  # a black world is no request for a studio
            if world is not None:
                names[world] = f"the world '{scene.world.name}'"
        run_bake(command, names, say)


class PocketrayPreferences(bpy.types.AddonPreferences):
    bl_idname = ADDON
    program: StringProperty(name="Program", subtype="FILE_PATH", default="pocketray",
                            description="The pocketray program: a path, or a name to look for on PATH")

    def draw(self, context):
        self.layout.prop(self, "program")


class ExportPocketray(bpy.types.Operator, ExportHelper):
    """Write the scene as one file for pocketray"""
    bl_idname = "export_scene.pocketray"
    bl_label = "Export pocketray"
    filename_ext = ".pray"
    filter_glob: StringProperty(default="*.pray", options={"HIDDEN"})
    objects: EnumProperty(name="Objects", default="RENDERED", items=(
        ("RENDERED", "Rendered", "Objects that a render shows"),
        ("VISIBLE", "Visible", "Objects that the viewport shows"),
        ("SELECTED", "Selected", "Selected objects; lights and the camera, too, only if selected")))
    radiosity: BoolProperty(name="Radiosity", description="Solve the light between diffuse surfaces; takes seconds to "
                            "minutes here and little on the device")
    compressed: BoolProperty(name="Compress Textures", description="Store blocks of 4 to 12 bits a texel instead of 32")

    def execute(self, context):
        options = ["--radiosity"] * self.radiosity + ["--textures", "compressed"] * self.compressed
        try:
            export(context, self.filepath, options, self.objects, lambda line: self.report({"INFO"}, line))
        except ExportError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


def add_to_menu(menu, context):
    menu.layout.operator(ExportPocketray.bl_idname, text="pocketray (.pray)")


def register():
    bpy.utils.register_class(PocketrayPreferences)
    bpy.utils.register_class(ExportPocketray)
    bpy.types.TOPBAR_MT_file_export.append(add_to_menu)


def unregister():
    bpy.types.TOPBAR_MT_file_export.remove(add_to_menu)
    bpy.utils.unregister_class(ExportPocketray)
    bpy.utils.unregister_class(PocketrayPreferences)


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    try:
        if not arguments:
            raise ExportError("say where to write: blender --background scene.blend --python pocketray.py -- OUT.pray")
        export(bpy.context, arguments[0], arguments[1:])
    except ExportError as error:
        print(f"pocketray: {error}", file=sys.stderr)
        sys.exit(1)


if __name__ == "__main__":
    main()
