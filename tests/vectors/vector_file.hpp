// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/places.hpp"

namespace triskin::test {

/// A block of tests/vectors/*.txt is `## name`, then `key = value` lines in order. The examples in docs/ come from the
/// same files.
struct Vector {
  std::string name;
  std::vector<std::pair<std::string, std::string>> lines;

  [[nodiscard]] std::vector<std::string> all(const std::string& key) const {
    std::vector<std::string> values;
    for (const auto& [k, v] : lines) {
      if (k == key) values.push_back(v);
    }
    return values;
  }
  [[nodiscard]] bool has(const std::string& key) const { return !all(key).empty(); }
  [[nodiscard]] std::string one(const std::string& key) const {
    const auto values = all(key);
    if (values.size() != 1) throw std::runtime_error("vector '" + name + "': " + key + " must stand once");
    return values.front();
  }
  [[nodiscard]] std::uint64_t number(const std::string& key) const { return std::stoull(one(key), nullptr, 0); }
};

inline std::vector<std::uint64_t> numbers(const std::string& text, int base) {
  std::istringstream in(text);
  std::vector<std::uint64_t> values;
  for (std::string word; in >> word;) values.push_back(std::stoull(word, nullptr, base));
  return values;
}

inline std::vector<std::uint8_t> hex_bytes(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  for (const std::uint64_t v : numbers(text, 16)) bytes.push_back(static_cast<std::uint8_t>(v));
  return bytes;
}

inline std::vector<Vector> read_vectors(const std::string& file) {
  const std::string path = triskin::test::source_folder() + "/tests/vectors/" + file;
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot read " + path);
  std::vector<Vector> vectors;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("## ")) {
      vectors.push_back({line.substr(3), {}});
    } else if (!line.empty() && line[0] != '#') {
      const auto at = line.find(" =");
      if (at == std::string::npos || vectors.empty())
        throw std::runtime_error(path + ": '" + line + "' is no 'key = value'");
      vectors.back().lines.emplace_back(line.substr(0, at), line.size() > at + 3 ? line.substr(at + 3) : "");
    }
  }
  return vectors;
}

}  // namespace triskin::test
