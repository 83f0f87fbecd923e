// SPDX-License-Identifier: GPL-3.0-or-later
#include "module_ids.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>
#include <string_view>

#include "triskin/base/error.hpp"
#include "triskin/base/format_index.hpp"

namespace triskin::cli {
namespace {

constexpr int kMaxModuleId = 9'999'999;

// Parses a whole number in [low, kMaxModuleId]; the text may contain nothing else.
bool read_id(std::string_view text, int low, int& id) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  return error == std::errc{} && end == text.data() + text.size() && id >= low && id <= kMaxModuleId;
}

}  // namespace

std::vector<layout::ModuleId> module_ids(const std::string& option, const std::string& text) {
  std::vector<layout::ModuleId> ids;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-', 1);
    const std::string_view whole = part;
    int first = 0, last = 0;
    bool is_read = read_id(whole.substr(0, dash), 0, first);
    last = first;
    if (dash != std::string::npos) is_read = is_read && read_id(whole.substr(dash + 1), first, last);
    if (!is_read)
      throw InputError(
          fmt::format("{}: \"{}\" is not understood; give module ids and ranges of them, as 3,7-9", option, part));
    for (int id = first; id <= last; ++id) ids.emplace_back(id);
  }
  return ids;
}

std::string module_ids_text(std::span<const layout::ModuleId> ids) {
  std::string text;
  for (std::size_t k = 0; k < ids.size();) {
    std::size_t last = k;
    while (last + 1 < ids.size() && ids[last + 1] == ids[last] + 1) ++last;
    text += text.empty() ? "" : ",";
    text += last == k ? fmt::format("{}", ids[k]) : fmt::format("{}-{}", ids[k], ids[last]);
    k = last + 1;
  }
  return text;
}

}  // namespace triskin::cli
