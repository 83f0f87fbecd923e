// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

namespace triskin::test {

/// Returns the folders that CMake knows. They are in the command line of one source file only, so that a clone in
/// another folder can take the compiled tests from the compiler's cache.
const std::string& source_folder();           ///< Returns the root folder of the project.
const std::string& program_file();            ///< Returns the program `triskin`.
const std::string& configured_data_folder();  ///< Returns TRISKIN_SHARED_DATA; the folder need not exist.
/// Returns false if the program was built without the solvers and the checker (TRISKIN_GEOMETRY=OFF).
bool program_has_solvers();

}  // namespace triskin::test
