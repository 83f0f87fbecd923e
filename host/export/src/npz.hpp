// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>
#include <vector>

namespace triskin::design {

/// Arrays as NumPy's `load` reads them: an archive of PKZIP without compression, with one file in the format NPY 1.0
/// for each array (numpy.lib.format).
class NpzWriter {
 public:
  /// Adds an array of doubles with `columns` in a row; 1: one-dimensional.
  void add(const std::string& name, std::span<const double> values, std::size_t columns);
  void add(const std::string& name, std::span<const int> values);
  /// Texts of ASCII characters.
  void add(const std::string& name, std::span<const std::string> values);
  /// The archive. Nothing is added after it.
  [[nodiscard]] std::string finish();

 private:
  void add_array(const std::string& name, const std::string& type, const std::string& shape, const std::string& data);
  std::string archive_, directory_;
  int files_ = 0;
};

}  // namespace triskin::design
