// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <utility>

#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::skin {

/// Rest values from a tare or a calibration are stored on this computer for the same boards with the same design. Every
/// LiveCover starts with them.
class RestStore {
 public:
  /// `claims` are the controllers that answered on the link; those that are not part of the design do not count.
  RestStore(const design::Design& design, std::span<const wire::NodeClaim> claims);
  /// Uses a known file, for a design with this many modules.
  RestStore(std::filesystem::path file, std::size_t modules) : modules_(modules), file_(std::move(file)) {}
  /// Reads the stored values; empty if there are none. Throws InputError when the file is damaged.
  [[nodiscard]] design::RestValues read() const;
  /// Replaces the stored values. Throws InputError when the file cannot be written.
  void write(const design::RestValues& rest) const;
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::size_t modules_;
  std::filesystem::path file_;
};

}  // namespace triskin::skin
