// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>

namespace triskin::fw {

/// Samples, faults and frames name a module by its row of the flashed table. It differs from the module's id in the
/// design file, from the number under which discovery found it, and from the node address of a controller.
enum class TableRow : std::uint8_t {};

inline constexpr TableRow kNoTableRow{0xFF};  ///< The module is not in the table.

[[nodiscard]] constexpr std::size_t index_of(TableRow row) {
  return static_cast<std::size_t>(row);
}
[[nodiscard]] constexpr TableRow table_row(std::size_t index) {
  return static_cast<TableRow>(index);
}

}  // namespace triskin::fw
