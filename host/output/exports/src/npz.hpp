// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>
#include <vector>

namespace triskin::exports {

/// Writes arrays for NumPy's `load`: a PKZIP archive without compression, with one file in the format NPY 1.0 for each
/// array (numpy.lib.format).
class NpzWriter {
 public:
  /// Adds an array of doubles with `columns` in a row; 1 makes it one-dimensional.
  void add(const std::string& name, std::span<const double> values, std::size_t columns);
  void add(const std::string& name, std::span<const int> values);
  /// Adds an array of texts in UTF-8; bytes that are none become U+FFFD.
  void add(const std::string& name, std::span<const std::string> values);
  /// Returns the archive, to which nothing can be added afterwards.
  [[nodiscard]] std::string finish();

 private:
  void add_array(const std::string& name, const std::string& type, const std::string& shape, const std::string& data);
  std::string archive_, directory_;
  int files_ = 0;
};

}  // namespace triskin::exports
