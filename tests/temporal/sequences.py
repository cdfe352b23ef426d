#!/usr/bin/env python3
"""Writes the sequences of FIGURES.md as .glb files: models that move, in rooms that stand still.

Usage: sequences.py MODELS FOLDER [NAME...]
MODELS holds the models, which are no part of this project; a sequence whose models are absent is left
out with a message. NAME: fox-in-room, lamp-moves, robot-in-conference, robot-at-glass-table; default: all.
"""
import json
import math
import pathlib
import struct
import sys
import zipfile

FLOAT, UINT = 5126, 5125


class Document:
    """A glTF file in the making: its JSON and one buffer."""

    def __init__(self):
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "extensionsUsed": []}
        self.bytes = bytearray()
        self.root = self.json["scenes"][0]["nodes"]

    def add(self, kind, item):
        items = self.json.setdefault(kind, [])
        items.append(item)
        return len(items) - 1

    def add_bytes(self, data):
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.bytes += data
        return self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.bytes) - len(data), "byteLength": len(data)})

    def add_numbers(self, numbers, component, kind, width):
        data = struct.pack("<%d%s" % (len(numbers), "f" if component == FLOAT else "I"), *numbers)
        accessor = {"bufferView": self.add_bytes(data), "componentType": component, "count": len(numbers) // width,
                    "type": kind}
        if component == FLOAT:
            accessor["min"] = [min(numbers[i::width]) for i in range(width)]
            accessor["max"] = [max(numbers[i::width]) for i in range(width)]
        return self.add("accessors", accessor)

    def add_mesh(self, groups):
        """groups: (material, positions as a flat list); three vertices to a triangle, so that they are flat."""
        primitives = [{"attributes": {"POSITION": self.add_numbers(positions, FLOAT, "VEC3", 3)}, "material": material}
                      for material, positions in groups]
        return self.add("meshes", {"primitives": primitives})

    def add_material(self, red, green, blue):
        return self.add("materials", {"pbrMetallicRoughness": {"baseColorFactor": [red, green, blue, 1],
                                                               "metallicFactor": 0, "roughnessFactor": 1}})

    def add_light(self, place, intensity):
        extensions = self.json.setdefault("extensions", {})
        lights = extensions.setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"type": "point", "intensity": intensity})
        if "KHR_lights_punctual" not in self.json["extensionsUsed"]:
            self.json["extensionsUsed"].append("KHR_lights_punctual")
        self.root.append(self.add("nodes", {"translation": place, "extensions": {
            "KHR_lights_punctual": {"light": len(lights) - 1}}}))

    def add_camera(self, eye, target, degrees):
        back = normalized([e - t for e, t in zip(eye, target)])
        right = normalized(cross([0, 1, 0], back))
        up = cross(back, right)
        camera = self.add("cameras", {"type": "perspective",
                                      "perspective": {"yfov": math.radians(degrees), "znear": 0.1}})
        matrix = right + [0] + up + [0] + back + [0] + list(eye) + [1]
        self.root.append(self.add("nodes", {"camera": camera, "matrix": matrix}))

    def add_move(self, node, begin, end, seconds):
        """A straight way of the node, back and forth."""
        times = self.add_numbers([0, seconds / 2, seconds], FLOAT, "SCALAR", 1)
        places = self.add_numbers(begin + end + begin, FLOAT, "VEC3", 3)
        self.add_channels([{"sampler": 0, "target": {"node": node, "path": "translation"}}],
                          [{"input": times, "output": places, "interpolation": "LINEAR"}])

    def add_channels(self, channels, samplers):
        """All that moves is one animation: only the first of a file is played."""
        if "animations" not in self.json:
            self.json["animations"] = [{"channels": [], "samplers": []}]
        animation = self.json["animations"][0]
        for channel in channels:
            animation["channels"].append(dict(channel, sampler=channel["sampler"] + len(animation["samplers"])))
        animation["samplers"] += samplers

    def append(self, path, animation=None, repeats=1):
        """Adds a model under a node of its own and returns that; of its animations the named one, several times."""
        model, buffers = read_model(path)
        base = {kind: len(self.json.get(kind, [])) for kind in
                ("accessors", "bufferViews", "images", "samplers", "textures", "materials", "meshes", "skins", "nodes",
                 "cameras")}
        lights = self.json.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
        for view in model.get("bufferViews", []):
            begin = view.get("byteOffset", 0)
            copy = self.json["bufferViews"] if "bufferViews" in self.json else []
            self.add_bytes(buffers[view["buffer"]][begin:begin + view["byteLength"]])
            if "byteStride" in view:
                (copy or self.json["bufferViews"])[-1]["byteStride"] = view["byteStride"]
        for image in model.get("images", []):
            if "uri" in image:
                image["bufferView"] = self.add_bytes((path.parent / image.pop("uri")).read_bytes())
                image.setdefault("mimeType", "image/png")
            else:
                image["bufferView"] += base["bufferViews"]
            self.add("images", image)
        for kind, shift in SHIFTS.items():
            for item in model.get(kind, []):
                shift(item, base, len(lights))
                self.add(kind, item)
        model_lights = model.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
        if model_lights:
            self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})
            self.json["extensions"]["KHR_lights_punctual"]["lights"] += model_lights
        for name in model.get("extensionsUsed", []):
            if name not in self.json["extensionsUsed"]:
                self.json["extensionsUsed"].append(name)
        for source in model.get("animations", []):
            if source.get("name") == animation and animation:
                self.append_animation(source, base, repeats)
        scene = model["scenes"][model.get("scene", 0)]
        return self.add("nodes", {"children": [base["nodes"] + node for node in scene["nodes"]]})

    def append_animation(self, source, base, repeats):
        samplers = []
        for sampler in source["samplers"]:
            times = self.numbers(base["accessors"] + sampler["input"])
            values = self.numbers(base["accessors"] + sampler["output"])
            accessor = self.json["accessors"][base["accessors"] + sampler["output"]]
            width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
            length = source_seconds(self, source, base)
            all_times = [n * length + t for n in range(repeats) for t in times if n == 0 or t > times[0]]
            skipped = values[len(values) // len(times):]  # a round's first key is the last one's end
            all_values = values + skipped * (repeats - 1)
            samplers.append(dict(sampler, input=self.add_numbers(all_times, FLOAT, "SCALAR", 1),
                                 output=self.add_numbers(all_values, FLOAT, accessor["type"], width)))
        channels = [dict(channel, target=dict(channel["target"], node=base["nodes"] + channel["target"]["node"]))
                    for channel in source["channels"]]
        self.add_channels(channels, samplers)

    def numbers(self, index):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        begin = view["byteOffset"] + accessor.get("byteOffset", 0)
        assert accessor["componentType"] == FLOAT and "byteStride" not in view
        return list(struct.unpack_from("<%df" % (accessor["count"] * width), self.bytes, begin))

    def write(self, path):
        self.json["buffers"] = [{"byteLength": len(self.bytes)}]
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self.bytes) + b"\0" * (-len(self.bytes) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)))
            file.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)


def source_seconds(document, source, base):
    return max(document.numbers(base["accessors"] + s["input"])[-1] for s in source["samplers"])


def read_model(path):
    """The JSON of a .gltf or .glb file, and its buffers."""
    data = path.read_bytes()
    if data[:4] != b"glTF":
        model = json.loads(data)
        return model, [(path.parent / buffer["uri"]).read_bytes() for buffer in model["buffers"]]
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length]), [data[28 + length:]]


def shift_textures(item, base):
    """Shifts every texture reference of a material: an object "…Texture" with an index."""
    for key, value in item.items():
        if isinstance(value, dict):
            if key.endswith("Texture"):
                value["index"] += base["textures"]
            shift_textures(value, base)


def shift_texture(item, base, _):
    for key, kind in (("source", "images"), ("sampler", "samplers")):
        if key in item:
            item[key] += base[kind]


def shift_mesh(item, base, _):
    for primitive in item["primitives"]:
        assert "targets" not in primitive
        primitive["attributes"] = {name: n + base["accessors"] for name, n in primitive["attributes"].items()}
        for key, kind in (("indices", "accessors"), ("material", "materials")):
            if key in primitive:
                primitive[key] += base[kind]


def shift_skin(item, base, _):
    item["joints"] = [base["nodes"] + joint for joint in item["joints"]]
    for key, kind in (("skeleton", "nodes"), ("inverseBindMatrices", "accessors")):
        if key in item:
            item[key] += base[kind]


def shift_node(item, base, light_count):
    for key, kind in (("mesh", "meshes"), ("skin", "skins"), ("camera", "cameras")):
        if key in item:
            item[key] += base[kind]
    if "children" in item:
        item["children"] = [base["nodes"] + child for child in item["children"]]
    light = item.get("extensions", {}).get("KHR_lights_punctual")
    if light:
        light["light"] += light_count


def shift_accessor(item, base, _):
    if "bufferView" in item:
        item["bufferView"] += base["bufferViews"]
    assert "sparse" not in item


SHIFTS = {"samplers": lambda item, base, _: None, "accessors": shift_accessor, "textures": shift_texture,
          "materials": lambda item, base, _: shift_textures(item, base), "meshes": shift_mesh, "skins": shift_skin,
          "nodes": shift_node, "cameras": lambda item, base, _: None}


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def normalized(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def box(low, high):
    """The triangles of a box, as a flat list."""
    positions = []
    for axis in range(3):
        for side in (low, high):
            corners = []
            for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = [0, 0, 0]
                corner[axis] = side[axis]
                corner[(axis + 1) % 3] = (low, high)[u][(axis + 1) % 3]
                corner[(axis + 2) % 3] = (low, high)[v][(axis + 2) % 3]
                corners.append(corner)
            for i in (0, 1, 2, 0, 2, 3):
                positions += corners[i]
    return positions


def add_room(document, low, high, pillars):
    """Floor, walls without the front one, and pillars."""
    wall, floor, stone = (document.add_material(*color) for color in ((.7, .68, .6), (.4, .35, .3), (.3, .4, .55)))
    thick = 0.02 * (high[1] - low[1])
    walls = (box([low[0], low[1], low[2] - thick], [high[0], high[1], low[2]]) +
             box([low[0] - thick, low[1], low[2]], [low[0], high[1], high[2]]) +
             box([high[0], low[1], low[2]], [high[0] + thick, high[1], high[2]]))
    ground = box([low[0], low[1] - thick, low[2]], [high[0], low[1], high[2]])
    columns = [x for place, width in pillars
               for x in box([place[0] - width, low[1], place[1] - width], [place[0] + width, high[1], place[1] + width])]
    groups = [(wall, walls), (floor, ground)] + ([(stone, columns)] if columns else [])
    document.root.append(document.add("nodes", {"mesh": document.add_mesh(groups)}))


def fox_in_room(models):
    document = Document()
    add_room(document, [-260, 0, -200], [260, 260, 220], [((-170, -110), 18), ((160, -130), 18), ((190, 60), 14)])
    fox = document.append(models / "gltf/Fox.glb", "Survey")
    document.root.append(fox)
    document.add_light([120, 230, 120], 500000)
    document.add_light([-150, 200, 60], 200000)
    document.add_camera([180, 150, 380], [0, 60, -20], 45)
    return document


def lamp_moves(models):
    document = Document()
    lamp = document.append(models / "gltf/LightsPunctualLamp/LightsPunctualLamp.gltf")
    document.root.append(lamp)
    nodes = document.json["nodes"]
    node = next(n for n, item in enumerate(nodes) if item.get("name") == "Point.004_Orientation")
    place = nodes[node].pop("matrix")[12:15]
    nodes[node]["translation"] = place
    document.add_move(node, place, [place[0] - 1, place[1] + 0.5, place[2]], 2)
    return document


def robot_in_conference(models):
    document = Document()
    with zipfile.ZipFile(models / "rooms/conference.zip") as archive:
        lines = archive.read("conference.obj").decode().splitlines()
        colors = read_colors(archive.read("conference.mtl").decode().splitlines())
    vertices, groups, group = [], {}, None
    for line in lines:
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            vertices.append(tuple(float(x) / 200 for x in words[1:4]))
        elif words[0] == "usemtl":
            group = groups.setdefault(words[1], [])
        elif words[0] == "f":
            corners = [vertices[int(word.split("/")[0]) - (1 if word[0] != "-" else 0)] for word in words[1:]]
            for i in range(2, len(corners)):
                group += corners[0] + corners[i - 1] + corners[i]
    mesh = document.add_mesh([(document.add_material(*colors[name]), positions) for name, positions in groups.items()
                              if positions])
    document.root.append(document.add("nodes", {"mesh": mesh}))
    add_robot(document, models, 0.38, [-3, 0, 1.6], [5, 0, 1.6], 8)
    document.add_light([1, 2.9, -1], 120)
    document.add_light([5, 2.9, 0.5], 90)
    document.add_camera([7.2, 2.2, 2.3], [-0.5, 0.8, -1], 60)
    return document


def robot_at_glass_table(models):
    document = Document()
    add_room(document, [-6, -1.2, -5], [6, 5, 5], [((-4, -3), 0.3), ((4, -3), 0.3)])
    table = document.append(models / "rooms/glass-table.glb")
    document.root.append(table)
    add_robot(document, models, 0.7, [-4, -1.2, -2.4], [4, -1.2, -2.4], 6)
    document.add_light([3, 4.5, 3], 300)
    document.add_light([-3, 4, 1], 150)
    document.add_camera([2.5, 2.6, 6.5], [0, 0.2, -1], 45)
    return document


def add_robot(document, models, scale, begin, end, seconds):
    """A robot that walks to and fro, facing sideways."""
    robot = document.append(models / "animation/robot.glb", "Robot_Walking", math.ceil(seconds / 0.9583))
    half = math.sqrt(0.5)
    document.json["nodes"][robot].update({"scale": [scale] * 3, "rotation": [0, half, 0, half], "translation": begin})
    document.root.append(robot)
    document.add_move(robot, begin, end, seconds)


def read_colors(lines):
    colors, name = {}, None
    for words in (line.split() for line in lines):
        if words and words[0] == "newmtl":
            name = words[1]
            colors[name] = (.5, .5, .5)
        elif words and words[0] == "Kd":
            colors[name] = tuple(float(x) for x in words[1:4])
    return colors


SEQUENCES = {"fox-in-room": (fox_in_room, ["gltf/Fox.glb"]),
             "lamp-moves": (lamp_moves, ["gltf/LightsPunctualLamp/LightsPunctualLamp.gltf"]),
             "robot-in-conference": (robot_in_conference, ["rooms/conference.zip", "animation/robot.glb"]),
             "robot-at-glass-table": (robot_at_glass_table, ["rooms/glass-table.glb", "animation/robot.glb"])}


def main(arguments):
    if len(arguments) < 2 or any(name not in SEQUENCES for name in arguments[2:]):
        print(__doc__, file=sys.stderr)
        return 2
    models, folder = pathlib.Path(arguments[0]), pathlib.Path(arguments[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in arguments[2:] or SEQUENCES:
        make, needed = SEQUENCES[name]
        absent = [path for path in needed if not (models / path).exists()]
        if absent:
            print("%s: left out, %s is absent" % (name, absent[0]))
            continue
        make(models).write(folder / (name + ".glb"))
        print("%s: written" % name)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
