"""Maps that tests make themselves."""
import numpy as np

WALL = 2.0  # m, side of the square that write_wall() makes


def write_map(file, positions, normal, color, radius):
    """A map.ply of surfels that look the same way."""
    names = ["x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "radius", "confidence", "created", "last_seen"]
    kinds = ["f4"] * 6 + ["u1"] * 3 + ["f4"] * 2 + ["u4"] * 2
    words = {"f4": "float", "u1": "uchar", "u4": "uint"}
    vertices = np.zeros(len(positions), list(zip(names, ("<" + kind for kind in kinds))))
    for name, column in zip(names[:3], np.transpose(positions)):
        vertices[name] = column
    for name, value in zip(names[3:9], (*normal, *color)):
        vertices[name] = value
    vertices["radius"], vertices["confidence"] = radius, 20
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(positions)}"]
    header += [f"property {words[kind]} {name}" for name, kind in zip(names, kinds)] + ["end_header", ""]
    file.write_bytes("\n".join(header).encode() + vertices.tobytes())


def write_wall(file, per_side, color=(200, 60, 40)):
    """A square wall of surfels that faces the camera."""
    at = (np.arange(per_side) + 0.5) / per_side * WALL - WALL / 2
    x, y = (values.ravel() for values in np.meshgrid(at, at))
    write_map(file, np.stack([x, y, np.full_like(x, 2)], axis=1), (0, 0, -1), color, 0.8 * WALL / per_side)
