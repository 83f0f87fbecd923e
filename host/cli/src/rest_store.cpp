// SPDX-License-Identifier: GPL-3.0-or-later
#include "rest_store.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "triskin/base/bytes.hpp"
#include "triskin/design/json_value.hpp"
#include "triskin/host/files.hpp"

namespace triskin::cli {

RestStore::RestStore(const design::Design& design, const std::vector<wire::NodeClaim>& boards)
    : modules_(design.layout.modules.size()) {
  std::vector<std::uint8_t> ids;
  for (const auto& board : boards) ids.insert(ids.end(), board.unique_id.begin(), board.unique_id.end());
  file_ = state_home() / "rest" / fmt::format("{:016x}_{:08x}.json", design.design_id, crc32(ids));
}

device::RestValues RestStore::read() const {
  if (!std::filesystem::exists(file_)) return {};
  const std::string name = file_.string();
  const nlohmann::json document = design::parse_json(read_file(file_), name);
  const design::JsonValue counts = design::JsonValue(document, name, "")["rest_counts"];
  counts.require_size(modules_);
  device::RestValues rest(modules_);
  for (std::size_t m = 0; m < modules_; ++m) {
    counts.at(m).require_size(rest[m].size());
    for (std::size_t t = 0; t < rest[m].size(); ++t) rest[m][t] = counts.at(m).at(t).number();
  }
  return rest;
}

void RestStore::write(const device::RestValues& rest) const {
  std::error_code none;
  std::filesystem::create_directories(file_.parent_path(), none);
  const nlohmann::json document{{"format", "triskin-rest"}, {"version", 1}, {"rest_counts", rest}};
  write_file_atomically(file_, document.dump() + "\n");
}

}  // namespace triskin::cli
