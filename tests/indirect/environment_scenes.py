"""Writes hall.obj, a court between two floors of arcades, and sun.hdr, a clouded sky with a sun, into a folder."""
import math
import pathlib
import random
import sys

SUN = (-0.55, 0.6, 0.58)


def unit(v):
    return [x / math.sqrt(sum(y * y for y in v)) for x in v]


def write_hall(folder):
    lines = ["mtllib hall.mtl"]
    boxes = []

    def box(low, high, material):
        boxes.append(material)
        lines.extend("v %g %g %g" % (x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1])
                     for z in (low[2], high[2]))
        lines.append("usemtl " + material)
        first = 8 * len(boxes) - 7
        for face in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)):
            lines.append("f " + " ".join(str(first + corner) for corner in face))

    box((-14, -0.2, -8), (14, 0, 8), "floor")
    for side in (-1, 1):
        z, x, depth, width = sorted((7.8 * side, 8 * side)), sorted((13.8 * side, 14 * side)), sorted(
            (4 * side, 8 * side)), sorted((10 * side, 14 * side))
        box((-14, 0, z[0]), (14, 9, z[1]), "wall")
        box((x[0], 0, -8), (x[1], 9, 8), "wall")
        for y in (4, 8.6):
            box((-14, y, depth[0]), (14, y + 0.4, depth[1]), "wall")
            box((width[0], y, -4), (width[1], y + 0.4, 4), "wall")
        for y, top in ((0, 4), (4.4, 8.6)):
            for i in range(-3, 4):
                box((3.3 * i - 0.25, y, 4.2 * side - 0.25), (3.3 * i + 0.25, top, 4.2 * side + 0.25), "stone")
    box((-1, 0, -1), (1, 0.8, 1), "stone")
    (folder / "hall.obj").write_text("\n".join(lines) + "\n")
    (folder / "hall.mtl").write_text(
        "newmtl floor\nKd .6 .55 .5\nnewmtl wall\nKd .7 .66 .6\nnewmtl stone\nKd .75 .75 .7\n")


def write_sky(folder, width=1024, height=512):
    rng, sun = random.Random(3), unit(SUN)
    waves = [[rng.uniform(-8, 8) for _ in range(3)] + [rng.uniform(0, 6.28)] for _ in range(14)]
    out = bytearray(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width))
    for row in range(height):
        theta = math.pi * (row + 0.5) / height
        for column in range(width):
            phi = 2 * math.pi * ((column + 0.5) / width - 0.5)
            way = (math.sin(theta) * math.sin(phi), math.cos(theta), -math.sin(theta) * math.cos(phi))
            cosine = sum(a * b for a, b in zip(way, sun))
            color = [0.25, 0.22, 0.18]
            if way[1] >= 0:
                height_share = math.sqrt(way[1])
                noise = sum(math.sin(w[0] * way[0] + w[1] * way[1] + w[2] * way[2] + w[3]) for w in waves) / 14
                cloud, halo = min(1, max(0, 5 * (noise - 0.05))), 0.8 * math.exp(40 * (cosine - 1))
                blue = [0.9 - 0.65 * height_share, 0.95 - 0.5 * height_share, 1 - 0.15 * height_share]
                color = [0.8 * b * (1 - cloud) + 1.3 * cloud + halo for b in blue]
                if cosine > math.cos(math.radians(0.45)):
                    color = [c + s for c, s in zip(color, (15000, 13500, 11000))]
            fraction, exponent = math.frexp(max(color))
            out += bytes(min(255, int(c * fraction * 256 / max(color))) for c in color) + bytes([exponent + 128])
    (folder / "sun.hdr").write_bytes(out)


if __name__ == "__main__":
    target = pathlib.Path(sys.argv[1])
    write_hall(target)
    write_sky(target)
