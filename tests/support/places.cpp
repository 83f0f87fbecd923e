// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/places.hpp"

namespace triskin::test {

std::string source_folder() {
  return TRISKIN_SOURCE;
}
std::string program_file() {
  return TRISKIN_PROGRAM;
}
std::string configured_data_folder() {
  return TRISKIN_DATA;
}

}  // namespace triskin::test
