// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

namespace triskin::test {

/// The folders that CMake knows. They stand in the command line of one source: a clone in another folder can then take
/// the compiled tests from the compiler's cache.
const std::string& source_folder();           ///< root folder of the project
const std::string& program_file();            ///< the program `triskin`
const std::string& configured_data_folder();  ///< TRISKIN_SHARED_DATA; it need not exist

}  // namespace triskin::test
