// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "triskin/sim/flash_model.hpp"

namespace triskin::hardware {

/// The flash memory in RAM refuses what the silicon refuses, can lose power in the middle of an operation, and can be
/// stored in a file. An *operation* is one page erase or one program unit. Not thread-safe.
class FlashMemory final : public sim::FlashModel {
 public:
  static constexpr std::size_t kPageBytes = 2048;
  static constexpr std::size_t kProgramBytes = 8;

  /// Starts erased. `size_bytes` must be a multiple of the page.
  explicit FlashMemory(std::size_t size_bytes);
  /// Uses memory stored in `file`, which is created when it is missing; the bytes are inverted in the file, so that
  /// erased pages are holes. Throws InputError naming the file when it cannot be opened or has another size,
  /// DeviceError when another process has it open.
  FlashMemory(std::size_t size_bytes, const std::filesystem::path& file);
  ~FlashMemory() override;
  FlashMemory(const FlashMemory&) = delete;
  FlashMemory& operator=(const FlashMemory&) = delete;

  /// A power failure during an operation can leave these states behind.
  enum class Tear {
    kBefore,  ///< Nothing was done before the power failed.
    kHalf,    ///< Half of the page or unit was done before the power failed.
  };
  /// Makes the power fail once, in the operation after the next `operations` ones, which then throws sim::PowerLost.
  void cut_power_after(std::uint64_t operations, Tear tear);
  /// Counts the operations since construction.
  [[nodiscard]] std::uint64_t operations() const { return operations_; }

  [[nodiscard]] std::size_t size_bytes() const override { return bytes_.size(); }
  [[nodiscard]] std::size_t page_bytes() const override { return kPageBytes; }
  [[nodiscard]] std::size_t program_bytes() const override { return kProgramBytes; }
  bool erase_page(std::size_t offset_bytes) override;
  bool program(std::size_t offset_bytes, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::span<const std::uint8_t> bytes() const override { return bytes_; }

 private:
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
  [[nodiscard]] bool count_operation();  // Returns true if the power fails during this operation.
  void store(std::size_t offset_bytes, std::size_t size_bytes);

  std::vector<std::uint8_t> bytes_;
  std::vector<bool> programmed_;  // Each program unit has a flag.
  std::uint64_t operations_ = 0;
  std::uint64_t cut_at_ = kNever;
  Tear tear_ = Tear::kBefore;
  std::string file_;
  int descriptor_ = -1;
};

}  // namespace triskin::hardware
