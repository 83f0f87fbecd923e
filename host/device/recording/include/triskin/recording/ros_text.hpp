// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The texts that define ROS 2 types consist of these parts. They are macros, because only literals can be concatenated
// in a constant.

/// This line separates the definitions of two types.
#define TRISKIN_ROS_RULE "================================================================================\n"
/// The text has the definitions of std_msgs/Header and of its fields' types, each after a separator line.
#define TRISKIN_ROS_HEADER             \
  TRISKIN_ROS_RULE                     \
  "MSG: std_msgs/Header\n"             \
  "builtin_interfaces/Time stamp\n"    \
  "string frame_id\n" TRISKIN_ROS_RULE \
  "MSG: builtin_interfaces/Time\n"     \
  "int32 sec\n"                        \
  "uint32 nanosec\n"
