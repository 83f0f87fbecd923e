// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

namespace triskin::library {

/// Says a message of the program in the words of a caller of the library: `--link can:can0` becomes `link="can:can0"`,
/// `--every 3` `every=3`, `--scene` and `--overload` their fields. A clause that names a command of the program stays.
[[nodiscard]] std::string argument_words(const std::string& message);

}  // namespace triskin::library
