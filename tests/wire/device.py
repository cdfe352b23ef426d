"""The device's side of the wire, written from src/wire/PROTOCOL.md with only the Python standard library. check() records
whatever the server does wrong."""
import socket, struct, zlib

from picture import *

MASK = 2**64 - 1
HELLO, SCENE_LIST, SCENE_QUERY, SCENE_ENTRY, SCENE_FETCH, SCENE_PIECE, FRAME_REQUEST, ROW_CHUNK, CANCEL, ERROR, PING, PONG, \
    VIEW_QUERY, VIEW_ENTRY, FRAME_CHANGE, COARSE_PICTURE, LIGHT_MAP = range(1, 18)
WRONG_VERSION, MALFORMED, UNKNOWN_SCENE, TOO_LARGE, BAD_REQUEST, BUSY, CLOSING = range(1, 8)
EFFECTS = ["shadow", "specular", "mirror", "refraction", "absorption", "alpha-mask", "alpha-blend", "emission", "texture",
           "vertex-color", "smooth-normal", "ambient", "point-light", "spot-light", "directional-light", "area-light",
           "supersampling", "animation", "back-face-culling", "radiosity", "instant-radiosity",
           "ambient-gloss", "metallic-roughness", "normal-map", "occlusion", "mip-map", "selective", "environment",
           "undersampling", "source-selection", "environment-shadow",
           "anisotropy", "second-uv", "clear-coat", "sheen", "edge-sampling",
           "transmission-map", "rough-refraction", "iridescence", "diffuse-transmission"]

# ---- Scenes: the hash


def rotl(x, r):
    return (x << r | x >> (64 - r)) & MASK


def scene_hash(data):
    c1, c2 = 0x87c37b91114253d5, 0x4cf5ad432745937f
    h1 = h2 = 0
    whole = len(data) // 16 * 16
    for k1, k2 in struct.iter_unpack("<QQ", data[:whole]):
        h1 ^= rotl(k1 * c1 & MASK, 31) * c2 & MASK
        h1 = (rotl(h1, 27) + h2) * 5 + 0x52dce729 & MASK
        h2 ^= rotl(k2 * c2 & MASK, 33) * c1 & MASK
        h2 = (rotl(h2, 31) + h1) * 5 + 0x38495ab5 & MASK
    rest = data[whole:]
    if len(rest) > 8:
        h2 ^= rotl(int.from_bytes(rest[8:], "little") * c2 & MASK, 33) * c1 & MASK
    if rest:
        h1 ^= rotl(int.from_bytes(rest[:8], "little") * c1 & MASK, 31) * c2 & MASK
    h1 ^= len(data)
    h2 ^= len(data)
    h1 = h1 + h2 & MASK
    h2 = h2 + h1 & MASK

    def mix(h):
        h ^= h >> 33
        h = h * 0xff51afd7ed558ccd & MASK
        h ^= h >> 33
        h = h * 0xc4ceb9fe1a85ec53 & MASK
        return h ^ h >> 33

    h1, h2 = mix(h1), mix(h2)
    h1 = h1 + h2 & MASK
    h2 = h2 + h1 & MASK
    return struct.pack("<QQ", h1, h2)


# ---- Messages


def message(kind, fields=b""):
    head = struct.pack("<I", kind | len(fields) << 8)
    return head + struct.pack("<I", zlib.crc32(head + fields)) + fields


def hello(version=33, more=b""):
    return message(HELLO, b"PRAY" + struct.pack("<HHIQH", version, 8192, 1 << 21, 1 << 30, 256) + more)


CAMERA = dict(eye=(0, 0, 5), target=(0, 0, 0), up=(0, 1, 0), fov=0.8, extent=1.0, projection=0)


def pack_camera(camera):
    return struct.pack("<11fI", *camera["eye"], *camera["target"], *camera["up"], camera["fov"], camera["extent"],
                       camera["projection"])


DEFAULTS = dict(frame=1, time=0.0, animation=0, wanted=b"", stated=0, index=0, camera=CAMERA, width=48, height=36, samples=1, depth=8, points=4,
                cut_off=0.5, filter=0, normals=0, indirect=0, reconstruction=2, virtual_lights=64, compensation=0, selective=0.0, resolution=0, light_tolerance=0.0625, environment_shadows=32, edge_samples=0, on=0, off=0, tone=0, texture_side=16384, exposure=0.0, dither=0, format=RGB888, first=0, end=None,
                largest=16, coding=1, coarse=0, pitch=0, order=(), measure=0)


def request(scene, kind=FRAME_REQUEST, **changes):
    r = dict(DEFAULTS, **changes)
    end = r["height"] if r["end"] is None else r["end"]
    pitch = struct.pack("<B", r["pitch"]) if kind == FRAME_REQUEST else b""
    rows = struct.pack("<B", r["coarse"]) + pitch + struct.pack("<HH", r["first"], end) + bytes(x for run in r["order"] for x in run)
    settings = struct.pack("<HHBBHfBBBBHBfBfHBQQBH", r["width"], r["height"], r["samples"], r["depth"], r["points"], r["cut_off"],
                           r["filter"], r["normals"], r["indirect"],
                           r["reconstruction"], r["virtual_lights"], r["compensation"], r["selective"], r["resolution"], r["light_tolerance"],
                           r["environment_shadows"], r["edge_samples"], r["on"], r["off"], r["tone"], r["texture_side"])
    view = struct.pack("<BH", r["stated"], r["index"]) + pack_camera(r["camera"])
    if kind == FRAME_CHANGE:
        return message(kind, struct.pack("<Id6f", r["frame"], r["time"], *r["camera"]["eye"], *r["camera"]["target"]) + rows)
    if kind == VIEW_QUERY:
        return message(kind, scene + r["wanted"].ljust(64, b"\0") + view + settings + struct.pack("<B", r["measure"]))
    return message(kind, struct.pack("<I", r["frame"]) + scene + struct.pack("<dI", r["time"], r["animation"]) + view + settings +
                   struct.pack("<fBBHB", r["exposure"], r["dither"], r["format"], r["largest"], r["coding"]) + rows)


class Device:
    def __init__(self, address, greets=True):
        host, port = address.rsplit(":", 1)
        self.socket = socket.create_connection((host, int(port)), 60)
        self.bytes = b""
        self.chunk_count = 0
        self.traced = 0
        self.preparations = 0
        self.encodings = set()
        self.picture = None
        if greets:
            self.send(hello())
            kind, fields = self.receive()
            check(kind == HELLO and fields[:6] == b"PRAY\41\0", "the server says hello first, of version 33")
            self.side, self.message_bytes, self.scene_bytes, self.price = struct.unpack("<HIQH", fields[6:])
            check(self.price >= 256, "the hello's price")

    def send(self, data):
        try:
            self.socket.sendall(data)
        except OSError:
            pass  # closed; reading tells why

    def take(self, count):
        while len(self.bytes) < count:
            try:
                more = self.socket.recv(65536)
            except ConnectionResetError:
                more = b""
            if not more:
                return None
            self.bytes += more
        taken, self.bytes = self.bytes[:count], self.bytes[count:]
        return taken

    def receive(self):
        """The next message; type None: the server has closed."""
        head = self.take(8)
        if head is None:
            return None, b""
        kind, length = head[0], int.from_bytes(head[1:4], "little")
        fields = self.take(length)
        assert struct.unpack("<I", head[4:])[0] == zlib.crc32(head[:4] + fields), "a message has its CRC"
        return kind, fields

    def ask(self, data, expected):
        self.send(data)
        kind, fields = self.receive()
        check(kind == expected, "type %s answers, expected %d" % (kind, expected))
        return fields

    def error(self, data, what=""):
        """Code and frame of the error that answers."""
        self.send(data)
        kind, fields = self.receive()
        while kind not in (ERROR, None):
            kind, fields = self.receive()
        check(kind == ERROR, "an error answers: " + what)
        return struct.unpack("<HI", fields) if kind == ERROR else (0, 0)

    def closed(self, waits=True):
        """Whether the server closes; if it knows that nothing more comes, it need not leave time to read."""
        if not waits:
            self.socket.shutdown(socket.SHUT_WR)
        kind, _ = self.receive()
        while kind is not None:
            kind, _ = self.receive()
        return True

    def entry(self, data):
        fields = self.ask(data, SCENE_ENTRY)
        size, index, count, triangles = struct.unpack("<QHHI", fields[16:32])
        name = fields[32:].split(b"\0", 1)
        check(name[1].strip(b"\0") == b"", "a name is filled with zeros")
        return dict(hash=fields[:16], size=size, index=index, count=count, triangles=triangles, name=name[0].decode())

    def take_chunk(self, fields, frame, r, due):
        number, row, rows, _, traced, encoding = struct.unpack("<HHBHBB", fields[:9])
        data = fields[9:]
        if encoding & 2:
            self.price, data = struct.unpack("<H", data[:2])[0], data[2:]
        check(self.price >= 256, "a chunk's price")
        if encoding & 4:
            check(self.chunk_count == self.frame_chunk, "a frame's first chunk alone states its preparation")
            check(struct.unpack("<H", data[:2])[0] > 0, "a preparation takes some time")
            self.preparations += 1
            data = data[2:]
        self.traced += traced
        check(number == frame & 0xFFFF, "a chunk is of the frame")
        check(encoding >> 3 == self.chunk_count % 32, "chunks are counted")
        first, end = due[0]
        check(row + rows == end and row >= first, "the lowest rows of the next run come first")
        check(rows <= r["largest"], "a chunk of %d rows is no larger than asked" % rows)
        size = 3 if r["format"] == RGB888 else 2
        count = rows * r["width"]
        check(len(data) <= count * size, "a chunk is no longer than its pixels")
        self.encodings.add(encoding & 1)
        self.chunk_count += 1
        self.picture.decode(number, row, rows, encoding, data)
        due[0] = first, row
        if row == first:
            del due[0]

    def light(self, scene, kind=FRAME_REQUEST, pitch=8, **changes):
        """Requests a light map alone; returns its lights, as levels."""
        words = dict(changes, pitch=pitch, first=0, end=0)
        self.send(request(scene, kind, **words))
        return self.take_light(dict(DEFAULTS, **words))

    def take_light(self, r):
        kind, fields = self.receive()
        check(kind == LIGHT_MAP, "a light map comes, not %s" % kind)
        number, _, price = struct.unpack_from("<HHH", fields)
        check(number == r["frame"] & 0xFFFF and price >= 256, "the map's frame and price")
        return decode_light(fields[6:], -(-r["width"] // r["pitch"]), -(-r["height"] // r["pitch"]))

    def frame(self, scene, kind=FRAME_REQUEST, **changes):
        """Requests rows, and a light map if the pitch is not 0, and receives them."""
        r = dict(DEFAULTS, **changes)
        p = self.picture
        if not p or (p.width, p.height, p.format) != (r["width"], r["height"], r["format"]):
            self.picture = Picture(r["width"], r["height"], r["format"])
        self.send(request(scene, kind, **changes))
        end = r["height"] if r["end"] is None else r["end"]
        due, row = {}, r["first"]
        for rows, place in r["order"] or [(end - row, 0)]:
            due[place] = row, row + rows
            row += rows
        chunks = self.frame_chunk = self.chunk_count
        due = [due[place] for place in range(len(due))]  # runs in the order they are sent, without what has come
        self.coarse = None
        self.lights = self.take_light(r) if r["pitch"] else None
        while due:
            kind, fields = self.receive()
            if kind == COARSE_PICTURE:
                check(r["coarse"] and not self.coarse and self.chunk_count == chunks, "a coarse picture is due")
                check(struct.unpack("<H", fields[:2])[0] == r["frame"] & 0xFFFF, "a coarse picture is of the frame")
                size = 3 if r["format"] == RGB888 else 2
                self.coarse = [self.picture.load(fields, at) for at in range(2, len(fields), size)]
                continue
            if kind != ROW_CHUNK:
                check(False, "rows come, not %s %s: %s" % (kind, fields[:6], changes))
                break
            self.take_chunk(fields, r["frame"], r, due)
        return self.picture
