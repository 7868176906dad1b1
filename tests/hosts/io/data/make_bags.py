#!/usr/bin/python3
"""Made the bags of this folder, with ROS's own rosbag (Debian: python3-rosbag, python3-sensor-msgs).

Three frames of 8 x 6 pixels, 1/30 s apart from 100.5 s on; colour (u * 10, v * 20, frame), depth 1000 + 100 * frame +
u + 10 * v millimetres, 2 ms later. bag_test.cpp knows these numbers.
"""
import pathlib
import struct

import genpy
import rosbag
from sensor_msgs.msg import CameraInfo, Image

WIDTH, HEIGHT, FRAMES = 8, 6, 3


def image(stamp, encoding, pixel_bytes, data):
    message = Image()
    message.header.stamp = stamp
    message.header.frame_id = "camera"
    message.width, message.height, message.encoding = WIDTH, HEIGHT, encoding
    message.step, message.data = WIDTH * pixel_bytes, data
    return message


def camera_info(stamp):
    message = CameraInfo()
    message.header.stamp = stamp
    message.width, message.height = WIDTH, HEIGHT
    message.distortion_model = "plumb_bob"
    message.D = [0.1, -0.2, 0.001, 0.002, 0.05]
    message.K = [9.5, 0, 3.5, 0, 9.25, 2.5, 0, 0, 1]
    return message


def write(file, compression):
    with rosbag.Bag(str(file), "w", compression=compression, chunk_threshold=500) as bag:
        for frame in range(FRAMES):
            nanoseconds = 100_500_000_000 + frame * 33_333_000
            stamp = genpy.Time(nanoseconds // 10**9, nanoseconds % 10**9)
            later = genpy.Time((nanoseconds + 2_000_000) // 10**9, (nanoseconds + 2_000_000) % 10**9)
            pixels = [(u, v) for v in range(HEIGHT) for u in range(WIDTH)]
            color = b"".join(bytes([frame, v * 20, u * 10]) for u, v in pixels)  # bgr8
            depth = b"".join(struct.pack("<H", 1000 + 100 * frame + u + 10 * v) for u, v in pixels)
            bag.write("/camera/rgb/camera_info", camera_info(stamp), stamp)
            bag.write("/camera/rgb/image_color", image(stamp, "bgr8", 3, color), stamp)
            bag.write("/camera/depth_registered/image_raw", image(later, "16UC1", 2, depth), later)


for name, compression in (("plain", "none"), ("bz2", "bz2"), ("lz4", "lz4")):
    write(pathlib.Path(__file__).with_name(f"{name}.bag"), compression)
