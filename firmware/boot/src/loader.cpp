// SPDX-License-Identifier: Apache-2.0
#include "triskin/boot/loader.hpp"

namespace triskin::boot {

using wire::loader::Command;
using wire::loader::kDataId;
using wire::loader::kFramesPerReply;
using wire::loader::kProtocol;
using wire::loader::kReplyId;
using wire::loader::kRequestId;

void Loader::reply(Command command, Status status, Bytes more) {
  wire::CanFrame f;
  f.id = kReplyId;
  f.extended = true;
  ByteWriter w(std::span(f.data).first(8));
  w.u8(static_cast<std::uint8_t>(command));
  w.u8(static_cast<std::uint8_t>(status));
  w.bytes(more);
  f.size = static_cast<std::uint8_t>(w.size());
  (void)can_.send(f);
}

void Loader::hello() {
  const auto bits = [this](int slot) {
    const SlotState s = slots_.inspect(slot);
    return (s.valid ? 1 : 0) | (s.confirmed ? 2 : 0) | (s.startable() ? 4 : 0);
  };
  std::array<std::uint8_t, 5> more{};
  ByteWriter w(more);
  w.u8(static_cast<std::uint8_t>(kProtocol << 6 | bits(1) << 3 | bits(0)));
  w.le32(id_crc_);
  reply(Command::kHello, Status::kOk, w.written());
}

Status Loader::erase(int slot) {
  if (slot < 0 || slot > 1) return Status::kOutOfRange;
  if (slot == slots_.choose()) return Status::kWrongTarget;
  slot_ = slot;
  offset_ = 0;
  status_ = slots_.erase(slot);
  return status_;
}

void Loader::store(Bytes data) {
  if (!selected_ || slot_ < 0 || data.size() != 8) return;
  if (status_ == Status::kOk) status_ = slots_.program(slot_, offset_, data);
  offset_ += 8;
  if (offset_ % (8 * kFramesPerReply) != 0) return;
  std::array<std::uint8_t, 4> at{};
  ByteWriter(at).le32(offset_);
  reply(Command::kData, status_, at);
}

Status Loader::commit(ByteReader& r) {
  const std::uint32_t size = static_cast<std::uint32_t>(r.le16()) | static_cast<std::uint32_t>(r.u8()) << 16;
  const std::uint32_t crc = r.le32();
  if (slot_ < 0 || !r.ok()) return Status::kEmpty;
  return status_ == Status::kOk ? slots_.commit(slot_, size, crc) : status_;
}

bool Loader::handle(const wire::CanFrame& f, std::uint64_t now_us) {
  if (!f.extended || (f.id != kDataId && f.id != kRequestId)) return false;
  stays_until_us_ = now_us + kPatience_us;  // An unplugged host must not keep the application from starting.
  if (f.id == kDataId) store(f.payload());
  if (f.id != kRequestId || f.size == 0) return false;
  ByteReader r(f.payload());
  const auto known = wire::loader::to_command(r.u8());
  if (!known) return false;
  const Command command = *known;
  if (command == Command::kHello) hello();
  if (command == Command::kSelect) {
    selected_ = r.le32() == id_crc_ && r.ok();
    if (selected_) reply(command, Status::kOk);
  }
  if (!selected_) return false;
  if (command == Command::kErase) reply(command, erase(r.u8()));
  if (command == Command::kCommit) reply(command, commit(r));
  return command == Command::kBoot;
}

}  // namespace triskin::boot
