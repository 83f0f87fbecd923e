# SPDX-License-Identifier: Apache-2.0
"""Starts the bridge of a cover, or of all covers of a robot file, and RViz: ros2 launch triskin_msgs skin.launch.py
design:=forearm.json link:=can:can0 parent:=r_forearm"""
import pathlib

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

ARGUMENTS = {"design": (None, "design file or robot file"), "link": ("", "as of triskin; empty: of the robot file"),
             "namespace": ("/", "of topics and services"), "frame_prefix": ("", "before the names of frames"),
             "parent": ("base_link", "frame of the link that carries the cover"), "use_sim_time": ("false", "times of /clock"),
             "rviz": ("true", "start RViz")}


def bridge(context):
    value = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    line = ["triskin", "bridge", value["design"], "--parent", value["parent"]]
    if value["link"]:
        line += ["--link", value["link"]]
    line += ["--ros-args", "-r", f"__ns:={value['namespace']}", "-p", f"use_sim_time:={value['use_sim_time']}"]
    if value["frame_prefix"]:
        line += ["-p", f"frame_prefix:={value['frame_prefix']}"]
    return [ExecuteProcess(cmd=line, output="screen")]


def generate_launch_description():
    share = pathlib.Path(get_package_share_directory("triskin_msgs"))
    arguments = [DeclareLaunchArgument(name, description=text) if default is None else
                 DeclareLaunchArgument(name, default_value=default, description=text)
                 for name, (default, text) in ARGUMENTS.items()]
    rviz = Node(package="rviz2", executable="rviz2", arguments=["-d", str(share / "rviz" / "skin.rviz")],
                condition=IfCondition(LaunchConfiguration("rviz")))
    return LaunchDescription([*arguments, OpaqueFunction(function=bridge), rviz])
