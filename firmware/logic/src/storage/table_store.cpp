// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/storage/table_store.hpp"

#include <algorithm>

#include "triskin/wire/calibration.hpp"

namespace triskin::fw {
namespace {

constexpr std::uint32_t kCommitMagic = 0x54494D43;       // In memory these bytes read "CMIT".
constexpr std::uint32_t kNodeMagic = 0x45444F4E;         // In memory these bytes read "NODE".
constexpr std::uint32_t kCalibrationMagic = 0x424C4143;  // In memory these bytes read "CALB".
constexpr std::size_t kRecordHeadBytes = 8, kRecordEndBytes = 8;
constexpr std::size_t kLongestUnit = 16;
constexpr int kNodePages[] = {2, 3};
constexpr std::size_t kNodeRecordBytes = 8;

constexpr std::size_t whole_units(std::size_t bytes, std::size_t unit) {
  return (bytes + unit - 1) / unit * unit;
}

// If the same modules are at the same places, the calibration of their taxels stays valid.
bool same_modules(const layout::PatchImage& a, const layout::PatchImage& b) {
  return a.design_id == b.design_id &&
         std::ranges::equal(a.rows(), b.rows(), [](const layout::ModuleRow& x, const layout::ModuleRow& y) {
           return x.module_id == y.module_id && x.line == y.line && x.address == y.address;
         });
}

// Returns true if every place of the calibration has a module.
bool fits(const wire::Calibration& calibration, const layout::PatchImage& table) {
  return calibration.design_id == table.design_id &&
         std::ranges::all_of(calibration.rows(), [&](const wire::PlaceSensitivity& p) {
           return std::ranges::any_of(table.rows(), [&](const layout::ModuleRow& m) {
             return m.line * layout::kAddressesPerLine + m.address == p.place;
           });
         });
}

}  // namespace

// The commit record is at the end of the slot's page: magic, sequence, image length, CRC of these and the image.
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
  find_calibration();
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
  const auto image = layout::decode(staged_bytes());
  const Status s = write_slot(staged_bytes(), has_table() && same_modules(*image, table_) ? calibration() : Bytes{});
  if (s == Status::kOk) staged_size_ = staged_at_ = 0;
  return s;
}

// The commit record is written last; until then the old slot is the newest.
Status TableStore::write_slot(Bytes image, Bytes calibration) {
  const int slot = active_slot_ == 0 ? 1 : 0;
  const std::size_t offset = slot_offset(slot);
  if (!flash_.erase_page(offset) || !program(offset, image)) return Status::kFlashFailed;
  const std::size_t behind = offset + whole_units(image.size(), flash_.program_bytes());
  if (!calibration.empty() && !write_record(behind, calibration)) return Status::kFlashFailed;
  std::array<std::uint8_t, kCommitBytes> commit{};
  ByteWriter w(commit);
  w.le32(kCommitMagic);
  w.le32(sequence_ + 1);
  w.le32(static_cast<std::uint32_t>(image.size()));
  w.le32(crc32(w.written(), crc32(image)));
  if (!program(offset + flash_.page_bytes() - kCommitBytes, commit)) return Status::kFlashFailed;
  load();
  return active_slot_ == slot ? Status::kOk : Status::kFlashFailed;
}

// Pads to whole program units with the erased value, and reads back.
bool TableStore::program(std::size_t offset, Bytes bytes) {
  const std::size_t step = flash_.program_bytes();
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    std::array<std::uint8_t, kLongestUnit> unit;
    unit.fill(0xFF);
    std::ranges::copy(bytes.subspan(at, std::min(step, bytes.size() - at)), unit.begin());
    if (!flash_.program(offset + at, Bytes(unit).first(step))) return false;
  }
  return std::ranges::equal(flash_.bytes().subspan(offset, bytes.size()), bytes);
}

// Writes head, value and CRC; the unit with the CRC is last, and with it the record becomes valid.
bool TableStore::write_record(std::size_t offset, Bytes calibration) {
  std::array<std::uint8_t, kRecordHeadBytes> head{};
  ByteWriter h(head);
  h.le32(kCalibrationMagic);
  h.le16(static_cast<std::uint16_t>(calibration.size()));
  h.le16(static_cast<std::uint16_t>(~calibration.size()));
  std::array<std::uint8_t, kRecordEndBytes> end{};
  ByteWriter(end).le32(crc32(calibration, crc32(head)));
  const std::size_t value_at = offset + kRecordHeadBytes;
  return program(offset, head) && program(value_at, calibration) &&
         program(value_at + whole_units(calibration.size(), flash_.program_bytes()), end);
}

// The newest complete record counts. After a head that was cut off, nothing can be found, so the page counts as full.
void TableStore::find_calibration() {
  calibration_at_ = calibration_bytes_ = 0;
  if (!has_table()) return;
  const std::size_t unit = flash_.program_bytes(), end = flash_.page_bytes() - kCommitBytes;
  const Bytes page = flash_.bytes().subspan(slot_offset(active_slot_), end);
  std::size_t at = whole_units(active_bytes().size(), unit);
  while (at + kRecordHeadBytes + kRecordEndBytes <= end) {
    const Bytes head = page.subspan(at, kRecordHeadBytes);
    free_at_ = at;
    if (std::ranges::all_of(head, [](std::uint8_t b) { return b == 0xFF; })) return;
    ByteReader r(head);
    const std::uint32_t magic = r.le32();
    const std::size_t bytes = r.le16();
    const std::size_t crc_at = at + kRecordHeadBytes + whole_units(bytes, unit);
    if (magic != kCalibrationMagic || r.le16() != (~bytes & 0xFFFF) || crc_at + kRecordEndBytes > end) break;
    const Bytes value = page.subspan(at + kRecordHeadBytes, bytes);
    if (ByteReader(page.subspan(crc_at)).le32() == crc32(value, crc32(head))) {
      calibration_at_ = at + kRecordHeadBytes;
      calibration_bytes_ = bytes;
    }
    at = crc_at + kRecordEndBytes;
  }
  free_at_ = end;
}

// A calibration without rows means that it was deleted.
Bytes TableStore::calibration() const {
  if (!has_table() || calibration_bytes_ <= wire::Calibration::kHeadBytes) return {};
  return flash_.bytes().subspan(slot_offset(active_slot_) + calibration_at_, calibration_bytes_);
}

Status TableStore::set_calibration(Bytes value) {
  const auto decoded = wire::Calibration::decode(value);
  if (!decoded) return decoded.error();
  if (!has_table()) return Status::kEmpty;
  if (!fits(*decoded, table_)) return Status::kWrongTarget;
  const Bytes wanted = decoded->count == 0 ? Bytes{} : value;
  const auto kept = [&] { return std::ranges::equal(calibration(), wanted); };
  if (kept()) return Status::kOk;
  const std::size_t end = flash_.page_bytes() - kCommitBytes;
  const std::size_t bytes = kRecordHeadBytes + whole_units(value.size(), flash_.program_bytes()) + kRecordEndBytes;
  if (bytes <= end - free_at_) {
    (void)write_record(slot_offset(active_slot_) + free_at_, value);
    find_calibration();
    if (kept()) return Status::kOk;
  }
  // The page is full, or refused a unit, so table and calibration move to the other slot.
  const Status s = write_slot(active_bytes(), wanted);
  return s == Status::kOk && !kept() ? Status::kFlashFailed : s;
}

// Appends a record. When the page is full, it is written to the other page, so that the old record remains until the
// new one is complete.
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
  // After a power failure a unit between two states may read as erased and still be refused; then the next one is used.
  while (at < flash_.page_bytes() && !flash_.program(offset + at, record)) at += kNodeRecordBytes;
  if (at >= flash_.page_bytes()) {
    offset = slot_offset(kNodePages[1 - node_page_]);
    if (!flash_.erase_page(offset) || !flash_.program(offset, record)) return Status::kFlashFailed;
  }
  load_node_address();
  return node_address_ == address ? Status::kOk : Status::kFlashFailed;
}

}  // namespace triskin::fw
