"""Checks pictures of the scenes of scenes.py: pictures.py CHECK PICTURE... Axes are Blender's, colours linear radiance."""
import array
import math
import sys

CHECKS = {}


def check(function):
    CHECKS[function.__name__] = function


class Picture:
    def __init__(self, path):
        with open(path, "rb") as file:
            assert file.readline() == b"PF\n", path
            self.width, self.height = map(int, file.readline().split())
            file.readline()
            self.values = array.array("f", file.read())

    def at(self, x, y):
        """The pixel of column x and row y, from the lower left."""
        start = 3 * (y * self.width + x)
        return self.values[start:start + 3]

    def mean(self):
        return [sum(self.values[c::3]) / (self.width * self.height) for c in range(3)]


def near(got, expected, tolerance, what):
    assert all(abs(a - b) <= tolerance * abs(b) + 1e-6 for a, b in zip(got, expected)), \
        f"{what}: {[round(a, 5) for a in got]} instead of {[round(b, 5) for b in expected]}"


# The stage's camera: at (0, -10, 4), turned by 70 degrees about x from looking down, 40 degrees high.

def seen(picture, x, y, z):
    tilt = math.radians(70)
    forward, up = (math.sin(tilt), -math.cos(tilt)), (math.cos(tilt), math.sin(tilt))
    depth = (y + 10) * forward[0] + (z - 4) * forward[1]
    scale = picture.height / 2 / math.tan(math.radians(20)) / depth
    row = picture.height / 2 + ((y + 10) * up[0] + (z - 4) * up[1]) * scale
    return picture.at(int(picture.width / 2 + x * scale), int(row))


def is_mostly(color, channel):
    return all(color[channel] > 4 * color[c] for c in range(3) if c != channel)


def mover_is_at(picture, x):
    for other in (-2, 0, 2):
        for z in (0.5, 1.5):  # an array modifier puts a second cube on top
            assert is_mostly(seen(picture, other, -0.5, z), 0) == (other == x), f"cube at {other}, {z}, instead of {x}"


@check
def stage(at_start, halfway, at_end):
    pictures = [Picture(path) for path in (at_start, halfway, at_end)]
    for picture, x in zip(pictures, (-2, 0, 2)):
        mover_is_at(picture, x)
        near(picture.at(picture.width // 2, picture.height - 2), (0.1, 0.2, 0.4), 0.01, "background")
        right, left = seen(picture, 3, -2, 0), seen(picture, -3, -2, 0)  # on the right, there is a hidden cube
        assert is_mostly(right, 2), f"floor on the right: {right}"
        assert min(left[:2]) > 4 * left[2], f"floor on the left: {left}"
    assert is_mostly(seen(pictures[0], 0, 1.5, 0.5), 1), "the green cube is not seen"
    assert is_mostly(seen(pictures[2], 0, 1.5, 0.5), 1), "the green cube is not seen"


def floor_under_area(width, height, inside):
    """Radiance of a floor of reflectance 1/2 under a light of 200 W, 4 m above. The light's radiance is P/4A, and so its
    area A leaves the mean of what its points contribute. inside: of -1 ... 1 squared."""
    steps = [(i + 0.5) / 200 - 1 for i in range(400)]
    terms = [16 / ((s * width / 2) ** 2 + (t * height / 2) ** 2 + 16) ** 2 for s in steps for t in steps if inside(s, t)]
    return 0.5 / math.pi * 200 / 4 * sum(terms) / len(terms)


@check
def lamps(ours, cycles):
    expected = [0.5 / math.pi * e for e in (300 / (4 * math.pi) / 16, 3, 500 / (4 * math.pi) / 25)]
    near(Picture(ours).mean(), expected, 0.01, "floor under point, sun and spot")
    near(Picture(ours).mean(), Picture(cycles).mean(), 0.02, "floor, by Cycles")


@check
def area(ours, cycles, below, above):
    floor = floor_under_area(3, 1.5, lambda s, t: True)
    color = (1, 0.5, 0.25)
    near(Picture(ours).mean(), [floor * c for c in color], 0.01, "floor under a rectangle")
    near(Picture(ours).mean(), Picture(cycles).mean(), 0.03, "floor under a rectangle, by Cycles")
    near(Picture(below).mean(), [200 / 4 / 4.5 * c for c in color], 0.01, "rectangle")
    near(Picture(above).mean(), [floor * c for c in color], 0.1, "floor through the rectangle's back")


@check
def ellipse(ours, cycles, below):
    floor = 0.8 / 0.5 * floor_under_area(4.5, 1.5, lambda s, t: s * s + t * t < 1)  # Blender's grey
    near(Picture(ours).mean(), [floor, floor * 0.5, floor * 0.25], 0.01, "floor under an ellipse")
    near(Picture(ours).mean(), Picture(cycles).mean(), 0.03, "floor under an ellipse, by Cycles")
    radiance = 200 / 4 / (math.pi / 4 * 4.5 * 1.5)
    near(Picture(below).mean(), [radiance, radiance * 0.5, radiance * 0.25], 0.01, "ellipse")


@check
def surroundings(ours, cycles):
    ours, cycles = Picture(ours), Picture(cycles)
    pixels = [(x, y) for x in range(ours.width) for y in range(ours.height)]
    difference = lambda place: sum(abs(a - b) for x, y in pixels for a, b in zip(ours.at(x, y), cycles.at(*place(x, y)))) \
        / (3 * len(pixels))
    same, mirrored = difference(lambda x, y: (x, y)), difference(lambda x, y: (ours.width - 1 - x, y))
    assert same < 0.005, f"differs from Cycles by {same}"
    assert mirrored > 0.05, f"the picture is too plain: {mirrored}"


CHECKS[sys.argv[1]](*sys.argv[2:])
