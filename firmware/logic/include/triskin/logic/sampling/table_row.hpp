// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>

namespace triskin::fw {

/// Row of the flashed table, by which samples, faults and frames name a module. Neither the module's id, which the
/// design file gives it, nor the number under which discovery found it, nor a node address, which is a controller's.
enum class TableRow : std::uint8_t {};

inline constexpr TableRow kNoTableRow{0xFF};  ///< a module that the table does not know

[[nodiscard]] constexpr std::size_t index_of(TableRow row) {
  return static_cast<std::size_t>(row);
}
[[nodiscard]] constexpr TableRow table_row(std::size_t index) {
  return static_cast<TableRow>(index);
}

}  // namespace triskin::fw
