// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "triskin/layout/module.hpp"
#include "triskin/sim/virtual_controller.hpp"

namespace triskin::sim {

/// A chip would answer these values to a reading of its results.
struct ChipReading {
  std::array<std::uint16_t, layout::kTaxelsPerModule> results{};
  std::uint64_t sequence_ns = 0;  ///< The chip ends a sequence at this interval.
};

/// Looks at the chip with I²C address `address` (7 bits) on line 0..3, without a transfer and without an effect on it.
/// `at_us` is a time of the controller's clock. Returns nothing if no single chip would answer there with results of a
/// complete sequence.
using LookAtChip = std::function<std::optional<ChipReading>(int line, std::uint8_t address, std::uint64_t at_us)>;

/// Makes a controller that is simulated by its table while nothing happens but streaming. It starts as
/// make_virtual_controller does. Once eight samples of every module of its flashed table have followed one another, its
/// samples come from `look` at the times that continue the sequences of the chips, without firmware and I²C transfers,
/// and it answers leases and requests for the stream's account. Anything else (another request, a chip that does not
/// answer, USB) wakes the firmware, which first runs through the time that it has missed, so that its state is that of
/// a controller without the table. Samples are equal but for their times, which differ by the microseconds by which the
/// firmware refines its estimates of the chips' clocks meanwhile (docs/simulation.md).
[[nodiscard]] std::unique_ptr<VirtualController> make_table_controller(const VirtualBoard& board, LookAtChip look);

}  // namespace triskin::sim
