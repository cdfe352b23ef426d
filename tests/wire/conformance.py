#!/usr/bin/env python3
"""The real server against the second implementation of the device's side (device.py). It says hello, lists and fetches
scenes, asks for frames in both formats and with every encoding, and for what must be refused; pictures are compared byte for
byte with those of `pocketray render`.

Usage: conformance.py PROGRAM
"""
import os, re, signal, socket, struct, subprocess, sys, tempfile

sys.dont_write_bytecode = True
from device import *


# ---- The real program


class Server:
    def __init__(self, program, *more, threads="1", under=(), memory="16M"):
        words = [*under, program, "serve", "--listen", "127.0.0.1:0", "--threads", threads, "--memory", memory, *more]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        self.address = None
        for line in self.process.stdout:
            found = re.match(r"listening on (\S+):", line)
            if found:
                self.address = found.group(1)
                break
        assert self.address, "the server listens"

    def end(self):
        self.process.send_signal(signal.SIGINT)
        self.process.stdout.read()
        return self.process.wait()


def rendered(program, folder, scene, *words):
    path = os.path.join(folder, "picture.ppm")
    subprocess.run([program, "render", scene, "--size", "48x36", "--threads", "1", "-o", path, *words], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(path, "rb") as file:
        magic, width, height, most, pixels = re.match(rb"(P6)\s(\d+)\s(\d+)\s(\d+)\s(.*)", file.read(), re.S).groups()
    check((magic, width, height, most) == (b"P6", b"48", b"36", b"255"), "the picture is a PPM of that size")
    return pixels


def list_scenes(device):
    first = device.entry(message(SCENE_LIST, struct.pack("<H", 0)))
    scenes = [first] + [device.entry(message(SCENE_LIST, struct.pack("<H", i))) for i in range(1, first["count"])]
    for i, scene in enumerate(scenes):
        check(scene["index"] == i and scene["count"] == len(scenes) and scene["size"] > 0, "entry %d" % i)
        check(device.entry(message(SCENE_QUERY, scene["hash"])) == scene, "a query finds what the list has")
    none = device.entry(message(SCENE_LIST, struct.pack("<H", len(scenes))))
    unknown = device.entry(message(SCENE_QUERY, b"\x55" * 16))
    for entry, key in ((none, bytes(16)), (unknown, b"\x55" * 16)):
        check(entry == dict(hash=key, size=0, index=0, count=len(scenes), triangles=0, name=""), "no such scene")
    return {scene["name"]: scene for scene in scenes}


def fetch(device, scene):
    data = b""
    while True:
        ask = scene["hash"] + struct.pack("<QI", len(data), 65536)
        fields = device.ask(message(SCENE_FETCH, ask), SCENE_PIECE)
        check(fields[:24] == ask[:24], "a piece says what it is of")
        if len(fields) == 24:
            break
        data += fields[24:]
    check(len(data) == scene["size"] and scene_hash(data) == scene["hash"], "a scene has its length and its hash")
    fields = device.ask(message(SCENE_FETCH, scene["hash"] + struct.pack("<QI", 10, 7)), SCENE_PIECE)
    check(fields[24:] == data[10:17], "a piece is as long as was asked for")
    check(device.error(message(SCENE_FETCH, bytes(28))) == (UNKNOWN_SCENE, 0), "an unknown scene is not fetched")
    return data


def test_frames(program, folder, device, scenes):
    cornell, seesaw = scenes["cornell"]["hash"], scenes["seesaw"]["hash"]
    rgb = rendered(program, folder, "cornell")
    frame = 0
    for pixel_format in (RGB888, RGB565):
        for coding, largest, order in ((0, 1, ()), (1, 4, ()), (1, 255, ((10, 2), (1, 0), (25, 1))),
                                       (0, 16, tuple((1, (7 * i + 3) % 36) for i in range(36))), (1, 9, ())):
            frame += 1
            picture = device.frame(cornell, frame=frame, format=pixel_format, coding=coding, largest=largest, order=order)
            check(picture.compare(rgb), "cornell, format %d, coding %d" % (pixel_format, coding))
    # Rows of another scene over those of the first, in two parts of one frame.
    moved = rendered(program, folder, "seesaw", "--time", "0.5")
    frame += 1
    device.frame(seesaw, frame=frame, time=0.5, format=RGB888, largest=8)
    check(device.picture.compare(moved), "seesaw at half a second")
    check(device.preparations > 0, "a moving scene takes its time")
    frame += 1
    device.frame(cornell, frame=frame, end=10)
    check(device.picture.compare(rgb, (0, 10)) and device.picture.compare(moved, (10, 36)), "the upper rows alone")
    device.frame(cornell, frame=frame, first=10)
    check(device.picture.compare(rgb), "further rows of the same frame")
    # Changes: time and rows.
    frame += 1
    device.frame(seesaw, frame=frame, format=RGB565)
    for time in (0.25, 0.5, 1.0):
        frame += 1
        picture = device.frame(b"", FRAME_CHANGE, frame=frame, time=time, format=RGB565, order=((30, 1), (6, 0)))
        check(picture.compare(rendered(program, folder, "seesaw", "--time", str(time))), "a change to %g s" % time)
    # The same time again: nothing is traced, nothing is given.
    traced = device.traced
    frame += 1
    device.frame(b"", FRAME_CHANGE, frame=frame, time=1.0, format=RGB565)
    check(device.traced == traced and traced > 0, "an unchanged frame is not traced")
    # Settings.
    for changes, words in ((dict(samples=4), ["--samples", "4"]), (dict(depth=0), ["--depth", "0"]),
                           (dict(points=9, cut_off=0), ["--area-lights", "9", "--cut-off", "0"]),
                           (dict(normals=1, filter=1), ["--normals", "flat", "--texture-filter", "nearest"]),
                           (dict(off=1 << EFFECTS.index("shadow")), ["--effects=-shadow"]),
                           (dict(off=1 << EFFECTS.index("mirror")), ["--effects=-mirror"])):
        frame += 1
        picture = device.frame(seesaw, frame=frame, **changes)
        check(picture.compare(rendered(program, folder, "seesaw", *words)), "seesaw with %s" % changes)
    frame += 1
    device.frame(cornell, frame=frame, dither=1)
    check(all(abs(a - b) <= 1 for p, i in zip(device.picture.pixels, range(48 * 36)) for a, b in zip(p, rgb[3 * i:3 * i + 3])),
          "dithering changes a level at most")
    # A row, a column, a pixel.
    for width, height in ((300, 1), (1, 70), (1, 1)):
        frame += 1
        device.frame(cornell, frame=frame, width=width, height=height, largest=70)
    # A coarse picture of the whole frame before some of its rows; none if it is not asked for.
    for kind, words in ((FRAME_REQUEST, dict(format=RGB888, coarse=1)), (FRAME_REQUEST, dict(format=RGB565)),
                        (FRAME_CHANGE, dict(format=RGB565, coarse=1, first=20, end=30)), (FRAME_CHANGE, dict(format=RGB565))):
        frame += 1
        device.frame(cornell, kind, frame=frame, **words)
        check(device.coarse == (device.picture.squares() if "coarse" in words else None), "a coarse picture: %s" % words)
    # Maps of indirect light: ambient light is the same everywhere, that of the scene. Beside the box
    # there is nothing, where the first prediction goes on.
    ambient = [struct.unpack("<I", struct.pack("<f", x))[0] + (1 << 17) >> 18 for x in (.075, .058, .036)]
    for kind, pitch in ((FRAME_REQUEST, 8), (FRAME_CHANGE, 8), (FRAME_REQUEST, 5)):
        frame += 1
        lights = device.light(cornell, kind, pitch, frame=frame, indirect=2)
        check(len(lights) == -(-48 // pitch) * -(-36 // pitch) and set(lights) == {tuple(ambient), (0, 0, 0)}, "light")
    frame += 1
    check(len(set(device.light(cornell, frame=frame, pitch=4, indirect=4))) > 50, "light of virtual lights")
    # A map before rows of the frame, which are those of a frame without a map; then a change that keeps it.
    for kind, words in ((FRAME_REQUEST, dict(coarse=1, first=5, end=30)), (FRAME_REQUEST, dict(order=((20, 1), (16, 0)))), (FRAME_CHANGE, dict())):
        frame += 1
        picture = device.frame(cornell, kind, frame=frame, pitch=8, format=RGB888, indirect=2, **words)
        check(set(device.lights) == {tuple(ambient), (0, 0, 0)}, "light before rows")
        check(picture.compare(rendered(program, folder, "cornell", "--indirect", "ambient"), (5, 30)), "rows after light")
    frame += 1
    device.frame(cornell, frame=frame)
    # Near-lossless rows, over several frames of a moving camera.
    for turn in range(4):
        frame += 1
        near = device.frame(seesaw, frame=frame, time=turn / 4, format=RGB888, coding=2)
        wanted = rendered(program, folder, "seesaw", "--time", str(turn / 4))
        check(all(abs(a - b) <= 1 for p, i in zip(near.pixels, range(48 * 36)) for a, b in zip(p, wanted[3 * i:3 * i + 3])),
              "near-lossless pixels are off by at most a level")
    frame += 1
    picture = device.frame(seesaw, frame=frame, time=.25, animation=2**32 - 1, format=RGB888)
    check(picture.compare(rendered(program, folder, "seesaw", "--time", ".25", "--animation", "none")), "no animation plays")
    frame += 1
    check(not device.frame(seesaw, FRAME_CHANGE, frame=frame, time=3.).compare(rendered(program, folder, "seesaw", "--time", "3")),
          "a change keeps the choice of animation")
    check(device.encodings == {0, 1}, "every encoding has occurred, not just %s" % device.encodings)
    return frame


def test_views(device, scenes, rgb, frame):
    cornell = scenes["cornell"]
    fields = device.ask(request(cornell["hash"], VIEW_QUERY), VIEW_ENTRY)
    values = struct.unpack("<11fIffQI6f", fields[44:])
    camera = dict(eye=values[0:3], target=values[3:6], up=values[6:9], fov=values[9], extent=values[10], projection=values[11])
    exposure, rate, effects, triangles, low, high = *values[12:16], values[16:19], values[19:22]
    check(fields[20:44] == bytes(24), "a scene's origin")
    check(fields[:16] == cornell["hash"] and triangles == cornell["triangles"] and exposure > 0 and rate >= 0, "view_entry")
    check(all(a <= b for a, b in zip(low, high)) and effects < 1 << len(EFFECTS), "bounds and effects of a view")
    check(effects >> EFFECTS.index("shadow") & 1 and not effects >> EFFECTS.index("texture") & 1, "cornell has shadows alone")
    check(device.frame(cornell["hash"], frame=frame + 1, stated=1, camera=camera, exposure=exposure).compare(rgb),
          "the scene's camera and exposure, stated")
    fields = device.ask(request(cornell["hash"], VIEW_QUERY, measure=1, stated=1, camera=camera), VIEW_ENTRY)
    check(struct.unpack("<f", fields[92:96])[0] > 0, "a measured exposure")
    check(device.error(request(bytes(16), VIEW_QUERY)) == (UNKNOWN_SCENE, 0), "a view of an unknown scene")
    check(device.error(request(cornell["hash"], VIEW_QUERY, index=200)) == (BAD_REQUEST, 0), "a view from no camera")
    check(device.error(request(cornell["hash"], VIEW_QUERY, wanted=b"Walk")) == (BAD_REQUEST, 0), "a view of no animation")
    for wanted, index in ((b"", 0), (b"all", 0), (b"0", 0), (b"none", 2**32 - 1)):
        fields = device.ask(request(scenes["seesaw"]["hash"], VIEW_QUERY, wanted=wanted), VIEW_ENTRY)
        check(struct.unpack("<I", fields[16:20])[0] == index, "the animation that is asked for by %s" % wanted)
    return frame + 1


def test_pings_and_cancel(device, scenes, frame):
    for size in (0, 1, 65536):
        fields = device.ask(message(PING, struct.pack("<II", 7 + size, size)), PONG)
        check(struct.unpack("<I", fields[:4])[0] == 7 + size and len(fields) == 10 + size, "a pong of %d bytes" % size)
        check(struct.unpack("<H", fields[8:10])[0] >= 256, "a pong's price")
    # Large enough to be under way when it is cancelled.
    large = dict(width=1024, height=1024, samples=16, largest=1)
    device.send(request(scenes["statue"]["hash"], frame=frame + 1, **large) + message(CANCEL, struct.pack("<I", frame + 1)) +
                message(PING, struct.pack("<II", 1, 0)))
    kind, fields = device.receive()
    while kind == ROW_CHUNK:
        device.chunk_count += 1
        kind, fields = device.receive()
    check(kind == PONG, "a pong follows what was cancelled")
    device.picture = None  # the size has changed
    device.frame(scenes["cube"]["hash"], frame=frame + 2)
    device.send(message(CANCEL, struct.pack("<I", 2**32 - 1)))
    return frame + 2


def test_refusals(device, scenes, frame):
    cube = scenes["cube"]["hash"]
    still = dict(CAMERA, target=CAMERA["eye"])
    cases = [
        (request(cube, frame=0), BAD_REQUEST, 0), (request(cube, frame=frame - 1), BAD_REQUEST, frame - 1),
        (request(cube, FRAME_CHANGE, frame=frame, end=37), BAD_REQUEST, frame),
        (request(cube, frame=frame, index=250), BAD_REQUEST, frame),
        (request(cube, frame=frame, animation=1), BAD_REQUEST, frame),
        (request(cube, frame=frame, stated=1, camera=still), BAD_REQUEST, frame),
        (request(b"\x11" * 16, frame=frame), UNKNOWN_SCENE, frame),
        (request(cube, frame=frame, width=device.side + 1), TOO_LARGE, frame),
        (request(cube, VIEW_QUERY, height=device.side + 1), TOO_LARGE, 0),
        (request(cube, frame=frame, width=device.side, height=device.side), TOO_LARGE, frame),
    ]
    for data, code, number in cases:
        what = "request %s" % data[8:60].hex()
        answer = device.error(data, what)
        check(answer == (code, number), "refused by %s, expected %s: %s" % (answer, (code, number), what))
    device.ask(message(PING, bytes(8)), PONG)


def test_malformed(server, scenes):
    cube = scenes["cube"]["hash"]
    nan, big = float("nan"), 1.2e18
    values = [dict(time=nan), dict(time=1.1e9), dict(stated=2), dict(camera=dict(CAMERA, eye=(nan, 0, 0))),
              dict(camera=dict(CAMERA, up=(0, big, 0))), dict(camera=dict(CAMERA, fov=float("inf"))),
              dict(camera=dict(CAMERA, fov=0.0)), dict(camera=dict(CAMERA, fov=3.13)), dict(stated=1, camera=dict(CAMERA, fov=3.13)),
              dict(camera=dict(CAMERA, extent=-1.0, projection=1)), dict(camera=dict(CAMERA, extent=0.0)),
              dict(camera=dict(CAMERA, projection=2)), dict(width=0), dict(width=8193), dict(height=0, end=0), dict(height=8193),
              dict(samples=0), dict(samples=17), dict(depth=17), dict(points=0), dict(points=257), dict(cut_off=-1.0),
              dict(cut_off=65.0), dict(filter=5), dict(normals=2), dict(indirect=5), dict(virtual_lights=0), dict(virtual_lights=513), dict(compensation=2), dict(reconstruction=5), dict(selective=1.5), dict(selective=-0.5), dict(resolution=3), dict(light_tolerance=1.5), dict(light_tolerance=-0.5), dict(environment_shadows=257), dict(on=1 << 63), dict(off=1 << len(EFFECTS)),
              dict(exposure=-1.0),
              dict(exposure=big), dict(exposure=8e-19), dict(dither=2), dict(format=2), dict(first=36), dict(first=9, end=9), dict(end=37),
              dict(largest=0), dict(coding=3), dict(coarse=2), dict(pitch=1), dict(pitch=17)]
    # Orders that are none: too few rows, too many, an empty run, a place twice, a place beyond the last, too many runs.
    orders = [((35, 0),), ((37, 0),), ((0, 0), (36, 1)), ((20, 0), (16, 0)), ((20, 0), (16, 2)), ((1, 0),) * 65]
    values += [dict(order=order) for order in orders]
    cases = [request(cube, **v) for v in values]
    cases += [request(cube, FRAME_CHANGE, time=nan), request(cube, FRAME_CHANGE, end=8193), request(cube, FRAME_CHANGE, coarse=2)]
    cases += [request(cube, FRAME_CHANGE, order=order) for order in orders]
    cases += [request(cube, VIEW_QUERY, measure=2), request(cube, VIEW_QUERY, samples=0),
              request(cube, VIEW_QUERY, wanted=b"a\0b"), request(cube, VIEW_QUERY, wanted=b"a" * 64)]
    cases += [message(SCENE_FETCH, cube + struct.pack("<QI", 0, 65537)), message(SCENE_FETCH, cube + struct.pack("<QI", MASK, 0)),
              message(PING, struct.pack("<II", 1, 65537)), message(ERROR, struct.pack("<HI", 0, 0)),
              message(ERROR, struct.pack("<HI", 8, 0)), message(0), message(18), message(SCENE_LIST, b""),
              message(SCENE_LIST, bytes(3)), message(ROW_CHUNK, bytes(600)), message(ROW_CHUNK, bytes(4) + b"\1\0\0\0\2"), hello()]
    cases += [message(kind, bytes(size)) for kind, size in ((SCENE_ENTRY, 96), (SCENE_PIECE, 24), (PONG, 10), (COARSE_PICTURE, 14), (LIGHT_MAP, 20))]
    good = message(PING, bytes(8))
    cases += [good[:i] + bytes([good[i] ^ 1]) + good[i + 1:] for i in range(3, len(good))]
    for data in cases:
        device = Device(server.address)
        check(device.error(data, data.hex()[:80]) == (MALFORMED, 0), "malformed: %s" % data.hex()[:80])
        check(device.closed(waits=data is cases[0]), "malformed bytes end the connection")
        device.socket.close()
    for data, code in ((good, MALFORMED), (b"GET / HTTP/1.1\r\n\r\n", MALFORMED), (hello(3), WRONG_VERSION),
                       (message(HELLO, b"PRAY\42\0"), WRONG_VERSION), (hello(34, bytes(234)), WRONG_VERSION),
                       (message(HELLO, b"PRAY\41\0" + bytes(251)), MALFORMED), (hello(33, b"x"), MALFORMED),
                       (message(HELLO, b"pray" + bytes(18)), MALFORMED), (message(HELLO, hello()[8:28] + b"\xff\0"), MALFORMED)):
        device = Device(server.address, greets=False)
        check(device.error(data, data.hex()[:80]) == (code, 0), "first message %s" % data[:16])
        check(device.closed(waits=data is good), "a wrong first message ends the connection")
        device.socket.close()
    device = Device(server.address)
    device.send(message(ERROR, struct.pack("<HI", CLOSING, 0)))
    check(device.closed(), "a device's error ends the connection")
    device = Device(server.address)
    check(device.error(request(cube, FRAME_CHANGE, frame=5)) == (BAD_REQUEST, 5), "a change of nothing")
    device.frame(cube, frame=6)
    check(device.error(request(cube, FRAME_CHANGE, frame=7, first=3, end=3)) == (BAD_REQUEST, 7), "a change to nothing")


def test_places(program):
    server = Server(program, "--clients", "2")
    devices = [Device(server.address), Device(server.address)]
    third = Device(server.address)
    check(third.error(b"") == (BUSY, 0) and third.closed(), "one too many is told that the server is busy")
    server.process.send_signal(signal.SIGINT)
    check(all(device.error(b"") == (CLOSING, 0) and device.closed() for device in devices), "a server that ends says so")
    server.process.stdout.read()
    check(server.process.wait(60) == 3, "the server is interrupted")


# The lengths that PROTOCOL.md states for requests without an order.
def test_documented_lengths():
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "src", "wire", "PROTOCOL.md")
    with open(path, encoding="utf-8") as file:
        text = file.read()
    for kind, name in ((FRAME_REQUEST, "frame_request"), (FRAME_CHANGE, "frame_change"), (VIEW_QUERY, "view_query")):
        stated = re.search(r"^\| \d+ " + name + r" \|.*\| (\d+)", text, re.MULTILINE)
        sent = len(request(bytes(16), kind)) - len(message(kind, b""))
        check(stated and int(stated.group(1)) == sent, "%s has %d bytes" % (name, sent))


def main():
    program = os.path.abspath(sys.argv[1])
    test_documented_lengths()
    check(scene_hash(b"") == bytes(16), "the hash of nothing")
    check(scene_hash(b"pocketray") == struct.pack("<QQ", 0x165f8be4a8264bd0, 0x6c30a3d2c6337914), "the hash on the page")
    with tempfile.TemporaryDirectory() as folder:
        server = Server(program)
        try:
            device = Device(server.address)
            check((device.message_bytes, device.scene_bytes) == (512, 0), "what the server's hello states")
            scenes = list_scenes(device)
            data = fetch(device, scenes["cube"])
            path = os.path.join(folder, "fetched.pray")
            with open(path, "wb") as file:
                file.write(data)
            check(rendered(program, folder, path) == rendered(program, folder, "cube"), "a fetched scene renders the same")
            frame = test_frames(program, folder, device, scenes)
            frame = test_views(device, scenes, rendered(program, folder, "cornell"), frame)
            frame = test_pings_and_cancel(device, scenes, frame)
            test_refusals(device, scenes, frame)
            device.socket.close()
            test_malformed(server, scenes)
        finally:
            server.end()
        test_places(program)
    print("%d failed" % len(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
