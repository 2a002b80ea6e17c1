"""A Meissner core as a ROS 2 node: ros2/README.md."""
