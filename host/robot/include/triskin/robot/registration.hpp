// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::robot {

/// One touch: a taxel that answered, and where the tip was in the frame of the robot's link, mm.
struct Touch {
  int module = 0, taxel = 0;
  Eigen::Vector3d in_link_mm{0, 0, 0};
};
inline constexpr std::size_t kMinTouches = 6;  ///< Three touches fix a pose, and the others show whether it is right.

/// Touches from CSV with the columns module, taxel, x_mm, y_mm, z_mm (a head line is allowed, "#" begins a comment).
/// Throws InputError naming file and line.
[[nodiscard]] std::vector<Touch> read_touches(const std::string& text, const std::string& file);

/// A motion that carries points on points, and how well.
struct Fit {
  /// Its rotation part mirrors if it describes a mirror image.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  double rms_mm = 0.0;  ///< It is the root of the mean squared distance.
  double max_mm = 0.0;  ///< It is the largest distance.
  int worst = 0;        ///< It is the point of the largest distance, counted from 0.
};
/// The rotation and translation that carry `from` on `to` with the least sum of squared distances (Kabsch 1976, Umeyama
/// 1991 without scale); `mirrored`: the best motion that mirrors instead. Points in mm, as many of each, at least 3,
/// not on one line. Throws InputError otherwise. Cost: linear.
[[nodiscard]] Fit fit_pose(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to,
                           bool mirrored = false);

/// A cover by name.
struct NamedDesign {
  std::string name;
  const design::Design* design = nullptr;
};
/// Pose of a cover found from touches, and what else they could mean.
struct Registration {
  Fit fit;
  double mirror_rms_mm = 0.0;  ///< It is the rms_mm of the best fit of the mirror image.
  double thickness_mm = 0.0;   ///< It is the root mean square distance of the touches from their best plane.
  std::string exchanged_with;  ///< Another cover fits better; it is empty if none does.
  double exchanged_rms_mm = 0.0;
  bool mirrored = false;        ///< The mirror image fits better.
  bool mirror_unknown = false;  ///< The touches lie in a plane, so a mirror image cannot be told.
  /// True: small residual, and nothing else fits better.
  [[nodiscard]] bool good(double limit_mm) const {
    return fit.rms_mm <= limit_mm && !mirrored && exchanged_with.empty();
  }
};
/// Registers `cover` by touches; `others` are the covers that it may have been exchanged with. Another explanation is
/// taken when its residual is less than half. Throws InputError: fewer than kMinTouches, a module or taxel that the
/// design lacks, touches on one line. Cost: linear for each cover.
[[nodiscard]] Registration register_cover(const NamedDesign& cover, std::span<const NamedDesign> others,
                                          std::span<const Touch> touches);

}  // namespace triskin::robot
