// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/recording/messages.hpp"

namespace triskin::recording {

/// The controller that reads a module.
struct Reader {
  int patch = -1;         ///< The controller serves this patch; −1 means that it serves none of this design.
  std::uint8_t node = 0;  ///< It is its node address; 0 means that it hangs on another bus.
  bool operator==(const Reader&) const = default;
};

/// Controller that reads each module, learned from the samples: its own, until one arrives from another, which has
/// adopted it (docs/adoption.md). Threads: one.
class Readers {
 public:
  /// Each module is read by its own controller. Throws std::out_of_range as design::wiring_of. Cost: linear.
  explicit Readers(const design::Design& design);
  /// Takes a sample. True: another controller read it than the one before. Constant cost.
  [[nodiscard]] bool add(const ModuleSample& sample);
  /// The controller that read a sample. Constant cost.
  [[nodiscard]] Reader of(const ModuleSample& sample) const {
    return {patch_at_[sample.sample.node_address], sample.sample.node_address};
  }
  /// Indexed by module; valid as long as this object.
  [[nodiscard]] std::span<const Reader> all() const { return readers_; }

 private:
  std::vector<Reader> readers_;
  std::array<int, 256> patch_at_{};  // Indexed by node address; −1: none of this design.
};

/// The message that says who reads each module from `link_time_us` on.
[[nodiscard]] std::vector<std::uint8_t> encode_readers(std::span<const Reader> readers, std::uint64_t link_time_us,
                                                       std::uint64_t stamp_ns);
/// What such a message says.
struct ReadersAt {
  std::uint64_t link_time_us = 0;
  std::vector<Reader> readers;  ///< It is indexed by module.
};
/// Reads it; nullopt: it is malformed.
[[nodiscard]] std::optional<ReadersAt> decode_readers(Bytes message);

}  // namespace triskin::recording
