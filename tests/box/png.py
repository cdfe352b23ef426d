"""Decodes the PNG files that the program writes: 8-bit RGB, every row with the Paeth filter [PNG 3rd edition, sec. 9]."""
import struct
import zlib


def paeth(left, above, above_left):
    estimate = left + above - above_left
    return min((abs(estimate - left), 0, left), (abs(estimate - above), 1, above), (abs(estimate - above_left), 2, above_left))[2]


def decode(data):
    """(width, height, RGB bytes)."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG"
    at, chunks = 8, {}
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0] == zlib.crc32(kind + body), f"CRC of {kind}"
        chunks[kind] = chunks.get(kind, b"") + body
        at += 12 + length
    assert b"IEND" in chunks and b"sRGB" in chunks
    width, height, *kind = struct.unpack(">IIBBBBB", chunks[b"IHDR"])
    assert kind == [8, 2, 0, 0, 0], kind
    rows, stride = zlib.decompress(chunks[b"IDAT"]), 3 * width
    assert len(rows) == height * (stride + 1)
    picture, above = bytearray(), bytearray(stride)
    for y in range(height):
        assert rows[y * (stride + 1)] == 4
        row = bytearray(rows[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left, above_left = (row[i - 3], above[i - 3]) if i >= 3 else (0, 0)
            row[i] = (row[i] + paeth(left, above[i], above_left)) & 255
        picture += row
        above = row
    return width, height, bytes(picture)
