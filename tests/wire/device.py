"""The device's side of the wire, written from src/wire/PROTOCOL.md with only the Python standard library. check() records
whatever the server does wrong."""
import socket, struct, zlib

MASK = 2**64 - 1
HELLO, SCENE_LIST, SCENE_QUERY, SCENE_ENTRY, SCENE_FETCH, SCENE_PIECE, FRAME_REQUEST, ROW_CHUNK, CANCEL, ERROR, PING, PONG, \
    VIEW_QUERY, VIEW_ENTRY, FRAME_CHANGE, COARSE_PICTURE, LIGHT_MAP = range(1, 18)
WRONG_VERSION, MALFORMED, UNKNOWN_SCENE, TOO_LARGE, BAD_REQUEST, BUSY, CLOSING = range(1, 8)
RGB565, RGB888 = 0, 1
RED, GREEN, BLUE = range(3)
EFFECTS = ["shadow", "specular", "mirror", "refraction", "absorption", "alpha-mask", "alpha-blend", "emission", "texture",
           "vertex-color", "smooth-normal", "ambient", "point-light", "spot-light", "directional-light", "area-light",
           "supersampling", "animation", "back-face-culling", "radiosity", "instant-radiosity",
           "ambient-gloss", "metallic-roughness", "normal-map", "occlusion", "mip-map", "selective", "environment",
           "undersampling", "source-selection", "environment-shadow",
           "anisotropy", "second-uv", "clear-coat"]

failures = []


def check(condition, what):
    if not condition:
        failures.append(what)
        print("FAILED", what)


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


# ---- Chunks


class Code:
    """A range decoder: bits of adapting probability, numbers, even bits."""

    def __init__(self, data):
        check(not data or data[-1] != 0, "code does not end in zeros")
        self.data, self.at, self.range, self.code = data, 0, 0xFFFFFFFF, 0
        for _ in range(4):
            self.shift()

    def shift(self):
        self.code = self.code << 8 | (self.data[self.at] if self.at < len(self.data) else 0)
        self.at += 1

    def normalise(self):
        while self.range < 1 << 24:
            self.range <<= 8
            self.shift()

    def bit(self, model, key):
        zero = model.get(key, 2048)
        bound = (self.range >> 12) * zero
        if self.code < bound:
            self.range, model[key], value = bound, zero + (4096 - zero >> 4), 0
        else:
            self.code -= bound
            self.range, model[key], value = self.range - bound, zero - (zero >> 4), 1
        self.normalise()
        return value

    def even_bits(self, count):
        value = 0
        for _ in range(count):
            self.range >>= 1
            one = self.code >= self.range
            if one:
                self.code -= self.range
            value = value << 1 | one
            self.normalise()
        return value

    def number(self, model, key, bits_max):
        length = 0
        while length + 1 < bits_max and self.bit(model, (key, "longer", length)):
            length += 1
        if length == 0:
            return 1
        top = 2 | self.bit(model, (key, "second", length))
        return top << length - 1 | self.even_bits(length - 1)


def median(left, below, corner):
    """The prediction from neighbours."""
    if corner >= max(left, below):
        return min(left, below)
    return max(left, below) if corner <= min(left, below) else left + below - corner


def decode_light(data, columns, rows):
    """Levels of red, green and blue of a light map."""
    if len(data) == 6 * columns * rows:
        return [struct.unpack_from("<3H", data, 6 * i) for i in range(columns * rows)]
    code, model, values, sizes = Code(data), {}, [], []
    for i in range(columns * rows):
        left = i - 1 if i % columns else None
        above = i - columns if i >= columns else None
        near = [values[j] if j is not None else None for j in (left, above)]
        corner = values[above - 1] if left is not None and above is not None else None
        first = near[0] or near[1] or (0, 0, 0)
        second = near[1] or first
        third = corner or second if near[1] else first
        value, size = [], []
        for c in range(3):
            activity = min(3, sum(sizes[j][c] for j in (left, above) if j is not None))
            step = 0
            if code.bit(model, (c, "differs", activity)):
                falls = code.bit(model, (c, "falls", activity))
                step = code.number(model, (c, activity), 14)
                step = -step if falls else step
            value.append(median(first[c], second[c], third[c]) + step)
            size.append(abs(step))
        values.append(tuple(value))
        sizes.append(size)
    check(code.at >= len(data), "all bytes of a light map are read")
    levels = [(green + red, green, green + blue) for green, red, blue in values]
    check(all(0 <= level <= 6112 for light in levels for level in light), "levels are in range")
    return levels


class Picture:
    """The picture as last sent, the frame before, and the statistics of the code."""

    def __init__(self, width, height, pixel_format):
        self.width, self.height, self.format = width, height, pixel_format
        self.levels = (32, 64, 32) if pixel_format == RGB565 else (256, 256, 256)
        black = [(0, 0, 0)] * width
        self.rows = [black] * height
        self.before = [black] * height
        self.frames = [0] * height
        self.model = {}
        self.blocks = [("spatial", 0, 0)] * ((width + 7) // 8)

    @property
    def pixels(self):
        return [pixel for row in self.rows for pixel in row]

    def load(self, body, at):
        if self.format == RGB888:
            return body[at], body[at + 1], body[at + 2]
        value = body[at] | body[at + 1] << 8
        return value >> 11, value >> 5 & 63, value & 31

    def decode(self, frame, row, row_count, encoding, data):
        for y in range(row, row + row_count):
            self.before[y], self.rows[y], self.frames[y] = self.rows[y], [(0, 0, 0)] * self.width, frame
        size = 3 if self.format == RGB888 else 2
        if encoding & 1:
            check(len(data) <= row_count * self.width * size, "code is no longer than its pixels")
            self.decode_blocks(frame, row, row_count, Code(data))
            return
        check(len(data) == row_count * self.width * size, "the body has the length of its pixels")
        for y in range(row_count):
            self.rows[row + y] = [self.load(data, (y * self.width + x) * size) for x in range(self.width)]
        self.blocks = [("spatial", 0, 0)] * len(self.blocks)

    def decode_blocks(self, frame, row, row_count, code):
        self.above_differ = [0] * (self.width + 1)
        end = row + row_count
        while end > row:
            begin = max(row, end - 8)
            beside, self.beside_differ = self.blocks[0], {}
            for left in range(0, self.width, 8):
                right = min(left + 8, self.width)
                block = self.choice(code, beside, self.blocks[left // 8])
                self.fill(frame, code, block, left, right, begin, end)
                self.blocks[left // 8] = beside = block
            end = begin
        check(code.at >= len(code.data), "all of the code is used")

    def choice(self, code, beside, below):
        def like(kind):
            return (beside[0] == kind) + (below[0] == kind)

        _, x, y = beside
        if code.bit(self.model, ("spatial?", like("spatial"))):
            return "spatial", x, y
        if not code.bit(self.model, ("same motion?", like("exact"))):
            moved = []
            for axis, start in (0, x), (1, y):
                other = axis == 1 and moved[0] != x
                if code.bit(self.model, ("motion differs?", axis, other)):
                    falls = code.bit(self.model, ("motion falls?", axis))
                    by = code.number(self.model, ("motion", axis), 8)
                    start += -by if falls else by
                moved.append(start)
            x, y = moved
        return ("exact" if code.bit(self.model, ("exact?", like("exact"))) else "temporal"), x, y

    def fill(self, frame, code, block, left, right, begin, end):
        kind, x, y = block
        if kind != "spatial":
            check(left + x >= 0 and right + x <= self.width and begin + y >= 0 and end + y <= self.height,
                  "motion stays inside the picture")
        below_differs = 1
        for row in reversed(range(begin, end)):
            moved = None
            if kind != "spatial":
                source = self.before if self.frames[row + y] == frame else self.rows
                moved = source[row + y][left + x:right + x]
            last, any_beside = self.beside_differ.get(row, (0, 0))
            differ = 0
            if kind != "exact":
                differ = below_differs = code.bit(self.model, (kind, "row differs?", below_differs, any_beside))
            for column in range(left, right):
                guess, context, activity = self.guess(row, column, right, row + 1 == end, moved and moved[column - left], last)
                last = code.bit(self.model, (kind, "differs?", context)) if differ else 0
                self.rows[row][column] = self.difference(code, kind, guess, activity) if last else guess
                self.above_differ[column] = last
            self.beside_differ[row] = last, differ

    def guess(self, row, column, right, lowest, moved, last):
        """The prediction of a pixel, the context of whether it differs, and its activity."""
        below_row = self.rows[row + 1] if row + 1 < self.height else [(0, 0, 0)] * self.width
        below = below_row[column]
        before = self.rows[row][column - 1] if column else below
        corner = below_row[column - 1] if column else below
        beyond = below_row[column + 1] if column + 1 < self.width and (lowest or column + 1 < right) else below
        history = last, self.above_differ[column], self.above_differ[column + 1]
        if moved:
            return moved, (history, moved != before, moved != below, before != below), sum(history)
        differences = before != corner, below != corner, beyond != below
        guess = tuple(
            min(a, b) if c >= max(a, b) else max(a, b) if c <= min(a, b) else a + b - c
            for a, b, c in zip(before, below, corner))
        return guess, (history, differences), sum(differences)

    def difference(self, code, kind, guess, activity):
        pixel, signs = list(guess), ()
        for channel in GREEN, RED, BLUE:
            levels = self.levels[channel]
            by = 0
            if signs == (0, 0) or code.bit(self.model, (kind, "channel differs?", signs, activity)):
                falls = code.bit(self.model, (kind, "falls?", signs))
                by = code.number(self.model, (kind, channel, activity), levels.bit_length() - 1)
                pixel[channel] = (guess[channel] + (-by if falls else by)) % levels
                activity = min(3, by.bit_length())
                signs += (-1 if falls else 1,)
            else:
                activity = activity if signs else 0
                signs += (0,)
        return tuple(pixel)

    def squares(self):
        """The coarse picture of it."""
        return [self.rows[y][x] for y in range(0, self.height, 8) for x in range(0, self.width, 8)]

    def compare(self, rgb, rows=None):
        """Whether it equals `rgb`, bytes of R, G and B, converted to this format."""
        first, end = rows or (0, self.height)
        for i in range(first * self.width, end * self.width):
            level = rgb[3 * i:3 * i + 3]
            # 565 holds its nearest value for each of 256 levels.
            wanted = tuple(level) if self.format == RGB888 else tuple(
                (2 * x * (n - 1) + 255) // 510 for x, n in zip(level, self.levels))
            if self.pixels[i] != wanted:
                return False
        return True


# ---- Messages


def message(kind, fields=b""):
    head = struct.pack("<I", kind | len(fields) << 8)
    return head + struct.pack("<I", zlib.crc32(head + fields)) + fields


def hello(version=28, more=b""):
    return message(HELLO, b"PRAY" + struct.pack("<HHIQH", version, 8192, 1 << 21, 1 << 30, 256) + more)


CAMERA = dict(eye=(0, 0, 5), target=(0, 0, 0), up=(0, 1, 0), fov=0.8, extent=1.0, projection=0)


def pack_camera(camera):
    return struct.pack("<11fI", *camera["eye"], *camera["target"], *camera["up"], camera["fov"], camera["extent"],
                       camera["projection"])


DEFAULTS = dict(frame=1, time=0.0, stated=0, index=0, camera=CAMERA, width=48, height=36, samples=1, depth=8, points=4, area_shadows=0, area_irradiance=1,
                cut_off=0.5, filter=0, normals=0, indirect=0, reconstruction=2, virtual_lights=64, compensation=0, selective=0.0, resolution=0, light_tolerance=0.0625, environment_shadows=32, on=0, off=0, exposure=0.0, dither=0, format=RGB888, first=0, end=None,
                largest=16, coding=1, coarse=0, pitch=0, order=(), measure=0)


def request(scene, kind=FRAME_REQUEST, **changes):
    r = dict(DEFAULTS, **changes)
    end = r["height"] if r["end"] is None else r["end"]
    pitch = struct.pack("<B", r["pitch"]) if kind == FRAME_REQUEST else b""
    rows = struct.pack("<B", r["coarse"]) + pitch + struct.pack("<HH", r["first"], end) + bytes(x for run in r["order"] for x in run)
    settings = struct.pack("<HHBBHBBfBBBBHBfBfHQQ", r["width"], r["height"], r["samples"], r["depth"], r["points"], r["area_shadows"], r["area_irradiance"], r["cut_off"],
                           r["filter"], r["normals"], r["indirect"],
                           r["reconstruction"], r["virtual_lights"], r["compensation"], r["selective"], r["resolution"], r["light_tolerance"],
                           r["environment_shadows"], r["on"], r["off"])
    view = struct.pack("<BH", r["stated"], r["index"]) + pack_camera(r["camera"])
    if kind == FRAME_CHANGE:
        return message(kind, struct.pack("<Id6f", r["frame"], r["time"], *r["camera"]["eye"], *r["camera"]["target"]) + rows)
    if kind == VIEW_QUERY:
        return message(kind, scene + view + settings + struct.pack("<B", r["measure"]))
    return message(kind, struct.pack("<I", r["frame"]) + scene + struct.pack("<d", r["time"]) + view + settings +
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
            check(kind == HELLO and fields[:6] == b"PRAY\34\0", "the server says hello first, of version 28")
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
        """Requests a light map; returns its lights, as levels."""
        r = dict(DEFAULTS, **changes)
        self.send(request(scene, kind, pitch=pitch, **changes))
        kind, fields = self.receive()
        check(kind == LIGHT_MAP, "a light map comes, not %s" % kind)
        number, _, price = struct.unpack_from("<HHH", fields)
        check(number == r["frame"] & 0xFFFF and price >= 256, "the map's frame and price")
        return decode_light(fields[6:], -(-r["width"] // pitch), -(-r["height"] // pitch))

    def frame(self, scene, kind=FRAME_REQUEST, **changes):
        """Requests rows and receives them."""
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
