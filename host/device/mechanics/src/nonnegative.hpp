// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

namespace triskin::mechanics {

/// Returns x ≥ 0 that minimizes |A·x − b|² (Lawson and Hanson 1974, algorithm NNLS). At most `max_active` entries
/// are positive.
[[nodiscard]] Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                                        int max_active);

}  // namespace triskin::mechanics
