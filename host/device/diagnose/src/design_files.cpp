// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/design_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace triskin::diagnose {
namespace {

constexpr std::size_t kMaxFiles = 200;
constexpr std::size_t kBlockBytes = 1 << 16;

// Only the id is read from the file, because reading a large design takes a second.
bool has_id(const std::filesystem::path& file, const std::string& id) {
  const std::string key = "\"design_id\"";
  std::ifstream in(file, std::ios::binary);
  std::string text, block(kBlockBytes, '\0');
  while (in.read(block.data(), kBlockBytes) || in.gcount() > 0) {
    text.append(block, 0, static_cast<std::size_t>(in.gcount()));
    const std::size_t at = text.find(key);
    if (at != std::string::npos && at + key.size() + id.size() + 8 < text.size())
      return text.substr(at + key.size(), id.size() + 8).find('"' + id + '"') != std::string::npos;
    if (at == std::string::npos) text.erase(0, text.size() - std::min(text.size(), key.size()));
  }
  return false;
}

}  // namespace

std::vector<std::filesystem::path> files_of_design(const std::filesystem::path& folder, std::uint64_t id) {
  std::vector<std::filesystem::path> candidates, found;
  std::error_code failed;
  for (std::filesystem::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
    if (at->path().extension() == ".json" && at->is_regular_file(failed)) candidates.push_back(at->path());
    if (candidates.size() == kMaxFiles) break;
  }
  std::ranges::sort(candidates);
  const std::string text = fmt::format("{:016x}", id);
  std::ranges::copy_if(candidates, std::back_inserter(found), [&](const auto& file) { return has_id(file, text); });
  return found;
}

void name_files(std::vector<Finding>& findings, const std::filesystem::path& design_file) {
  const std::filesystem::path folder = design_file.has_parent_path() ? design_file.parent_path() : ".";
  for (Finding& f : findings) {
    if (f.held_design == 0) continue;
    const auto files = files_of_design(folder, f.held_design);
    if (files.empty()) continue;
    f.held_file = (design_file.parent_path() / files.front().filename()).string();
    f.remedy = fmt::format(
        "look first whether this is the right file: {} is the design that the skin holds; only if the skin is to "
        "become "
        "this design, run triskin flash --take-over",
        f.held_file);
  }
}

}  // namespace triskin::diagnose
