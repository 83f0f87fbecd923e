// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "triskin/recording/byte_source.hpp"
#include "triskin/recording/mcap.hpp"

namespace triskin::recording::mcap {

/// Says what a file is that does not begin as MCAP, and what to give: ": it is a candump log; give …".
[[nodiscard]] std::string what_it_is(const ByteSource& source, const std::string& name);

struct Place {
  Kind kind{};
  std::uint64_t offset = 0;  ///< The record's head starts here.
  std::uint64_t length = 0;  ///< Only the record's contents count.
  [[nodiscard]] std::uint64_t contents() const { return offset + kHeadBytes; }
  [[nodiscard]] std::uint64_t end() const { return offset + kHeadBytes + length; }
};
/// Finds the record whose head is at `offset`; nullopt if the file ends before the record does.
[[nodiscard]] std::optional<Place> place_at(const ByteSource& source, std::uint64_t offset);
/// Reads the first bytes of a record's contents, at most `most`; empty when they cannot be read.
[[nodiscard]] std::vector<std::uint8_t> contents_of(const ByteSource& source, const Place& place,
                                                    std::uint64_t most = ~std::uint64_t{0});

}  // namespace triskin::recording::mcap
