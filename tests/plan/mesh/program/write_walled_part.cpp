// SPDX-License-Identifier: GPL-3.0-or-later
// usage: write_walled_part KIND SEED FILE — writes random_walled_part(KIND, SEED) as OBJ and prints its name.
#include <cstdlib>
#include <iostream>
#include <string>

#include "../walled_parts.hpp"
#include "triskin/mesh/mesh_io.hpp"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: write_walled_part KIND SEED FILE\n";
    return EXIT_FAILURE;
  }
  const auto part =
      triskin::testing::random_walled_part(std::stoi(argv[1]), static_cast<unsigned>(std::stoul(argv[2])));
  triskin::mesh::write_obj(argv[3], part.mesh);
  std::cout << part.name << '\n';
  return EXIT_SUCCESS;
}
