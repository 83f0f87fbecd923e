// SPDX-License-Identifier: Apache-2.0
// Starts the newest application that has proved itself or still may; takes a new one over CAN.
#include <cstring>

#include "can.hpp"
#include "slot.hpp"
#include "triskin/base/bytes.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/flash_map.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/boot/loader_protocol.hpp"

namespace triskin::board {
namespace {

using boot::Command;
constexpr std::uint64_t kLook_us = 10'000;

struct Update {
  bool stay = false, selected = false;
  int slot = -1;
  std::uint32_t offset = 0;
  Status status = Status::kEmpty;
};

void reply(Command command, Status status, Bytes more = {}) {
  wire::CanFrame f;
  f.id = boot::kReplyId;
  f.extended = true;
  ByteWriter w(std::span(f.data).first(8));
  w.u8(static_cast<std::uint8_t>(command));
  w.u8(static_cast<std::uint8_t>(status));
  w.bytes(more);
  f.size = static_cast<std::uint8_t>(w.size());
  (void)can.send(f);
}

std::uint32_t id_crc() { return crc32(unique_id()); }

std::uint8_t state_bits(int slot) {
  const SlotState s = inspect_slot(slot);
  return static_cast<std::uint8_t>((s.valid ? 1 : 0) | (s.confirmed ? 2 : 0) | (s.startable() ? 4 : 0));
}

void hello(Update& update) {
  update.stay = true;
  std::array<std::uint8_t, 6> more{};
  ByteWriter w(more);
  w.u8(static_cast<std::uint8_t>(boot::kProtocol << 6 | state_bits(1) << 3 | state_bits(0)));
  w.le32(id_crc());
  reply(Command::kHello, Status::kOk, w.written());
}

Status erase(Update& update, int slot) {
  if (slot < 0 || slot > 1) return Status::kOutOfRange;
  if (slot == choose_slot()) return Status::kWrongTarget;
  update.slot = slot;
  update.offset = 0;
  update.status = erase_slot(slot);
  return update.status;
}

void store(Update& update, Bytes data) {
  if (!update.selected || update.slot < 0 || data.size() != 8) return;
  std::uint32_t words[2];
  std::memcpy(words, data.data(), sizeof words);
  const bool room = update.offset + 8 <= flash_map::kSlotBytes - flash_map::kPageBytes;
  if (!room) update.status = Status::kNoSpace;
  if (room && !program_flash_unit(flash_map::kSlots[update.slot] + update.offset, words[0], words[1])) update.status = Status::kFlashFailed;
  update.offset += 8;
  if (update.offset % (8 * boot::kFramesPerReply) != 0) return;
  std::array<std::uint8_t, 4> at{};
  ByteWriter(at).le32(update.offset);
  reply(Command::kData, update.status, at);
}

Status commit(Update& update, ByteReader& r) {
  const std::uint32_t size = static_cast<std::uint32_t>(r.le16()) | static_cast<std::uint32_t>(r.u8()) << 16;
  const std::uint32_t crc = r.le32();
  if (update.slot < 0 || !r.ok()) return Status::kEmpty;
  if (update.status != Status::kOk) return update.status;
  return commit_slot(update.slot, size, crc);
}

// True: start an application now.
bool handle(Update& update, const wire::CanFrame& f) {
  if (!f.extended) return false;
  if (f.id == boot::kDataId) store(update, f.payload());
  if (f.id != boot::kRequestId || f.size == 0) return false;
  ByteReader r(f.payload());
  const auto command = static_cast<Command>(r.u8());
  if (command == Command::kHello) hello(update);
  if (command == Command::kSelect) {
    update.selected = r.le32() == id_crc();
    if (update.selected) reply(command, Status::kOk);
  }
  if (!update.selected) return false;
  if (command == Command::kErase) reply(command, erase(update, r.u8()));
  if (command == Command::kCommit) reply(command, commit(update, r));
  return command == Command::kBoot;
}

[[noreturn]] void start(int slot) {
  const std::uint32_t vectors = flash_map::kSlots[slot];
  const auto* table = reinterpret_cast<const std::uint32_t*>(vectors);
  asm volatile("cpsid i" ::: "memory");
  core_reg::kVtor.write(vectors);
  asm volatile("msr msp, %0\n bx %1" ::"r"(table[0]), "r"(table[1]));
  __builtin_unreachable();
}

void start_newest() {
  const int slot = choose_slot();
  if (slot < 0) return;
  if (!inspect_slot(slot).confirmed && !note_start(slot)) return;
  start_watchdog();  // a new application that hangs comes back here
  core_reg::reset_peripherals();
  start(slot);
}

}  // namespace
}  // namespace triskin::board

int main() {
  using namespace triskin::board;
  start_clocks();
  start_microseconds();
  can.open();
  Update update;
  const std::uint64_t window_end = microseconds() + triskin::boot::kWindow_us;
  for (;;) {
    while (const auto frame = can.receive()) {
      if (handle(update, *frame)) start_newest();
    }
    if (!update.stay && microseconds() >= window_end) start_newest();
    feed_watchdog();
    asm volatile("cpsid i" ::: "memory");
    if (!can.frame_waits()) {
      wake_at(update.stay ? microseconds() + kLook_us : window_end);
      asm volatile("dsb\n wfi" ::: "memory");
    }
    asm volatile("cpsie i\n isb" ::: "memory");
  }
}
