// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/boot/slot_store.hpp"
#include "triskin/wire/loader_protocol.hpp"
#include "triskin/wire/unique_id.hpp"

namespace triskin::boot {

/// The loader's side of an update over CAN (wire/loader_protocol.hpp) is implemented here. The board itself starts
/// applications.
class Loader {
 public:
  /// `slots` and `can` must outlive the loader; hosts select it by the CRC of `unique_id`.
  Loader(SlotStore& slots, fw::CanPort& can, const wire::UniqueId& unique_id)
      : slots_(slots), can_(can), id_crc_(crc32(unique_id)) {}
  static constexpr std::uint64_t kPatience_us = 5'000'000;

  /// Handles a frame. Returns true if the newest slot must be started now.
  bool handle(const wire::CanFrame& frame, std::uint64_t now_us);
  /// Returns until when the loader waits for the next frame of a host that sent hello, in µs of the board's clock; 0
  /// means that there is no host.
  [[nodiscard]] std::uint64_t stays_until_us() const { return stays_until_us_; }

 private:
  void reply(wire::loader::Command command, Status status, Bytes more = {});
  void hello();
  Status erase(int slot);
  void store(Bytes data);
  Status commit(ByteReader& r);

  SlotStore& slots_;
  fw::CanPort& can_;
  std::uint32_t id_crc_;
  std::uint64_t stays_until_us_ = 0;
  bool selected_ = false;
  int slot_ = -1;
  std::uint32_t offset_ = 0;
  Status status_ = Status::kEmpty;
};

}  // namespace triskin::boot
