// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>

#include "command.hpp"
#include "triskin/design/design.hpp"
#include "triskin/sheet/page_code.hpp"

namespace triskin::cli {

/// The argument DESIGN on the command line can name a file or a QR code.
struct DesignArgument {
  std::string path;
  std::optional<sheet::PageCode> code;  ///< The code is set if the text of a QR code was given.
};

/// Resolves DESIGN, which is a file or the text of a QR code on an assembly sheet. For a code, the design with its id
/// is searched among the files *.json of the current folder, in the order of their names. Throws InputError for a text
/// that begins like a code but is invalid, and when no file there is the design. Cost: reads these files.
[[nodiscard]] DesignArgument find_design(const std::string& argument);

/// Says if the design of this file does not match its id, for a command that takes it all the same.
void say_if_changed(const design::Design& design, const std::string& file, const Output& output);

}  // namespace triskin::cli
