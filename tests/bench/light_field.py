#!/usr/bin/env python3
"""Writes a hilly field of 3,920 triangles under N point lights as glTF: light_field.py N -o FILE.gltf

Hills and lights are the same on every machine; the lights' total power does not depend on N. tests/bench/FIGURES.md has
instructions per pixel over N.
"""
import argparse
import base64
import json
import math
import struct

COLUMNS, ROWS = 49, 40  # quads; units are metres
POWER = 24.0            # candela of all lights together


def height(x, z):
    return 0.5 * math.sin(0.55 * x) * math.cos(0.4 * z) + 0.25 * math.sin(1.7 * x + 0.9 * z)


def normal(x, z):
    step = 1e-3
    slope_x = (height(x + step, z) - height(x - step, z)) / (2 * step)
    slope_z = (height(x, z + step) - height(x, z - step)) / (2 * step)
    size = math.sqrt(slope_x * slope_x + 1 + slope_z * slope_z)
    return (-slope_x / size, 1 / size, -slope_z / size)


def place(index, base):
    """The van der Corput sequence."""
    result, digit = 0.0, 1.0 / base
    while index:
        index, rest = divmod(index, base)
        result, digit = result + rest * digit, digit / base
    return result


def field(light_count):
    points = [((c - COLUMNS / 2) * 0.4, (r - ROWS / 2) * 0.4) for r in range(ROWS + 1) for c in range(COLUMNS + 1)]
    positions = [(x, height(x, z), z) for x, z in points]
    indices = []
    for r in range(ROWS):
        for c in range(COLUMNS):
            a = r * (COLUMNS + 1) + c
            b, d = a + 1, a + COLUMNS + 1
            indices += [a, d, b, b, d, d + 1]
    parts = [b"".join(struct.pack("<3f", *p) for p in positions),
             b"".join(struct.pack("<3f", *normal(x, z)) for x, z in points),
             struct.pack("<%dI" % len(indices), *indices)]
    offsets = [sum(len(part) for part in parts[:i]) for i in range(3)]
    nodes = [{"mesh": 0},
             {"camera": 0, "translation": [0, 4, 11], "rotation": [-math.sin(0.2), 0, 0, math.cos(0.2)]}]
    for i in range(light_count):
        x, z = (place(i + 1, 2) - 0.5) * 18, (place(i + 1, 3) - 0.5) * 15
        nodes.append({"translation": [x, height(x, z) + 0.6 + 1.8 * place(i + 1, 5), z],
                      "extensions": {"KHR_lights_punctual": {"light": 0}}})
    return {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": POWER / light_count}]}},
        "buffers": [{"byteLength": sum(len(part) for part in parts),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(b"".join(parts)).decode()}],
        "bufferViews": [{"buffer": 0, "byteOffset": offsets[i], "byteLength": len(parts[i])} for i in range(3)],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3",
             "min": [min(p[k] for p in positions) for k in range(3)],
             "max": [max(p[k] for p in positions) for k in range(3)]},
            {"bufferView": 1, "componentType": 5126, "count": len(positions), "type": "VEC3"},
            {"bufferView": 2, "componentType": 5125, "count": len(indices), "type": "SCALAR"}],
        "materials": [{"doubleSided": True,
                       "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.6, 0.4, 1], "metallicFactor": 0,
                                                "roughnessFactor": 1},
                       "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "material": 0}]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.01}}],
        "nodes": nodes, "scenes": [{"nodes": list(range(len(nodes)))}], "scene": 0}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("lights", type=int, metavar="N")
    parser.add_argument("-o", "--output", required=True)
    options = parser.parse_args()
    if not 1 <= options.lights <= 4096:
        parser.error("N must be 1 to 4096")
    document = field(options.lights)
    document["extensionsUsed"].append("KHR_materials_specular")
    with open(options.output, "w") as file:
        json.dump(document, file)


if __name__ == "__main__":
    main()
