"""Messages of ROS to arrays and back; knows their fields, but nothing of rclpy."""
import numpy as np

MILLIMETRES = 1000.0  # units per metre of 16-bit depth images in ROS (REP 118)

# Encodings of colour images: (channels, order of red, green and blue).
COLOUR_ENCODINGS = {
    "rgb8": (3, (0, 1, 2)),
    "bgr8": (3, (2, 1, 0)),
    "rgba8": (4, (0, 1, 2)),
    "bgra8": (4, (2, 1, 0)),
    "mono8": (1, (0, 0, 0)),
}
DEPTH_ENCODINGS = {"16UC1": np.uint16, "mono16": np.uint16, "32FC1": np.float32}
LENSES = ("", "plumb_bob", "rational_polynomial")  # whose coefficients PoseFusion takes in this order

# x forward, y left, z up (REP 103) of what is x right, y down, z forward: the map as others expect it.
T_MAP_WORLD = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)


def seconds(stamp):
    return stamp.sec + 1e-9 * stamp.nanosec


def samples(image, kind, channels):
    """(height, width, channels) of an image message, whose rows may be padded."""
    kind = np.dtype(kind).newbyteorder(">" if image.is_bigendian else "<")
    row = image.width * channels * kind.itemsize
    rows = np.frombuffer(image.data, np.uint8).reshape(image.height, image.step)[:, :row]
    pixels = np.ascontiguousarray(rows).view(kind).reshape(image.height, image.width, channels)
    return pixels.astype(kind.newbyteorder("="), copy=False)


def colour_of(image):
    """(h, w, 3), red first. ValueError for an encoding that is none of a colour image."""
    if image.encoding not in COLOUR_ENCODINGS:
        raise ValueError(f"colour image of encoding {image.encoding}, expected one of {', '.join(COLOUR_ENCODINGS)}")
    channels, order = COLOUR_ENCODINGS[image.encoding]
    return np.ascontiguousarray(samples(image, np.uint8, channels)[:, :, order])


def depth_of(image):
    """(h, w): uint16 in millimetres, or floats in metres with 0 where nothing was measured."""
    if image.encoding not in DEPTH_ENCODINGS:
        raise ValueError(f"depth image of encoding {image.encoding}, expected one of {', '.join(DEPTH_ENCODINGS)}")
    depth = samples(image, DEPTH_ENCODINGS[image.encoding], 1)[:, :, 0]
    return np.nan_to_num(depth, nan=0.0, posinf=0.0, neginf=0.0) if depth.dtype == np.float32 else depth


def camera_arguments(info):
    """Arguments of posefusion.Camera."""
    if info.distortion_model not in LENSES:
        raise ValueError(f"lens model {info.distortion_model}; rectify the images first (image_proc)")
    k = info.k
    return {
        "fx": k[0],
        "fy": k[4],
        "cx": k[2],
        "cy": k[5],
        "width": info.width,
        "height": info.height,
        "depth_scale": MILLIMETRES,
        "distortion": list(info.d),
    }


def quaternion_of(rotation):
    """(x, y, z, w) of a 3 x 3 rotation; w is not negative."""
    m = np.asarray(rotation, np.float64)
    # The largest of the four is found first, so that nothing small is divided by.
    squares = np.array([1 + m[0, 0] - m[1, 1] - m[2, 2], 1 - m[0, 0] + m[1, 1] - m[2, 2]])
    squares = np.append(squares, [1 - m[0, 0] - m[1, 1] + m[2, 2], 1 + m[0, 0] + m[1, 1] + m[2, 2]])
    largest = int(np.argmax(squares))
    products = np.array(
        [
            [squares[0], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]],
            [m[0, 1] + m[1, 0], squares[1], m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]],
            [m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], squares[2], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], squares[3]],
        ]
    )
    q = products[largest] / np.linalg.norm(products[largest])
    return q if q[3] >= 0 else -q


def rotation_of(x, y, z, w):
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def transform_of(translation, rotation):
    """4 x 4 of the two fields of a Transform or Pose message."""
    T = np.eye(4)
    T[:3, :3] = rotation_of(rotation.x, rotation.y, rotation.z, rotation.w)
    T[:3, 3] = translation.x, translation.y, translation.z
    return T


def in_map(T_world_camera):
    """Pose in the map's frame, x forward, y left and z up as seen from the first camera."""
    return T_MAP_WORLD @ np.asarray(T_world_camera, np.float64)


def covariance_in_map(covariance, T_map_camera):
    """6 x 6, translation and rotation, of the camera's frame turned into the map's."""
    turn = np.kron(np.eye(2), T_map_camera[:3, :3])
    return turn @ np.asarray(covariance, np.float64) @ turn.T


# Fields of the cloud below: (name, offset, kind as in sensor_msgs/PointField).
FLOAT32 = 7
CLOUD_FIELDS = (("x", 0, FLOAT32), ("y", 4, FLOAT32), ("z", 8, FLOAT32), ("rgb", 12, FLOAT32))
CLOUD_POINT = np.dtype([("position", "<f4", 3), ("rgb", "<u4")])


def cloud_of(surfels):
    """Records of 16 bytes, CLOUD_FIELDS, of PoseFusion.surfels(): positions in the map's frame."""
    cloud = np.empty(len(surfels), CLOUD_POINT)
    cloud["position"] = surfels["position"] @ T_MAP_WORLD[:3, :3].T.astype(np.float32)
    red, green, blue = (surfels["color"][:, i].astype(np.uint32) for i in range(3))
    cloud["rgb"] = red << 16 | green << 8 | blue
    return cloud
