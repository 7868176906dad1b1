"""Camera trajectory and map from NumPy arrays: a camera that slides along a wall."""
import numpy as np
import posefusion

camera = posefusion.Camera(fx=130, fy=130, cx=79.5, cy=59.5, width=160, height=120)
slam = posefusion.PoseFusion(camera, {"tracking": {"icp_max_distance": 0.08}}, no_people=True)

# a chequered wall 2 m away
wall = np.random.default_rng(1).integers(40, 220, (15, 30, 3), np.uint8).repeat(8, 0).repeat(8, 1)
depth = np.full((120, 160), 2.0, np.float32)  # metres; or uint16 in units of 1 / camera.depth_scale metres
for i in range(8):
    frame = slam.process(wall[:, 2 * i : 2 * i + 160], depth, stamp=i / 30)

print(frame.tracking, "camera at", frame.pose[:3, 3].round(3), "m")
surfels = slam.surfels(stable_only=False)
print(len(surfels), "surfels around", surfels["position"].mean(axis=0).round(2), "m")
slam.save_trajectory("trajectory.txt")
