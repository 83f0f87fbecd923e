// SPDX-License-Identifier: GPL-3.0-or-later
#include "rest_store.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <vector>

#include "triskin/base/files.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/base/writer_lock.hpp"
#include "triskin/core/bytes.hpp"

namespace triskin::skin {
namespace {

constexpr std::chrono::milliseconds kPatience{2'000};  // Another writer needs only milliseconds.

}  // namespace

RestStore::RestStore(const design::Design& design, std::span<const wire::NodeClaim> claims)
    : modules_(design.layout.modules.size()) {
  std::vector<std::uint8_t> ids;
  for (const wire::NodeClaim& board : claims) {
    if (design::patch_at(design, layout::NodeAddress{board.node_address}) < 0) continue;
    ids.insert(ids.end(), board.unique_id.begin(), board.unique_id.end());
  }
  file_ = state_home() / "rest" / fmt::format("{:016x}_{:08x}.json", design.design_id, crc32(ids));
}

design::RestValues RestStore::read() const {
  if (!std::filesystem::exists(file_)) return {};
  return design::parse_rest(read_text(file_), file_.string(), modules_);
}

void RestStore::write(const design::RestValues& rest) const {
  std::error_code none;
  std::filesystem::create_directories(file_.parent_path(), none);
  const WriterLock lock(file_, kPatience);
  write_file_atomically(file_, design::rest_text(rest));
}

}  // namespace triskin::skin
