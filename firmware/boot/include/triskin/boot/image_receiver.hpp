// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/boot/slot_store.hpp"
#include "triskin/layout/image_label.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/identity.hpp"
#include "triskin/wire/image_update.hpp"

namespace triskin::boot {

/// Returns why an image is refused, or kOk. `offer` is for slot `slot`; `running_version` is that of the running
/// firmware. Errors: kOutOfRange (size), kWrongTarget (slot, other hardware), kOlder.
[[nodiscard]] Status acceptable(const wire::update::Offer& offer, int slot, std::uint32_t running_version);

/// As the controller's part in a broadcast update (docs/protocol.md, "One image to all"), the receiver writes an image
/// into the slot that the application does not run from, and commits it when it is correct. The flash itself shows what
/// is missing: a unit that reads as erased has not arrived. So RAM holds only the position, and a host does not send
/// units that are erased anyway.
class ImageReceiver final : public fw::ImageUpdate {
 public:
  /// The receiver needs these facts about its controller.
  struct Self {
    wire::UniqueId unique_id;
    int running_slot;                ///< Valid values are 0 and 1.
    std::uint32_t firmware_version;  ///< The running firmware has this version.
  };
  /// `slots` and `restart` must outlive the receiver.
  ImageReceiver(SlotStore& slots, fw::Restart& restart, const Self& self)
      : slots_(slots),
        restart_(restart),
        self_(self),
        id_crc_(crc32(self.unique_id)),
        answer_id_(wire::claim_id(self.unique_id)) {}

  bool handle(const wire::CanFrame& frame, std::uint64_t now_us) override;
  [[nodiscard]] bool full() const override { return at_ < data_.size; }
  void step(fw::CanPort& port, std::uint64_t now_us) override;
  [[nodiscard]] std::uint64_t next_event_us(std::uint64_t now_us) const override;
  /// Returns the progress of the update.
  [[nodiscard]] wire::update::State state() const;

 private:
  using Phase = wire::update::Phase;
  static constexpr std::size_t kCheckedAtOnce = 512;     ///< Each step checks this many bytes.
  static constexpr std::uint32_t kSearchedAtOnce = 512;  ///< Each step searches this many units.
  static constexpr std::uint64_t kRestart_us = 5'000;    ///< Answers can still be sent during this time.
  static constexpr std::uint64_t kLookForRoom_us = 200;
  static constexpr std::uint32_t kNotSearching = ~0U;

  [[nodiscard]] int free_slot() const { return 1 - self_.running_slot; }
  [[nodiscard]] std::uint32_t units() const {
    return offer_.size_bytes / static_cast<std::uint32_t>(wire::update::kUnitBytes);
  }
  void handle_data(const wire::CanFrame& frame);
  void handle_order(const wire::update::Order& order, bool to_me);
  void join(const wire::update::Order& order);
  void start(wire::update::Command command);
  void enter(Phase phase, Status status = Status::kOk);
  void erase_next_page();
  void program_next_unit();
  [[nodiscard]] bool erased(std::uint32_t unit) const;
  void check_next_piece();
  [[nodiscard]] Status check_label() const;
  void commit(std::uint64_t now_us);
  void answer(fw::CanPort& port);
  bool send(fw::CanPort& port, Bytes payload);
  bool search(fw::CanPort& port);

  SlotStore& slots_;
  fw::Restart& restart_;
  Self self_;
  std::uint32_t id_crc_, answer_id_;
  wire::update::OfferParts parts_;
  // The first is the last offer for the free slot, the second the one that the board has joined.
  wire::update::Offer offered_, offer_;
  std::uint16_t offered_session_ = 0, session_ = 0;
  Phase phase_ = Phase::kIdle;
  Status status_ = Status::kOk;
  std::uint64_t until_us_ = 0;  // The session ends at this time unless a frame arrives.
  std::uint64_t restart_at_us_ = UINT64_MAX;
  std::uint32_t work_at_ = 0;  // This many pages were erased, or bytes checked.
  std::uint32_t image_crc_ = 0, record_crc_ = 0;
  wire::CanFrame data_;  // Its units from at_ on still wait.
  std::uint8_t at_ = 0;
  bool who_due_ = false, image_due_ = false, state_due_ = false;
  std::uint32_t search_at_ = kNotSearching;  // The search continues with this unit.
  std::uint16_t missing_ = 0;
  bool fd_ = false;       // FD frames shorten the answers on a bus that carries them.
  bool no_room_ = false;  // An answer waits for the port.
};

}  // namespace triskin::boot
