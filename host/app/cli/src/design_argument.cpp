// SPDX-License-Identifier: GPL-3.0-or-later
#include "design_argument.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/text_file.hpp"

namespace triskin::cli {
namespace {

bool is_design(const std::filesystem::path& path, std::uint64_t id) {
  try {
    // The digits are looked for first: a file without them need not be read as a design.
    return read_text(path).find(fmt::format("{:016x}", id)) != std::string::npos &&
           design::read_design(path).design_id == id;
  } catch (const InputError&) {
    return false;  // The file has the extension .json but is not a design.
  }
}

std::vector<std::filesystem::path> json_files_here() {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(".", error)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path().filename());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

DesignArgument find_design(const std::string& argument) {
  if (!sheet::is_page_code(argument)) return {argument, {}};
  const auto code = sheet::read_page_code(argument);
  if (!code)
    throw InputError(
        fmt::format("{}: not the text of a QR code of an assembly sheet, triskin:DESIGNID/PATCH/PAGE", argument));
  const std::vector<std::filesystem::path> files = json_files_here();
  for (const auto& file : files) {
    if (is_design(file, code->design_id)) return {file.string(), code};
  }
  throw InputError(
      fmt::format("{}: none of the {} *.json in this folder is the design {:016x}; go to the folder that holds it, or "
                  "name the file",
                  argument, counted(files.size(), "file"), code->design_id));
}

void say_if_changed(const design::Design& design, const std::string& file, const Output& output) {
  if (design::design_id_of(design) == design.design_id) return;
  output.say(
      fmt::format("{} was changed outside of triskin: its modules and wiring no longer match its id, {:016x}, and it "
                  "cannot be flashed; triskin check says what is wrong",
                  file, design.design_id));
}

}  // namespace triskin::cli
