"""PNG files without an image library."""
import struct
import zlib

import numpy as np


def read_png(file):
    """8-bit grey or RGB, or 16-bit grey PNG, not interlaced, as an array."""
    data, at, pixels = file.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        chunk = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, color = struct.unpack(">IIBB", chunk[:10])
        elif kind == b"IDAT":
            pixels += chunk
        at += 12 + length
    channels = {0: 1, 2: 3}[color]
    step = channels * bits // 8  # bytes per pixel
    stride = width * step
    raw = np.frombuffer(zlib.decompress(pixels), np.uint8).reshape(height, stride + 1)
    rows = np.zeros((height, stride), np.uint8)
    above = np.zeros(stride, np.uint8)
    for v in range(height):
        kind, line = raw[v, 0], raw[v, 1:].copy()
        if kind == 2:
            line += above
        elif kind == 1:
            line = np.cumsum(line.reshape(-1, step), axis=0, dtype=np.uint8).reshape(-1)
        elif kind in (3, 4):
            up = above.astype(int)
            for i in range(stride):
                a = int(line[i - step]) if i >= step else 0
                b, c = up[i], int(up[i - step]) if i >= step else 0
                if kind == 3:
                    guess = (a + b) // 2
                else:
                    p = a + b - c
                    distances = abs(p - a), abs(p - b), abs(p - c)
                    guess = (a, b, c)[distances.index(min(distances))]
                line[i] = (int(line[i]) + guess) & 255
        rows[v] = above = line
    if bits == 16:
        return rows.view(">u2").reshape(height, width).astype(np.uint16)
    return rows.reshape((height, width, 3) if channels == 3 else (height, width))
