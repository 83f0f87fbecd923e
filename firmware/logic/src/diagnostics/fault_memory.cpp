// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/diagnostics/fault_memory.hpp"

#include <algorithm>

namespace triskin::fw {
namespace {

constexpr std::uint32_t kPageMagic = 0x474F4C46;  // In memory these bytes read "FLOG".
constexpr std::uint8_t kFaultMark = 0xFA, kCrashMark = 0xFC;

using Record = std::array<std::uint8_t, FaultMemory::kRecordBytes>;

void seal(Record& record) {
  ByteWriter(std::span(record).last(4)).le32(crc32(Bytes(record).first(12)));
}

bool sealed(Bytes record) {
  return ByteReader(record.last(4)).le32() == crc32(record.first(12));
}

bool erased(Bytes bytes) {
  return std::ranges::all_of(bytes, [](std::uint8_t b) { return b == 0xFF; });
}

Record fault_record(TableRow row, std::size_t state, FaultMemory::Freeze freeze) {
  Record record{};
  ByteWriter w(record);
  w.u8(kFaultMark);
  w.u8(static_cast<std::uint8_t>(row));
  w.u8(static_cast<std::uint8_t>(state));
  w.u8(0);
  w.le32(freeze.time_ms);
  w.le32(freeze.sample);
  seal(record);
  return record;
}

}  // namespace

Bytes FaultMemory::record_at(std::size_t page, std::size_t index) const {
  return flash_.bytes().subspan(page_offset(page) + index * kRecordBytes, kRecordBytes);
}

// Record 0 of a page (magic, sequence) is programmed last when the page is started.
bool FaultMemory::page_valid(std::size_t page, std::uint32_t& sequence) const {
  ByteReader r(record_at(page, 0));
  const bool magic = r.le32() == kPageMagic;
  sequence = r.le32();
  return magic && sealed(record_at(page, 0));
}

void FaultMemory::load() {
  entries_ = {};
  crash_.reset();
  crash_part_ = 0;
  used_ = 0;
  if (!stored()) return;
  for (std::size_t page = 0; page < 2; ++page) {
    std::uint32_t sequence = 0;
    if (!page_valid(page, sequence) || (used_ != 0 && sequence <= sequence_)) continue;
    page_ = page;
    sequence_ = sequence;
    used_ = 1;
  }
  if (used_ != 0) replay(page_);
}

// A record that a power failure tore has a wrong CRC and is skipped.
void FaultMemory::replay(std::size_t page) {
  for (; (used_ + 1) * kRecordBytes <= flash_.page_bytes(); ++used_) {
    const Bytes record = record_at(page, used_);
    if (erased(record)) return;
    if (!sealed(record)) continue;
    if (record[0] == kFaultMark) replay_fault(record);
    if (record[0] == kCrashMark) replay_crash(record);
  }
}

void FaultMemory::replay_fault(Bytes record) {
  ByteReader r(record);
  (void)r.u8();
  const std::size_t module = r.u8(), state = r.u8();
  if (module >= entries_.size() || state < kFirstFault || state >= kStates) return;
  (void)r.u8();
  Entry& entry = entries_[module][state];
  entry.status = kConfirmed;
  entry.freeze.time_ms = r.le32();
  entry.freeze.sample = r.le32();
}

// Only a complete crash, with all its parts, replaces the previous one.
void FaultMemory::replay_crash(Bytes record) {
  const std::size_t part = record[1];
  if (part == 0) crash_part_ = 0;
  if (part != crash_part_ || part >= kCrashRecords) return;
  std::ranges::copy(record.subspan(2, kCrashPartBytes),
                    crash_parts_.begin() + static_cast<std::ptrdiff_t>(part * kCrashPartBytes));
  if (++crash_part_ < kCrashRecords) return;
  crash_part_ = 0;
  if (const auto crash = wire::Crash::decode(Bytes(crash_parts_).first(wire::Crash::kMaxBytes))) crash_ = *crash;
}

bool FaultMemory::program_crash(std::size_t page, std::size_t index) {
  std::array<std::uint8_t, kCrashRecords * kCrashPartBytes> parts{};
  ByteWriter all(parts);
  crash_->encode(all);
  for (std::size_t part = 0; part < kCrashRecords; ++part) {
    Record record{};
    ByteWriter w(record);
    w.u8(kCrashMark);
    w.u8(static_cast<std::uint8_t>(part));
    w.bytes(Bytes(parts).subspan(part * kCrashPartBytes, kCrashPartBytes));
    seal(record);
    if (!program(page, index + part, record)) return false;
  }
  return true;
}

bool FaultMemory::note_crash(const wire::Crash& crash) {
  crash_ = crash;
  if (!stored()) return false;
  if (used_ == 0 || (used_ + kCrashRecords) * kRecordBytes > flash_.page_bytes()) return start_page();
  const std::size_t at = used_;
  used_ += kCrashRecords;
  return program_crash(page_, at);
}

void FaultMemory::note(TableRow row, wire::ModuleState state, Freeze now) {
  for (std::size_t s = kFirstFault; s < kStates; ++s) {
    Entry& e = entries_[index_of(row)][s];
    if (static_cast<std::size_t>(state) != s) {
      e.status = static_cast<std::uint8_t>(e.status & ~kTestFailed);
      continue;
    }
    const bool first = (e.status & kConfirmed) == 0;
    e.status = kTestFailed | kConfirmed;
    if (!first) continue;
    e.freeze = now;
    (void)append(row, s);  // If the flash refuses, the fault stays in RAM.
  }
}

bool FaultMemory::clear() {
  const bool crashed = crash_.has_value();
  crash_.reset();
  return clear_modules() && (!crashed || !stored() || start_page());
}

bool FaultMemory::clear_modules() {
  const bool any = std::ranges::any_of(
      entries_, [](const auto& m) { return std::ranges::any_of(m, [](const Entry& e) { return e.status != 0; }); });
  entries_ = {};
  return !any || !stored() || start_page();
}

bool FaultMemory::program(std::size_t page, std::size_t index, std::span<const std::uint8_t, kRecordBytes> record) {
  const std::size_t at = page_offset(page) + index * kRecordBytes, unit = flash_.program_bytes();
  for (std::size_t k = 0; k < kRecordBytes; k += unit) {
    if (!flash_.program(at + k, record.subspan(k, unit))) return false;
  }
  return true;
}

bool FaultMemory::append(TableRow row, std::size_t state) {
  if (!stored()) return false;
  // The new page also gets the new entry.
  if (used_ == 0 || (used_ + 1) * kRecordBytes > flash_.page_bytes()) return start_page();
  return program(page_, used_++, fault_record(row, state, entries_[index_of(row)][state].freeze));
}

// Starts the other page with the confirmed faults. Until its first record is written, the old page is valid.
bool FaultMemory::start_page() {
  if (!stored()) return false;
  const std::size_t next = 1 - page_;
  const bool blank = used_ == 0 && erased(flash_.bytes().subspan(page_offset(next), flash_.page_bytes()));
  if (!blank && !flash_.erase_page(page_offset(next)))
    return false;  // A page of a new board needs no erase, which would delay the loop.
  std::size_t at = 1;
  for (std::size_t m = 0; m < entries_.size(); ++m) {
    for (std::size_t s = kFirstFault; s < kStates; ++s) {
      if ((entries_[m][s].status & kConfirmed) == 0) continue;
      if (!program(next, at++, fault_record(table_row(m), s, entries_[m][s].freeze))) return false;
    }
  }
  if (crash_) {
    if (!program_crash(next, at)) return false;
    at += kCrashRecords;
  }
  Record head{};
  ByteWriter w(head);
  w.le32(kPageMagic);
  w.le32(sequence_ + 1);
  w.le32(0);
  seal(head);
  if (!program(next, 0, head)) return false;
  page_ = next;
  used_ = at;
  ++sequence_;
  return true;
}

void FaultMemory::report(std::uint8_t mask, ByteWriter& out) const {
  for (std::size_t m = 0; m < entries_.size(); ++m) {
    for (std::size_t s = kFirstFault; s < kStates; ++s) {
      if ((entries_[m][s].status & mask) == 0) continue;
      const wire::FaultCode code{static_cast<wire::ModuleState>(s), static_cast<std::uint8_t>(m)};
      wire::FaultList::encode({code, entries_[m][s].status}, out);
    }
  }
}

std::optional<wire::FreezeFrame> FaultMemory::snapshot(std::uint32_t dtc) const {
  const auto code = wire::FaultCode::of(dtc);
  if (!code) return std::nullopt;
  const Entry& e = entries_[code->row][static_cast<std::size_t>(code->state)];
  if ((e.status & kConfirmed) == 0) return std::nullopt;
  return wire::FreezeFrame{{*code, e.status}, e.freeze};
}

}  // namespace triskin::fw
