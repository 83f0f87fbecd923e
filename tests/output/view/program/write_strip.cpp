// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a strip of modules as a design file. Usage: write_strip FILE MODULES [MODULES_A_PATCH]
#include <cstdlib>

#include "support/strip_design.hpp"

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) return 2;
  triskin::design::write_design(argv[1], triskin::test::strip(std::atoi(argv[2]), argc == 4 ? std::atoi(argv[3]) : 16));
  return 0;
}
