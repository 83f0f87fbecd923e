// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/board_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "triskin/base/text_file.hpp"
#include "triskin/design/file_head.hpp"
#include "triskin/design/json_fields.hpp"

namespace triskin::deploy {
namespace {

using design::JsonValue;

constexpr const char* kBoardFormat = "triskin-boards";
constexpr int kBoardVersion = 1;
constexpr const char* kBoardPage = "docs/deploy.md";

FlashOptions::Assignment assignment_in(const JsonValue& v, const design::Design& design) {
  design::only_keys(v, {"patch", "serial"}, kBoardPage);
  FlashOptions::Assignment a;
  a.patch = layout::PatchIndex{v["patch"].integer(0, static_cast<int>(design.patches.size()) - 1)};
  if (!design::has_patch(design, a.patch)) v["patch"].fail("must be one of " + design::patch_numbers(design));
  a.serial = normal_serial(v["serial"].text());
  if (a.serial.empty()) v["serial"].fail("must have 24 hexadecimal digits, as triskin discover shows serial numbers");
  return a;
}

// Returns the assignments in the order of their patches.
std::vector<FlashOptions::Assignment> assignments_in(const JsonValue& list, const design::Design& design) {
  std::vector<FlashOptions::Assignment> assignments;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const auto a = assignment_in(list.at(k), design);
    for (const auto& before : assignments) {
      if (before.patch == a.patch) list.at(k)["patch"].fail("the patch stands twice");
      if (before.serial == a.serial) list.at(k)["serial"].fail("the controller stands twice");
    }
    assignments.push_back(a);
  }
  std::ranges::sort(assignments, {}, &FlashOptions::Assignment::patch);
  return assignments;
}

}  // namespace

std::string normal_serial(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'a' && c <= 'f' ? static_cast<char>(c - 'a' + 'A') : c; });
  return text.size() == 24 && text.find_first_not_of("0123456789ABCDEF") == std::string::npos ? text : "";
}

BoardFile read_board_file(const std::filesystem::path& path, const design::Design& design) {
  const std::string name = path.string();
  const nlohmann::json document = design::parse_json(read_text(path), name);
  const JsonValue v(document, name);
  design::require_head(v, kBoardFormat, kBoardVersion, "make the file again with triskin identify");
  design::only_keys(v, {"format", "version", "design_id", "boards"}, kBoardPage);
  BoardFile file;
  file.design_id = design::hex64(v["design_id"]);
  if (file.design_id != design.design_id)
    v["design_id"].fail(
        fmt::format("the boards are those of design {:016x}, this design is {:016x}; identify them again",
                    file.design_id, design.design_id));
  file.boards = assignments_in(v["boards"], design);
  return file;
}

std::string board_file_text(const BoardFile& file) {
  nlohmann::ordered_json boards = nlohmann::ordered_json::array();
  for (const auto& a : file.boards) boards.push_back({{"patch", a.patch}, {"serial", a.serial}});
  const nlohmann::ordered_json document = {{"format", kBoardFormat},
                                           {"version", kBoardVersion},
                                           {"design_id", fmt::format("{:016x}", file.design_id)},
                                           {"boards", std::move(boards)}};
  return document.dump(1) + "\n";
}

}  // namespace triskin::deploy
