"""ros2 launch posefusion_ros posefusion.launch.py color:=... depth:=... camera_info:=... [base_frame:=base_link]"""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

# Topics of realsense2_camera with align_depth.enable:=true
TOPICS = {
    "color": "/camera/camera/color/image_raw",
    "depth": "/camera/camera/aligned_depth_to_color/image_raw",
    "camera_info": "/camera/camera/color/camera_info",
}
PARAMETERS = {
    "map_frame": "map",
    "base_frame": "",
    "config": "",
    "scale": "1.0",
    "people": "true",
    "cloud_period": "2.0",
}


def generate_launch_description():
    arguments = {**TOPICS, **PARAMETERS}
    node = Node(
        package="posefusion_ros",
        executable="slam",
        name="posefusion",
        output="screen",
        remappings=[(name, LaunchConfiguration(name)) for name in TOPICS],
        parameters=[{name: LaunchConfiguration(name) for name in PARAMETERS}],
    )
    declared = [DeclareLaunchArgument(name, default_value=value) for name, value in arguments.items()]
    return LaunchDescription([*declared, node])
