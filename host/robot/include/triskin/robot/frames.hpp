// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <string>

namespace triskin::robot {

/// The links of a robot and where they lie while all joints are at 0.
class Frames {
 public:
  /// Reads a URDF file: links, joints and their origins; nothing else of it. Throws InputError naming the file and what
  /// is wrong: no XML, no robot, a joint between links that are not there, a link with two parents, a ring, not exactly
  /// one base.
  [[nodiscard]] static Frames read_urdf(const std::filesystem::path& path);
  /// read_urdf for the text of a file; errors name it `file`.
  [[nodiscard]] static Frames parse_urdf(const std::string& text, const std::string& file);

  /// True if the robot has a link `name`.
  [[nodiscard]] bool has(const std::string& name) const { return poses_.contains(name); }
  /// Pose of link `name` in the base, translation in mm. Throws std::out_of_range for a link that is not there.
  [[nodiscard]] const Eigen::Isometry3d& pose(const std::string& name) const { return poses_.at(name); }
  /// The link that hangs on no joint.
  [[nodiscard]] const std::string& base() const { return base_; }
  /// All links, by name.
  [[nodiscard]] const std::map<std::string, Eigen::Isometry3d>& poses() const { return poses_; }

 private:
  std::map<std::string, Eigen::Isometry3d> poses_;
  std::string base_;
};

}  // namespace triskin::robot
