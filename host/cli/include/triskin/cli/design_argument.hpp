// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>

#include "triskin/sheet/page_code.hpp"

namespace triskin::cli {

/// What DESIGN names on the command line.
struct DesignArgument {
  std::string path;
  std::optional<sheet::PageCode> code;  ///< It is set if the text of a QR code was given.
};

/// DESIGN is a file, or the text of a QR code of an assembly sheet: then the design with its id is looked for among the
/// files *.json of the current folder, in the order of their names. Throws InputError for a text that begins like a
/// code and is none, and when no file there is the design. Cost: reads these files.
[[nodiscard]] DesignArgument find_design(const std::string& argument);

}  // namespace triskin::cli
