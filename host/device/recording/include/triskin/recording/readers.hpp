// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/recording/messages.hpp"

namespace triskin::recording {

struct Reader {
  /// The controller serves this patch; −1 means that it serves none of this design.
  layout::PatchIndex patch = layout::PatchIndex::none();
  layout::NodeAddress node;  ///< Zero means that the controller is on another bus.
  bool operator==(const Reader&) const = default;
};

/// Learns from the samples which controller reads each module: its own, until a sample arrives from another that has
/// adopted it (docs/switched_module.md). Threads: one.
class Readers {
 public:
  /// Assumes that each module is read by its own controller. Throws std::out_of_range as design::wiring_of. Cost:
  /// linear.
  explicit Readers(const design::Design& design);
  /// Notes a sample. Returns true if it came from another controller than the previous one. Constant cost.
  [[nodiscard]] bool add(const ModuleSample& sample);
  /// Returns the controller that read a sample. Constant cost.
  [[nodiscard]] Reader of(const ModuleSample& sample) const {
    return {patch_at_[sample.sample.node_address], layout::NodeAddress{sample.sample.node_address}};
  }
  /// Returns the readers, indexed by module; the span is valid as long as this object.
  [[nodiscard]] std::span<const Reader> all() const { return readers_; }

 private:
  std::vector<Reader> readers_;
  std::array<layout::PatchIndex, 256> patch_at_{};  // A node address that belongs to no patch of this design has −1.
};

/// Encodes which controller reads each module from `link_time_us` on.
[[nodiscard]] std::vector<std::uint8_t> encode_readers(std::span<const Reader> readers, std::uint64_t link_time_us,
                                                       std::uint64_t stamp_ns);
/// A message that names the readers has these contents.
struct ReadersAt {
  std::uint64_t link_time_us = 0;
  std::vector<Reader> readers;  ///< The list is indexed by module.
};
/// Decodes such a message; nullopt if it is malformed.
[[nodiscard]] std::optional<ReadersAt> decode_readers(Bytes message);

}  // namespace triskin::recording
