// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <vector>

#include "triskin/jobs/touch_map.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::cli {

/// Rest values that were taken by a tare, kept on this computer for the same boards with the same design.
class RestStore {
 public:
  /// `boards`: who answers on the link.
  RestStore(const design::Design& design, const std::vector<wire::NodeClaim>& boards);
  /// Empty: none were taken. Throws InputError when the file is damaged.
  [[nodiscard]] device::RestValues read() const;
  /// Throws InputError when it cannot be written.
  void write(const device::RestValues& rest) const;
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  std::size_t modules_;
  std::filesystem::path file_;
};

}  // namespace triskin::cli
