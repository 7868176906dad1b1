#!/usr/bin/python3
"""Makes hevc.mp4: 40 images of 64x48 as phones code them (HEVC, a key image every 12, images in another order than
shown). Image i is red 20 + 5 i, green 60, blue 200 - 5 i. Needs OpenCV with FFmpeg."""
import cv2
import numpy

video = cv2.VideoWriter("hevc.mp4", cv2.VideoWriter_fourcc(*"hev1"), 30, (64, 48))
for i in range(40):
    video.write(numpy.full((48, 64, 3), (200 - 5 * i, 60, 20 + 5 * i), numpy.uint8))
video.release()
