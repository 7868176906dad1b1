"""Colour, depth and camera info in; pose, path and point cloud out.

Subscribes to `color`, `depth` (registered to colour) and `camera_info`. Publishes `pose`, `odometry`, `path` (corrected
by the loops closed since), `cloud` and the transform from the map's frame to the camera's, or to `base_frame` where
that is set and the robot's description connects the two.
"""
import message_filters
import numpy as np
import rclpy
from geometry_msgs.msg import Pose, PoseStamped, TransformStamped
from nav_msgs.msg import Odometry, Path
from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.time import Time
from sensor_msgs.msg import CameraInfo, Image, PointCloud2, PointField
from tf2_ros import Buffer, TransformBroadcaster, TransformException, TransformListener

import posefusion

from . import conversions

QUEUE = 5  # sets of messages that wait while a frame is computed
SLOP = 0.02  # seconds between colour and depth of one frame


class PoseFusionNode(Node):
    def __init__(self):
        super().__init__("posefusion")
        self.map_frame = self.declare_parameter("map_frame", "map").value
        self.base_frame = self.declare_parameter("base_frame", "").value
        self.config = self.declare_parameter("config", "").value  # a YAML file, as for `posefusion run`
        self.scale = self.declare_parameter("scale", 1.0).value
        self.people = self.declare_parameter("people", True).value
        self.cloud_period = self.declare_parameter("cloud_period", 2.0).value  # seconds
        self.slam = None
        self.shape = None
        self.next_cloud = 0.0

        self.broadcaster = TransformBroadcaster(self)
        self.transforms = Buffer()
        self.listener = TransformListener(self.transforms, self)
        self.pose = self.create_publisher(PoseStamped, "pose", 10)
        self.odometry = self.create_publisher(Odometry, "odometry", 10)
        kept = QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)  # for who comes later
        self.path = self.create_publisher(Path, "path", kept)
        self.cloud = self.create_publisher(PointCloud2, "cloud", kept)

        topics = ((Image, "color"), (Image, "depth"), (CameraInfo, "camera_info"))
        inputs = [
            message_filters.Subscriber(self, kind, name, qos_profile=qos_profile_sensor_data) for kind, name in topics
        ]
        self.synchroniser = message_filters.ApproximateTimeSynchronizer(inputs, QUEUE, SLOP)
        self.synchroniser.registerCallback(self.process)

    def start(self, info):
        camera = posefusion.Camera(**conversions.camera_arguments(info))
        options = {"scale": self.scale, "no_people": not self.people}
        self.slam = posefusion.PoseFusion(camera, self.config or None, **options)
        self.get_logger().info(f"{info.width} x {info.height} on {self.slam.device}")

    def process(self, color, depth, info):
        try:
            if self.slam is None:
                self.start(info)
            frame = self.slam.process(
                conversions.colour_of(color), conversions.depth_of(depth), conversions.seconds(color.header.stamp)
            )
        except (ValueError, posefusion.Error) as error:  # of this frame: the next may be good
            self.get_logger().error(str(error), throttle_duration_sec=5.0)
            return
        if frame.tracking == "lost":
            self.get_logger().warning("the camera is lost", throttle_duration_sec=5.0)
            return
        self.publish_pose(color.header, frame)
        now = conversions.seconds(color.header.stamp)
        if now >= self.next_cloud:
            self.next_cloud = now + self.cloud_period
            self.publish_path(color.header.stamp)
            self.publish_cloud(color.header.stamp)

    def publish_pose(self, header, frame):
        T_map_camera = conversions.in_map(frame.pose)
        pose = PoseStamped()
        pose.header.stamp, pose.header.frame_id = header.stamp, self.map_frame
        pose.pose = pose_message(T_map_camera)
        self.pose.publish(pose)

        odometry = Odometry()
        odometry.header, odometry.child_frame_id = pose.header, header.frame_id
        odometry.pose.pose = pose.pose
        covariance = conversions.covariance_in_map(frame.covariance, T_map_camera)  # of this frame against the map
        odometry.pose.covariance = covariance.ravel().tolist()
        self.odometry.publish(odometry)

        child, T_camera_child = header.frame_id, np.eye(4)
        if self.base_frame:
            try:
                found = self.transforms.lookup_transform(header.frame_id, self.base_frame, Time()).transform
            except TransformException as error:
                self.get_logger().warning(str(error), throttle_duration_sec=5.0)
                return
            child, T_camera_child = self.base_frame, conversions.transform_of(found.translation, found.rotation)
        transform = TransformStamped()
        transform.header, transform.child_frame_id = pose.header, child
        placed = pose_message(T_map_camera @ T_camera_child)
        to = transform.transform
        to.translation.x, to.translation.y, to.translation.z = placed.position.x, placed.position.y, placed.position.z
        to.rotation = placed.orientation
        self.broadcaster.sendTransform(transform)

    def publish_path(self, stamp):
        if self.path.get_subscription_count() == 0:
            return
        path = Path()
        path.header.stamp, path.header.frame_id = stamp, self.map_frame
        for time, *numbers in self.slam.trajectory():
            T_world_camera = np.eye(4)
            T_world_camera[:3, :3] = conversions.rotation_of(*numbers[3:])
            T_world_camera[:3, 3] = numbers[:3]
            pose = PoseStamped()
            pose.header.frame_id = self.map_frame
            pose.header.stamp = Time(nanoseconds=round(time * 1e9)).to_msg()
            pose.pose = pose_message(conversions.in_map(T_world_camera))
            path.poses.append(pose)
        self.path.publish(path)

    def publish_cloud(self, stamp):
        if self.cloud.get_subscription_count() == 0:
            return
        points = conversions.cloud_of(self.slam.surfels())
        cloud = PointCloud2()
        cloud.header.stamp, cloud.header.frame_id = stamp, self.map_frame
        cloud.height, cloud.width = 1, len(points)
        cloud.fields = [
            PointField(name=name, offset=offset, datatype=kind, count=1)
            for name, offset, kind in conversions.CLOUD_FIELDS
        ]
        cloud.point_step = points.itemsize
        cloud.row_step = points.nbytes
        cloud.is_dense = True
        cloud.data = points.tobytes()
        self.cloud.publish(cloud)


def pose_message(T):
    pose = Pose()
    pose.position.x, pose.position.y, pose.position.z = (float(value) for value in T[:3, 3])
    q = conversions.quaternion_of(T[:3, :3])
    pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w = (float(value) for value in q)
    return pose


def main():
    rclpy.init()
    node = PoseFusionNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
