// SPDX-License-Identifier: GPL-3.0-or-later
#include "program.hpp"

int main(int argc, char** argv) {
  return triskin::cli::run_program(
      "triskin: robot skin from the CAD mesh of a body part to a verified, streaming patch", argc, argv);
}
