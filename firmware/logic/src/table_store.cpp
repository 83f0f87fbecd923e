// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/table_store.hpp"

#include <algorithm>

namespace triskin::fw {
namespace {

constexpr std::uint32_t kCommitMagic = 0x54494D43;  // "CMIT"
constexpr std::uint32_t kNodeMagic = 0x45444F4E;    // "NODE"
constexpr int kNodePages[] = {2, 3};
constexpr std::size_t kNodeRecordBytes = 8;

}  // namespace

// The commit record stands at the end of the slot's page: magic, sequence, image length, CRC of these and the image.
Result<std::uint32_t> TableStore::read_slot(int slot, layout::PatchImage& image) const {
  const Bytes page = flash_.bytes().subspan(slot_offset(slot), flash_.page_bytes());
  ByteReader r(page.last(kCommitBytes));
  if (r.le32() != kCommitMagic) return std::unexpected(Status::kEmpty);
  const std::uint32_t sequence = r.le32();
  const std::uint32_t size = r.le32();
  if (size < layout::kHeaderBytes || size > layout::kMaxImageBytes) return std::unexpected(Status::kBadLength);
  if (r.le32() != crc32(page.last(kCommitBytes).first(12), crc32(page.first(size))))
    return std::unexpected(Status::kBadCrc);
  const auto decoded = layout::decode(page.first(size));
  if (!decoded) return std::unexpected(decoded.error());
  image = *decoded;
  return sequence;
}

void TableStore::load() {
  active_slot_ = -1;
  for (int slot = 0; slot < 2; ++slot) {
    layout::PatchImage image;
    const auto sequence = read_slot(slot, image);
    if (!sequence || (active_slot_ >= 0 && *sequence <= sequence_)) continue;
    active_slot_ = slot;
    sequence_ = *sequence;
    table_ = image;
  }
  load_node_address();
}

// The valid record with the highest sequence counts.
void TableStore::load_node_address() {
  node_address_ = layout::kFirstNode;
  node_sequence_ = 0;
  node_page_ = 0;
  for (int page = 0; page < 2; ++page) {
    const Bytes bytes = flash_.bytes().subspan(slot_offset(kNodePages[page]), flash_.page_bytes());
    for (std::size_t at = 0; at + kNodeRecordBytes <= bytes.size(); at += kNodeRecordBytes) {
      ByteReader r(bytes.subspan(at, kNodeRecordBytes));
      if (r.le32() != kNodeMagic) continue;
      const std::uint8_t address = r.u8(), complement = r.u8();
      const std::uint16_t sequence = r.le16();
      if (address != static_cast<std::uint8_t>(~complement) || !layout::is_node_address(address) ||
          sequence <= node_sequence_)
        continue;
      node_address_ = address;
      node_sequence_ = sequence;
      node_page_ = page;
    }
  }
}

Bytes TableStore::active_bytes() const {
  if (!has_table()) return {};
  return flash_.bytes().subspan(slot_offset(active_slot_),
                                layout::kHeaderBytes + table_.module_count * layout::kRowBytes);
}

void TableStore::begin_download(std::size_t size_bytes) {
  staged_size_ = size_bytes <= staged_.size() ? size_bytes : 0;
  staged_at_ = 0;
}

Status TableStore::append(Bytes block) {
  if (block.size() > staged_size_ - staged_at_) return Status::kNoSpace;
  std::copy(block.begin(), block.end(), staged_.begin() + static_cast<std::ptrdiff_t>(staged_at_));
  staged_at_ += block.size();
  return Status::kOk;
}

Status TableStore::check_staged(std::uint8_t node_address) const {
  if (!downloaded()) return Status::kBadLength;
  const auto image = layout::decode(staged_bytes());
  if (!image) return image.error();
  if (layout::kHeaderBytes + image->module_count * layout::kRowBytes != staged_size_) return Status::kBadLength;
  return image->node_address == node_address ? Status::kOk : Status::kWrongTarget;
}

Status TableStore::activate(std::uint8_t node_address) {
  if (const Status s = check_staged(node_address); s != Status::kOk) return s;
  const int slot = active_slot_ == 0 ? 1 : 0;
  const std::size_t offset = slot_offset(slot);
  if (!flash_.erase_page(offset)) return Status::kFlashFailed;
  // Padded to whole program units with the erased value.
  std::array<std::uint8_t, layout::kMaxImageBytes + 16> unit{};
  unit.fill(0xFF);
  std::copy_n(staged_.begin(), staged_size_, unit.begin());
  const std::size_t step = flash_.program_bytes();
  for (std::size_t at = 0; at < staged_size_; at += step) {
    if (!flash_.program(offset + at, Bytes(unit).subspan(at, step))) return Status::kFlashFailed;
  }
  if (!std::ranges::equal(flash_.bytes().subspan(offset, staged_size_), staged_bytes())) return Status::kFlashFailed;
  std::array<std::uint8_t, kCommitBytes> commit{};
  ByteWriter w(commit);
  w.le32(kCommitMagic);
  w.le32(sequence_ + 1);
  w.le32(static_cast<std::uint32_t>(staged_size_));
  w.le32(crc32(w.written(), crc32(staged_bytes())));
  const std::size_t commit_offset = offset + flash_.page_bytes() - kCommitBytes;
  for (std::size_t at = 0; at < kCommitBytes; at += step) {
    if (!flash_.program(commit_offset + at, Bytes(commit).subspan(at, step))) return Status::kFlashFailed;
  }
  staged_size_ = staged_at_ = 0;
  load();
  return active_slot_ == slot ? Status::kOk : Status::kFlashFailed;
}

// Appends a record; when the page is full, to the other page, so that the old record stands until the new one does.
Status TableStore::set_node_address(std::uint8_t address) {
  if (!layout::is_node_address(address)) return Status::kOutOfRange;
  if (address == node_address_) return Status::kOk;
  std::array<std::uint8_t, kNodeRecordBytes> record{};
  ByteWriter w(record);
  w.le32(kNodeMagic);
  w.u8(address);
  w.u8(static_cast<std::uint8_t>(~address));
  w.le16(static_cast<std::uint16_t>(node_sequence_ + 1));
  std::size_t offset = slot_offset(kNodePages[node_page_]), at = 0;
  const auto used = [&] {
    const Bytes unit = flash_.bytes().subspan(offset + at, kNodeRecordBytes);
    return !std::ranges::all_of(unit, [](std::uint8_t b) { return b == 0xFF; });
  };
  while (at < flash_.page_bytes() && used()) at += kNodeRecordBytes;
  // A unit that a cut of power left between two states may read as erased and still be refused: take the next one.
  while (at < flash_.page_bytes() && !flash_.program(offset + at, record)) at += kNodeRecordBytes;
  if (at >= flash_.page_bytes()) {
    offset = slot_offset(kNodePages[1 - node_page_]);
    if (!flash_.erase_page(offset) || !flash_.program(offset, record)) return Status::kFlashFailed;
  }
  load_node_address();
  return node_address_ == address ? Status::kOk : Status::kFlashFailed;
}

}  // namespace triskin::fw
