"""ros2 launch meissner_ros meissner.launch.py port:=/dev/ttyUSB1 config:=fingertip"""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

ARGUMENTS = (
    ("port", "/dev/ttyUSB0", "the line to the core; sim: is a simulated one"),
    ("config", "", "the core's configuration, for physical units"),
    ("calibration", "", "a file of meissner calibrate to write into the core first"),
    ("frame_id", "tactile", "the frame of every message"),
)


def generate_launch_description():
    share = get_package_share_directory("meissner_ros")
    thresholds = DeclareLaunchArgument(
        "thresholds",
        default_value=os.path.join(share, "config", "thresholds.yaml"),
        description="a file of parameters: thresholds in codes",
    )
    # As text: "sim:" would be a mapping in YAML.
    given = {name: ParameterValue(LaunchConfiguration(name), value_type=str) for name, _, _ in ARGUMENTS}
    node = Node(
        package="meissner_ros",
        executable="meissner",
        name="meissner",
        parameters=[LaunchConfiguration("thresholds"), given],
        output="screen",
    )
    declared = [
        DeclareLaunchArgument(name, default_value=value, description=what) for name, value, what in ARGUMENTS
    ]
    return LaunchDescription([*declared, thresholds, node])
