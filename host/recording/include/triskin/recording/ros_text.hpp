// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Parts of the texts that define ROS 2 types: macros, because only literals can be joined in a constant.

/// Line between the definitions of two types.
#define TRISKIN_ROS_RULE "================================================================================\n"
/// Definitions of std_msgs/Header and of what it holds, each after a line of its own.
#define TRISKIN_ROS_HEADER             \
  TRISKIN_ROS_RULE                     \
  "MSG: std_msgs/Header\n"             \
  "builtin_interfaces/Time stamp\n"    \
  "string frame_id\n" TRISKIN_ROS_RULE \
  "MSG: builtin_interfaces/Time\n"     \
  "int32 sec\n"                        \
  "uint32 nanosec\n"
