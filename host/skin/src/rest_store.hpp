// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <utility>

#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::device {

/// Rest values that were taken by a tare or a calibration, kept on this computer for the same boards with the same
/// design: every LiveCover begins with them.
class RestStore {
 public:
  /// `claims`: who answers on the link; those that are not the design's do not count.
  RestStore(const design::Design& design, std::span<const wire::NodeClaim> claims);
  /// The same, of a file that is known and a design with so many modules.
  RestStore(std::filesystem::path file, std::size_t modules) : modules_(modules), file_(std::move(file)) {}
  /// Empty: none were taken. Throws InputError when the file is damaged.
  [[nodiscard]] design::RestValues read() const;
  /// Throws InputError when it cannot be written.
  void write(const design::RestValues& rest) const;
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::size_t modules_;
  std::filesystem::path file_;
};

}  // namespace triskin::device
