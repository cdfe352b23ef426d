#!/usr/bin/env python3
"""Renders models with pocketray and with Cycles under the same light, and judges the difference.

Three pictures of each model: pocketray's, Cycles', the ꟻLIP map; the worst come first. `make contact-sheet` calls it. The
light: an environment that varies with height and has a bright window to the left of the camera, and for glTF two suns.
The models' own lights and cameras are left out.
"""
import argparse
import array
import json
import math
import os
import shutil
import struct
import sys

import sheet
from sheet import HEIGHT, WIDTH, fail

SAMPLES, DEPTH = 16, 8
MEAN_MAX = 0.05  # of all models
SUNS = ({"direction": (0.35, 0.8, 0.5), "irradiance": 1.5}, {"direction": (-0.75, 0.35, 0.55), "irradiance": 0.5})
WINDOW = {"direction": (-0.6, 0.3, 0.75), "cosine": 0.94, "radiance": 5.0}


def unit(v):
    size = math.sqrt(sum(x * x for x in v))
    return tuple(x / size for x in v)


def radiance(direction):
    window = unit(WINDOW["direction"])
    if sum(a * b for a, b in zip(direction, window)) > WINDOW["cosine"]:
        return (WINDOW["radiance"],) * 3
    low, middle, high = (0.16, 0.13, 0.1), (0.5, 0.5, 0.5), (0.25, 0.35, 0.6)
    y = direction[1]
    return tuple(b + (c - b) * y if y > 0 else b + (a - b) * min(1, -4 * y) for a, b, c in zip(low, middle, high))


def direction_of(u, v):
    """Of a point of the picture, as pocketray has it."""
    azimuth, height = 2 * math.pi * (u - 0.5), math.pi * (0.5 - v)
    return (math.sin(azimuth) * math.cos(height), math.sin(height), -math.cos(azimuth) * math.cos(height))


def write_environment(path, width=512, height=256):
    """A Radiance picture, not compressed."""
    with open(path, "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width))
        for row in range(height):
            for column in range(width):
                color = radiance(direction_of((column + 0.5) / width, (row + 0.5) / height))
                fraction, exponent = math.frexp(max(color))
                scale = fraction * 256 / max(color)
                file.write(bytes([int(x * scale) for x in color] + [exponent + 128]))


def keep_default_scene(document):
    """Empties the nodes of other scenes, which Blender would put upon it."""
    scenes, nodes = document.get("scenes", []), document.get("nodes", [])
    if not scenes:
        return
    document["scenes"], document["scene"] = [scenes[document.get("scene", 0)]], 0
    left, kept = list(document["scenes"][0].get("nodes", [])), set()
    while left:
        index = left.pop()
        if index not in kept:
            kept.add(index)
            left += nodes[index].get("children", [])
    for index in set(range(len(nodes))) - kept:
        nodes[index].pop("mesh", None)


def relight(document):
    """Replaces the lights of a glTF document by the suns."""
    keep_default_scene(document)
    for node in document.get("nodes", []):
        node.get("extensions", {}).pop("KHR_lights_punctual", None)
    used = set(document.get("extensionsUsed", [])) | {"KHR_lights_punctual"}
    document["extensionsUsed"] = sorted(used)
    document.setdefault("extensions", {})["KHR_lights_punctual"] = {
        "lights": [{"type": "directional", "intensity": sun["irradiance"]} for sun in SUNS]}
    for number, sun in enumerate(SUNS):
        x, y, z = unit(sun["direction"])
        turn = (-y, x, 0, 1 + z)  # from +z to the sun
        size = math.sqrt(sum(q * q for q in turn))
        document.setdefault("nodes", []).append(
            {"rotation": [q / size for q in turn], "extensions": {"KHR_lights_punctual": {"light": number}}})
        for scene in document.get("scenes", []):
            scene.setdefault("nodes", []).append(len(document["nodes"]) - 1)


def spell_out_instances(document, binary):
    """Gives each instance of EXT_mesh_gpu_instancing a node, as Blender 3.4 ignores the extension. Only of floats."""
    def values(index):
        accessor = document["accessors"][index]
        width = {"VEC3": 3, "VEC4": 4}[accessor["type"]]
        view = document["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        stride = view.get("byteStride", 4 * width)
        return [struct.unpack_from(f"<{width}f", binary, start + stride * k) for k in range(accessor["count"])]

    for node in list(document.get("nodes", [])):
        instances = node.get("extensions", {}).pop("EXT_mesh_gpu_instancing", None)
        if not instances:
            continue
        parts = {name.lower(): values(index) for name, index in instances["attributes"].items() if not name.startswith("_")}
        mesh = node.pop("mesh")
        for place in zip(*parts.values()):
            node.setdefault("children", []).append(len(document["nodes"]))
            document["nodes"].append({"mesh": mesh, **{name: list(value) for name, value in zip(parts, place)}})


def copy_glb(source, path, change):
    with open(source, "rb") as file:
        data = file.read()
    size = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + size])
    rest = data[20 + size:]
    change(document, rest[8:])
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<III", 0x46546C67, 2, 20 + len(text) + len(rest)))
        file.write(struct.pack("<II", len(text), 0x4E4F534A) + text + rest)


def copy_for_blender(path):
    """A copy without what Blender does not read. Returns its path."""
    if not path.endswith(".glb"):
        return path
    copy = path.removesuffix(".glb") + ".blender.glb"
    copy_glb(path, copy, spell_out_instances)
    return copy


def copy_with_suns(source, folder):
    """A copy of a model, lit by the suns if it is glTF. Returns its path."""
    if source.endswith(".glb"):
        path = os.path.join(folder, os.path.basename(source))
        copy_glb(source, path, lambda document, _: relight(document))
        return path
    folder = os.path.join(folder, os.path.basename(source) + ".files")
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(os.path.dirname(source), folder)
    path = os.path.join(folder, os.path.basename(source))
    if source.endswith(".gltf"):
        with open(path) as file:
            document = json.load(file)
        relight(document)
        with open(path, "w") as file:
            json.dump(document, file)
    return path


def models_in(folder):
    """Names and paths of the models that both programs read: glTF and OBJ."""
    found = {}
    for part in ("gltf", "animation", "mesh", "cornell/mcguire", "rooms"):
        for place, _, files in sorted(os.walk(os.path.join(folder, part))):
            for file in sorted(files):
                if file.endswith((".glb", ".gltf", ".obj")):
                    found[os.path.splitext(file)[0]] = os.path.join(place, file)
    return found


def display(radiance_file, picture):
    """Radiance as pixels, 1 being white: a picture itself would be exposed for the suns."""
    with open(radiance_file, "rb") as file:
        header, size, scale = (file.readline() for _ in range(3))
        width, height = (int(x) for x in size.split())
        values = array.array("f", file.read())
    if header != b"PF\n" or float(scale) >= 0 or sys.byteorder != "little":
        fail(f"{radiance_file} is not a little-endian PFM")
    level = lambda x: int(255 * (12.92 * x if x < 0.0031308 else 1.055 * min(x, 1) ** (1 / 2.4) - 0.055) + 0.5)
    with open(picture, "wb") as file:
        file.write(b"P6\n%d %d\n255\n" % (width, height))
        for row in reversed(range(height)):
            file.write(bytes(level(max(x, 0)) for x in values[3 * width * row:3 * width * (row + 1)]))


def judge(program, model, camera, folder, environment):
    """Renders with pocketray and compares. Returns the row of the table; None if it cannot be rendered."""
    picture, radiance_file, difference = (os.path.join(folder, model["name"] + end)
                                          for end in (".pocketray.ppm", ".pocketray.pfm", ".flip.png"))
    status, _, messages = sheet.run([program, "render", model["file"], "--size", f"{WIDTH}x{HEIGHT}", "--samples",
                                     str(SAMPLES), "--depth", str(DEPTH), "--memory", "1G", "--indirect", "ambient",
                                     "--camera", camera, "--environment", environment, "-o", radiance_file])
    if status:
        print(f"{model['name']}: {messages.splitlines()[-1]}", file=sys.stderr)
        return None
    display(radiance_file, picture)
    return {"model": model["name"], "flip": sheet.flip(program, model["picture"], picture, difference),
            "warnings": sheet.warnings_in(messages, "framing its bounds", "--indirect has no effect"),
            "pictures": [picture, model["picture"], difference]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    sheet.add_options(parser, "build/contact-sheet", 64, 4)
    parser.add_argument("--shared", default="../shared", help="where scenes/ is")
    parser.add_argument("--models", nargs="+", metavar="NAME", help="only these, by name without ending")
    parser.add_argument("--fail-above", type=float, metavar="MEAN",
                        help=f"exit with 1 if the mean ꟻLIP exceeds it ({MEAN_MAX} for all models)")
    arguments = parser.parse_args()
    scenes = os.path.join(arguments.shared, "scenes")
    if not os.path.isdir(scenes):
        print(f"skipped: {scenes} is not there")
        return
    sheet.check_tools()
    folder = os.path.abspath(arguments.folder)
    os.makedirs(os.path.join(folder, "models"), exist_ok=True)
    found = models_in(scenes)
    names = arguments.models or list(found)
    for name in names:
        if name not in found:
            fail(f"no model '{name}' in {scenes}: " + ", ".join(found))
    environment = os.path.join(folder, "environment.hdr")
    write_environment(environment)
    suns = [dict(sun, direction=unit(sun["direction"])) for sun in SUNS]
    light = {"width": WIDTH, "height": HEIGHT, "samples": arguments.samples, "depth": DEPTH, "diffuse_bounces": 0, "clamp": 0,
             "environment": environment}
    sheet.forget_others(folder, ".cycles.png", ("cycles.py", "cycles_picture.py"), light, SUNS, sheet.digest(environment))
    files = {name: copy_with_suns(found[name], os.path.join(folder, "models")) for name in names}
    jobs = dict(light, models=[{"name": name, "file": files[name], "blender file": copy_for_blender(files[name]),
                                "suns": [] if found[name].endswith(".obj") else suns,
                                "picture": os.path.join(folder, name + ".cycles.png")} for name in names])
    path = os.path.join(folder, "jobs.json")
    with open(path, "w") as file:
        json.dump(jobs, file)
    print(f"rendering {len(names)} models with Cycles", flush=True)
    if os.path.exists(path + ".cameras"):
        os.remove(path + ".cameras")
    failed, messages = sheet.run_blender(os.path.join(sheet.HERE, "cycles.py"), path)
    if failed or not os.path.exists(path + ".cameras"):
        fail("Blender failed:\n" + (failed or messages[-2000:]))
    with open(path + ".cameras") as file:
        answer = json.load(file)
    cameras = answer["cameras"]
    for name, reason in answer["reasons"].items():
        print(f"{name}: Blender: {reason}", file=sys.stderr)
    rows = [judge(arguments.program, model, cameras[model["name"]], folder, environment) for model in jobs["models"]
            if model["name"] in cameras]
    limit = arguments.fail_above if arguments.models or arguments.fail_above is not None else MEAN_MAX
    sheet.report(rows, names, arguments, limit)


if __name__ == "__main__":
    main()
