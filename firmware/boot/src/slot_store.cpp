// SPDX-License-Identifier: Apache-2.0
#include "triskin/boot/slot_store.hpp"

#include "triskin/layout/image_check.hpp"
#include "triskin/wire/identity.hpp"

namespace triskin::boot {
namespace {

constexpr std::size_t kUnitBytes = 8;
// Programmers write whole blocks of 1,024 bytes and fill them up with ones or zeros, so the marks lie in the second
// block of the page, where no file has bytes.
constexpr std::size_t kMarks = 1024, kConfirmUnits = 3;
constexpr std::size_t kFirstStart = kMarks, kFirstConfirmation = kMarks + kMaxStarts * kUnitBytes;
constexpr std::array<std::uint8_t, kUnitBytes> kMark{'T', 'S', 'K', 'M', 'A', 'R', 'K', 0};
constexpr std::uint32_t kSmallest = 512;

}  // namespace

bool SlotStore::vectors_fit(int slot, std::uint32_t size_bytes) const {
  return layout::vectors_fit(word(slot, 0), word(slot, 4), origin(slot), size_bytes);
}

// A unit of zeros was filled up by a programmer; anything else that is not erased is a mark, whole or torn by a power
// failure.
int SlotStore::marks(int slot, std::size_t first, std::size_t count) const {
  int found = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = first + k * kUnitBytes;
    if (!unit_erased(slot, at) && (word(slot, at) != 0 || word(slot, at + 4) != 0)) ++found;
  }
  return found;
}

// Programs the first free one of `count` units. A unit torn by a power failure may look free but is refused; then the
// next one is used.
bool SlotStore::add_mark(int slot, std::size_t first, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = first + k * kUnitBytes;
    if (unit_erased(slot, at) && area(slot).program(at, kMark)) return true;
  }
  return false;
}

SlotState SlotStore::inspect(int slot) const {
  SlotState s;
  const std::size_t at = records(slot);
  if (word(slot, at) != layout::kCommitMagic) return s;
  s.sequence = word(slot, at + 4);
  s.size_bytes = word(slot, at + 8);
  s.record_crc = word(slot, at + 12);
  if (s.size_bytes < kSmallest || s.size_bytes > records(slot)) return s;
  s.valid = vectors_fit(slot, s.size_bytes) &&
            s.record_crc == layout::slot_crc(s.sequence, area(slot).bytes().first(s.size_bytes));
  s.starts = marks(slot, at + kFirstStart, kMaxStarts);
  s.confirmed = marks(slot, at + kFirstConfirmation, kConfirmUnits) > 0;
  return s;
}

SlotState SlotStore::peek(int slot) const {
  const std::size_t at = records(slot);
  return {true,
          marks(slot, at + kFirstConfirmation, kConfirmUnits) > 0,
          0,
          word(slot, at + 4),
          word(slot, at + 8),
          word(slot, at + 12)};
}

int SlotStore::choose() const {
  int best = -1, best_rank = 0;
  std::uint32_t sequence = 0;
  for (int slot = 0; slot < 2; ++slot) {
    const SlotState s = inspect(slot);
    const int rank = s.startable() ? 2 : s.valid ? 1 : 0;
    if (rank == 0 || rank < best_rank || (rank == best_rank && s.sequence <= sequence)) continue;
    best = slot;
    best_rank = rank;
    sequence = s.sequence;
  }
  return best;
}

bool SlotStore::note_start(int slot) {
  return add_mark(slot, records(slot) + kFirstStart, kMaxStarts);
}

Status SlotStore::erase(int slot) {
  if (!area(slot).erase_page(records(slot))) return Status::kFlashFailed;
  for (std::size_t at = 0; at < records(slot); at += area(slot).page_bytes()) {
    if (!area(slot).erase_page(at)) return Status::kFlashFailed;
  }
  return Status::kOk;
}

Status SlotStore::program(int slot, std::uint32_t offset, Bytes unit) {
  if (offset + unit.size() > records(slot)) return Status::kNoSpace;
  return area(slot).program(offset, unit) ? Status::kOk : Status::kFlashFailed;
}

Status SlotStore::check(int slot, std::uint32_t size_bytes, std::uint32_t running_version, bool may_be_older) const {
  if (size_bytes > records(slot)) return Status::kNoSpace;
  return layout::check_image(
      area(slot).bytes().first(size_bytes),
      {wire::kPartNumber, origin(slot), static_cast<std::uint32_t>(records(slot)), running_version, may_be_older});
}

Status SlotStore::commit(int slot, std::uint32_t size_bytes, std::uint32_t crc) {
  if (const Status s = check(slot, size_bytes); s != Status::kOk) return s;
  const Bytes image = area(slot).bytes().first(size_bytes);
  if (crc32(image) != crc) return Status::kBadCrc;
  const SlotState other = inspect(1 - slot);
  const std::uint32_t sequence = other.valid ? other.sequence + 1 : 1;
  const bool ok = write_record(slot, sequence, size_bytes, layout::slot_crc(sequence, image));
  return ok && inspect(slot).valid ? Status::kOk : Status::kFlashFailed;
}

bool SlotStore::write_record(int slot, std::uint32_t sequence, std::uint32_t size_bytes, std::uint32_t crc) {
  std::array<std::uint8_t, 2 * kUnitBytes> record{};
  ByteWriter w(record);
  w.le32(layout::kCommitMagic);
  w.le32(sequence);
  w.le32(size_bytes);
  w.le32(crc);
  // Magic and sequence are written first, because the record becomes valid only with the CRC in the second unit.
  return area(slot).program(records(slot), Bytes(record).first(kUnitBytes)) &&
         area(slot).program(records(slot) + kUnitBytes, Bytes(record).subspan(kUnitBytes));
}

void SlotStore::confirm(int slot) {
  const std::size_t first = records(slot) + kFirstConfirmation;
  // The CRC is not checked here: it would delay the loop by 6 ms, and the loader has just checked it.
  if (marks(slot, first, kConfirmUnits) == 0) (void)add_mark(slot, first, kConfirmUnits);
}

}  // namespace triskin::boot
