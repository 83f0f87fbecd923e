// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "support/places.hpp"
#include "triskin/base/files.hpp"

namespace triskin::test {

/// Reads a file of tests/plan/cad/data.
inline std::string part_file(const std::string& name) {
  return read_file(source_folder() + "/tests/plan/cad/data/" + name);
}
inline const std::string& good_part() {
  static const std::string bytes = part_file("00_good_mm.step");
  return bytes;
}

/// Replaces the first `from` in `text` by `to`; the test fails if there is none.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) {
    ADD_FAILURE() << "the good part has no " << from;
    return {};
  }
  return text.replace(at, from.size(), to);
}
inline std::string with_all(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}
/// Returns the good part with `statement` for the entity `number` (the digits alone).
inline std::string with_entity(int number, const std::string& statement) {
  std::string text = good_part();
  const std::string head = fmt::format("\n#{} = ", number);
  const std::size_t at = text.find(head);
  if (at == std::string::npos) {
    ADD_FAILURE() << "the good part has no " << head;
    return {};
  }
  const std::size_t end = text.find(";\n", at);
  return text.replace(at + 1, end - at, fmt::format("#{} = {};", number, statement));
}

}  // namespace triskin::test
