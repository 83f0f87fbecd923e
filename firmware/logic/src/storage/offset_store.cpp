// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/storage/offset_store.hpp"

#include <algorithm>
#include <bit>

namespace triskin::fw {
namespace {

constexpr std::uint16_t kMagic = 0x464F;  // In memory these bytes read "OF".
constexpr std::size_t kSealed = OffsetStore::kRecordBytes - 4;

bool all_ones(Bytes bytes) {
  return std::ranges::all_of(bytes, [](std::uint8_t b) { return b == 0xFF; });
}

}  // namespace

void OffsetStore::load(OffsetBook& book) {
  page_ = used_ = written_ = 0;
  sequence_ = elsewhere_ = 0;
  newest_ = {};
  writing_ = kNoPlace;
  failed_ = false;
  if (!stored()) return;
  for (std::size_t page = 0; page < 2; ++page) {
    for (std::size_t slot = 0; slot < slots(); ++slot) read(page, slot, book);
  }
  find_end();
}

// A record counts if it is complete, of this version, and newer than the previous one for its place.
void OffsetStore::read(std::size_t page, std::size_t slot, OffsetBook& book) {
  const Bytes bytes = flash_.bytes().subspan(offset_of(page, slot), kRecordBytes);
  ByteReader r(bytes);
  if (r.le16() != kMagic || r.u8() != kVersion) return;
  const std::size_t place = r.u8();
  const std::uint32_t sequence = r.le32();
  if (ByteReader(bytes.subspan(kSealed)).le32() != crc32(bytes.first(kSealed)) || place >= book.size()) return;
  if (sequence > sequence_) {
    sequence_ = sequence;
    page_ = page;
  }
  if (sequence <= newest_[place]) return;
  newest_[place] = sequence;
  const auto bit = static_cast<std::uint16_t>(1U << place);
  // The bit is stored as if page_ were 0; find_end() inverts it otherwise.
  elsewhere_ = static_cast<std::uint16_t>(page == 0 ? elsewhere_ & ~bit : elsewhere_ | bit);
  PlaceOffsets& p = book[place];
  if (p.to_store) return;  // Newer offsets wait to be written.
  p.device_id = r.le16();
  for (std::uint8_t& s : p.steps) s = std::min(r.u8(), ad7147::kMaxOffset);
  p.known = true;
}

void OffsetStore::find_end() {
  std::uint16_t present = 0;
  for (std::size_t p = 0; p < newest_.size(); ++p) {
    if (newest_[p] != 0) present = static_cast<std::uint16_t>(present | 1U << p);
  }
  if (page_ == 1) elsewhere_ = static_cast<std::uint16_t>(present & ~elsewhere_);
  for (used_ = slots(); used_ > 0; --used_) {
    if (!all_ones(flash_.bytes().subspan(offset_of(page_, used_ - 1), kRecordBytes))) return;
  }
}

// New offsets are written first, then those that would be lost with the other page.
std::size_t OffsetStore::next_place(const OffsetBook& book) const {
  for (std::size_t p = 0; p < book.size(); ++p) {
    if (book[p].to_store) return p;
  }
  return elsewhere_ == 0 ? kNoPlace : static_cast<std::size_t>(std::countr_zero(elsewhere_));
}

bool OffsetStore::step(OffsetBook& book) {
  if (writing_ != kNoPlace) {
    write_unit(book);
    return true;
  }
  if (failed_ || !stored()) return false;
  const std::size_t place = next_place(book);
  if (place == kNoPlace) return false;
  if (used_ == slots())
    start_page();
  else
    begin_record(book, place);
  return true;
}

// All valid records are on the page that is full.
void OffsetStore::start_page() {
  if (!flash_.erase_page(offset_of(1 - page_, 0))) {
    failed_ = true;
    return;
  }
  page_ = 1 - page_;
  used_ = 0;
  for (std::size_t p = 0; p < newest_.size(); ++p) {
    if (newest_[p] != 0) elsewhere_ = static_cast<std::uint16_t>(elsewhere_ | 1U << p);
  }
}

void OffsetStore::begin_record(OffsetBook& book, std::size_t place) {
  PlaceOffsets& p = book[place];
  record_ = {};
  ByteWriter w(record_);
  w.le16(kMagic);
  w.u8(kVersion);
  w.u8(static_cast<std::uint8_t>(place));
  w.le32(sequence_ + 1);
  w.le16(p.device_id);
  w.bytes(p.steps);
  ByteWriter(std::span(record_).subspan(kSealed)).le32(crc32(Bytes(record_).first(kSealed)));
  p.to_store = false;
  writing_ = place;
  written_ = 0;
}

// After a power failure a unit between two states may read as erased and still be refused; then the record continues in
// the next one.
void OffsetStore::write_unit(OffsetBook& book) {
  const std::size_t unit = flash_.program_bytes();
  if (!flash_.program(offset_of(page_, used_) + written_, Bytes(record_).subspan(written_, unit))) {
    ++used_;
    written_ = 0;
    if (used_ < slots()) return;
    book[writing_].to_store = true;
    writing_ = kNoPlace;
    return;
  }
  written_ += unit;
  if (written_ < kRecordBytes) return;
  ++used_;
  newest_[writing_] = ++sequence_;
  elsewhere_ = static_cast<std::uint16_t>(elsewhere_ & ~(1U << writing_));
  writing_ = kNoPlace;
}

}  // namespace triskin::fw
