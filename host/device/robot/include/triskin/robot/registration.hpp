// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/layout/index.hpp"

namespace triskin::robot {

/// A touch has the taxel that answered, and the position of the tip in the frame of the robot's link, mm.
struct Touch {
  design::ModuleNumber module;
  layout::TaxelIndex taxel;
  Eigen::Vector3d in_link_mm{0, 0, 0};
  std::string place = "a touch";  ///< for messages: "touches.csv: line 4"
};
/// Three touches determine a pose, and the others show whether it is right.
inline constexpr std::size_t kMinTouches = 6;

/// Reads touches from CSV with the columns module, taxel, x_mm, y_mm, z_mm (a header line is allowed, "#" begins a
/// comment). Throws InputError naming file and line.
[[nodiscard]] std::vector<Touch> read_touches(const std::string& text, const std::string& file);

/// A fit is a motion that maps one set of points to another, with its error.
struct Fit {
  /// If the fit is a mirror image, the rotation part mirrors as well.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  double rms_mm = 0.0;  ///< This is the root of the mean squared distance.
  double max_mm = 0.0;
  int worst = 0;  ///< The point with the largest distance has this index, from 0.
};
/// Computes the rotation and translation that map `from` to `to` with the smallest sum of squared distances (Kabsch
/// 1976, Umeyama 1991 without scale); with `mirrored`, the best motion that mirrors instead. Both sets are in mm, of
/// equal size, with at least 3 points that are not on one line. Throws InputError otherwise. Cost: linear.
[[nodiscard]] Fit fit_pose(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to,
                           bool mirrored = false);

struct NamedDesign {
  std::string name;
  const design::Design* design = nullptr;
};
/// The pose of a cover is found from touches, which may have other explanations too.
struct Registration {
  Fit fit;
  double mirror_rms_mm = 0.0;  ///< The best fit of the mirror image has this rms_mm.
  double thickness_mm = 0.0;   ///< This is the root mean square distance of the touches from their best plane.
  std::string exchanged_with;  ///< The cover named here fits better; empty if none does.
  double exchanged_rms_mm = 0.0;
  bool mirrored = false;        ///< The mirror image fits better.
  bool mirror_unknown = false;  ///< The touches lie in a plane, so a mirror image cannot be detected.
  /// Returns true if the residual is small and nothing else fits better.
  [[nodiscard]] bool good(double limit_mm) const {
    return fit.rms_mm <= limit_mm && !mirrored && exchanged_with.empty();
  }
};
/// Registers `cover` from touches; it may have been exchanged with one of `others`. Another explanation is accepted
/// when its residual is less than half. Throws InputError: fewer than kMinTouches, a module or taxel that the design
/// lacks, touches on one line. Cost: linear for each cover.
[[nodiscard]] Registration register_cover(const NamedDesign& cover, std::span<const NamedDesign> others,
                                          std::span<const Touch> touches);

}  // namespace triskin::robot
