// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <string>

namespace triskin::robot {

/// The poses of a robot's links are those with all joints at 0.
class Frames {
 public:
  /// Reads links, joints and their origins from a URDF file and ignores the rest. Throws InputError naming the file and
  /// what is wrong: no XML, no robot, a joint between links that do not exist, a link with two parents, a loop, not
  /// exactly one base.
  [[nodiscard]] static Frames read_urdf(const std::filesystem::path& path);
  /// Does the same as read_urdf, but from text; error messages call it `file`.
  [[nodiscard]] static Frames parse_urdf(const std::string& text, const std::string& file);

  /// Returns true if the robot has a link `name`.
  [[nodiscard]] bool has(const std::string& name) const { return poses_.contains(name); }
  /// Returns the pose of link `name` in the base, with the translation in mm. Throws std::out_of_range for a link that
  /// does not exist.
  [[nodiscard]] const Eigen::Isometry3d& pose(const std::string& name) const { return poses_.at(name); }
  /// Returns the link that has no parent joint.
  [[nodiscard]] const std::string& base() const { return base_; }
  /// Returns the poses of all links, by name.
  [[nodiscard]] const std::map<std::string, Eigen::Isometry3d>& poses() const { return poses_; }

 private:
  std::map<std::string, Eigen::Isometry3d> poses_;
  std::string base_;
};

}  // namespace triskin::robot
