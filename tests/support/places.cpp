// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/places.hpp"

namespace triskin::test {

const std::string& source_folder() {
  static const std::string folder = TRISKIN_SOURCE;
  return folder;
}
const std::string& program_file() {
  static const std::string file = TRISKIN_PROGRAM;
  return file;
}
const std::string& configured_data_folder() {
  static const std::string folder = TRISKIN_DATA;
  return folder;
}
bool program_has_solvers() {
  return TRISKIN_HAS_SOLVERS;
}

}  // namespace triskin::test
