"""Codes of rows and of light maps, read as src/wire/PROTOCOL.md describes them, with only the Python standard library. check() records
whatever is wrong."""
import struct

RGB565, RGB888 = 0, 1
RED, GREEN, BLUE = range(3)

failures = []


def check(condition, what):
    if not condition:
        failures.append(what)
        print("FAILED", what)


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
