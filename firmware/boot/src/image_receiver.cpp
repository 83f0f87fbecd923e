// SPDX-License-Identifier: Apache-2.0
#include "triskin/boot/image_receiver.hpp"

#include <algorithm>
#include <cstring>

namespace triskin::boot {

using wire::update::Command;
using wire::update::kUnitBytes;
using wire::update::Order;

Status acceptable(const wire::update::Offer& offer, int slot, std::uint32_t running_version) {
  if (offer.slot != slot || offer.hardware_crc != crc32(wire::kPartNumber)) return Status::kWrongTarget;
  if (offer.size_bytes < layout::kLabelOffset + layout::kLabelBytes ||
      offer.size_bytes > layout::kMaxFirmwareImageBytes || offer.size_bytes % kUnitBytes != 0)
    return Status::kOutOfRange;
  if (offer.firmware_version < running_version && !offer.may_be_older) return Status::kOlder;
  return Status::kOk;
}

wire::update::State ImageReceiver::state() const {
  std::uint32_t count = missing_;
  if (phase_ == Phase::kErasing)
    count = (offer_.size_bytes - 1) / static_cast<std::uint32_t>(slots_.page_bytes()) + 2 - work_at_;
  return {phase_, status_, session_, static_cast<std::uint16_t>(count)};
}

bool ImageReceiver::handle(const wire::CanFrame& frame, std::uint64_t now_us) {
  if (wire::update::is_data(frame)) {
    if (session_ != 0) until_us_ = now_us + wire::update::kPatience_us;
    handle_data(frame);
    return true;
  }
  if (!frame.extended || frame.id != wire::update::kCommandId) return false;
  const auto order = wire::update::decode_order(frame);
  if (!order) return true;
  fd_ = frame.fd;
  handle_order(*order, ByteReader(order->arguments).le32() == id_crc_);
  if (order->session == session_) until_us_ = now_us + wire::update::kPatience_us;
  return true;
}

void ImageReceiver::handle_data(const wire::CanFrame& frame) {
  const std::uint32_t first = wire::update::data_unit(frame.id);
  if (phase_ != Phase::kReceiving || wire::update::data_slot(frame.id) != free_slot() || frame.size % kUnitBytes != 0 ||
      first + frame.size / kUnitBytes > units())
    return;
  data_ = frame;
  at_ = 0;
}

void ImageReceiver::handle_order(const Order& order, bool to_me) {
  if (const auto offer = parts_.add(order); offer && offer->slot == free_slot()) {
    offered_ = *offer;
    offered_session_ = order.session;
  }
  if (wire::update::is_to_one(order.command) && !to_me) return;
  if (order.command == Command::kAsk) who_due_ = image_due_ = state_due_ = true;
  if (order.command == Command::kJoin) join(order);
  if (order.session == session_ && session_ != 0) start(order.command);
}

// A board that already takes part stays with its session; another host sees that in the answer.
void ImageReceiver::join(const Order& order) {
  state_due_ = true;
  const bool under_way = phase_ != Phase::kIdle && phase_ != Phase::kRefused;
  if (order.session == 0 || under_way) return;
  session_ = order.session;
  offer_ = offered_;
  if (offered_session_ != order.session) return enter(Phase::kRefused, Status::kEmpty);
  if (!slots_.peek(self_.running_slot).confirmed) return enter(Phase::kRefused, Status::kUnproven);
  Status s = acceptable(offer_, free_slot(), self_.firmware_version);
  if (s == Status::kOk && offer_.size_bytes > slots_.records(free_slot())) s = Status::kNoSpace;
  enter(s == Status::kOk ? Phase::kJoined : Phase::kRefused, s);
}

void ImageReceiver::enter(Phase phase, Status status) {
  phase_ = phase;
  status_ = status;
  work_at_ = 0;
  missing_ = 0;
  search_at_ = kNotSearching;
  data_.size = at_ = 0;
}

void ImageReceiver::start(Command command) {
  if (command == Command::kErase && phase_ == Phase::kJoined) enter(Phase::kErasing);
  if (command == Command::kMissing) {
    state_due_ = phase_ != Phase::kReceiving;
    if (phase_ != Phase::kReceiving) return;
    missing_ = 0;
    search_at_ = 0;
  }
  if (command == Command::kCheck && phase_ == Phase::kReceiving) {
    enter(Phase::kChecking);
    image_crc_ = 0;
    record_crc_ = layout::slot_crc_head(slots_.peek(self_.running_slot).sequence + 1, offer_.size_bytes);
  }
  if (command == Command::kActivate && phase_ == Phase::kReady) enter(Phase::kActivated);
  if (command == Command::kEnd && phase_ != Phase::kActivated) {
    session_ = offered_session_ = 0;
    enter(Phase::kIdle);
  }
}

std::uint64_t ImageReceiver::next_event_us(std::uint64_t now_us) const {
  if (full() || phase_ == Phase::kErasing || phase_ == Phase::kChecking) return now_us;
  if (phase_ == Phase::kActivated) return restart_at_us_ == UINT64_MAX ? now_us : restart_at_us_;
  if (who_due_ || image_due_ || state_due_ || search_at_ != kNotSearching)
    return no_room_ ? now_us + kLookForRoom_us : now_us;
  return session_ == 0 ? UINT64_MAX : until_us_;
}

void ImageReceiver::step(fw::CanPort& port, std::uint64_t now_us) {
  if (full()) program_next_unit();
  if (session_ != 0 && phase_ != Phase::kActivated && now_us >= until_us_) {
    session_ = 0;
    enter(Phase::kIdle);
  }
  answer(port);
  if (phase_ == Phase::kErasing) erase_next_page();
  if (phase_ == Phase::kChecking) check_next_piece();
  if (phase_ == Phase::kActivated) commit(now_us);
}

// The page of records is erased first, so that the slot is invalid from then on.
void ImageReceiver::erase_next_page() {
  const std::size_t page = slots_.page_bytes();
  const std::size_t at = work_at_ == 0 ? slots_.records(free_slot()) : (work_at_ - 1) * page;
  if (!slots_.erase_page(free_slot(), at)) return enter(Phase::kRefused, Status::kFlashFailed);
  if (work_at_++ * page >= offer_.size_bytes) enter(Phase::kReceiving);
}

bool ImageReceiver::erased(std::uint32_t unit) const {
  std::uint64_t value = 0;
  std::memcpy(&value, slots_.bytes(free_slot()).data() + std::size_t{unit} * kUnitBytes, sizeof value);
  return value == UINT64_MAX;
}

// A unit that is already there was sent twice.
void ImageReceiver::program_next_unit() {
  const std::uint32_t unit = wire::update::data_unit(data_.id) + static_cast<std::uint32_t>(at_ / kUnitBytes);
  const Bytes bytes = Bytes(data_.data).subspan(at_, kUnitBytes);
  at_ += kUnitBytes;
  const bool blank = std::ranges::all_of(bytes, [](std::uint8_t v) { return v == 0xFF; });
  if (blank || !erased(unit)) return;
  const Status s = slots_.program(free_slot(), unit * static_cast<std::uint32_t>(kUnitBytes), bytes);
  if (s != Status::kOk) enter(Phase::kRefused, s);
}

void ImageReceiver::check_next_piece() {
  const std::uint32_t left = offer_.size_bytes - work_at_;
  const Bytes piece = slots_.bytes(free_slot()).subspan(work_at_, std::min<std::size_t>(left, kCheckedAtOnce));
  image_crc_ = crc32(piece, image_crc_);
  record_crc_ = crc32(piece, record_crc_);
  work_at_ += static_cast<std::uint32_t>(piece.size());
  if (work_at_ < offer_.size_bytes) return;
  const Status s = image_crc_ != offer_.image_crc ? Status::kBadCrc : check_label();
  enter(s == Status::kOk ? Phase::kReady : Phase::kRefused, s);
}

// The host's description of the image must agree with the image's label.
Status ImageReceiver::check_label() const {
  const Status s = slots_.check(free_slot(), offer_.size_bytes, self_.firmware_version, offer_.may_be_older);
  if (s != Status::kOk) return s;
  const auto label = layout::decode_label(slots_.bytes(free_slot()).first(offer_.size_bytes));
  return label->firmware_version == offer_.firmware_version ? Status::kOk : Status::kBadVersion;
}

void ImageReceiver::commit(std::uint64_t now_us) {
  if (restart_at_us_ == UINT64_MAX) {
    const std::uint32_t sequence = slots_.peek(self_.running_slot).sequence + 1;
    if (!slots_.write_record(free_slot(), sequence, offer_.size_bytes, record_crc_))
      return enter(Phase::kRefused, Status::kFlashFailed);
    restart_at_us_ = now_us + kRestart_us;
  }
  if (now_us < restart_at_us_) return;
  restart_at_us_ = UINT64_MAX;
  session_ = 0;
  enter(Phase::kIdle);
  restart_.restart();
}

bool ImageReceiver::send(fw::CanPort& port, Bytes payload) {
  wire::CanFrame f;
  f.id = answer_id_;
  f.extended = true;
  f.fd = f.bit_rate_switch = payload.size() > 8;
  f.size = static_cast<std::uint8_t>(payload.size());
  std::ranges::copy(payload, f.data.begin());
  no_room_ = !port.send(f);
  return !no_room_;
}

void ImageReceiver::answer(fw::CanPort& port) {
  if (who_due_) {
    const wire::update::Who who{.running_slot = static_cast<std::uint8_t>(self_.running_slot),
                                .confirmed = slots_.peek(self_.running_slot).confirmed,
                                .firmware_version = self_.firmware_version};
    if (!send(port, wire::update::encode_who(who))) return;
    who_due_ = false;
  }
  if (image_due_) {
    const SlotState running = slots_.peek(self_.running_slot);
    if (!send(port, wire::update::encode_image({running.record_crc, running.sequence}))) return;
    image_due_ = false;
  }
  if (search_at_ != kNotSearching && !search(port)) return;
  if (state_due_ && send(port, wire::update::encode_state(state()))) state_due_ = false;
}

// Sends the next answer with missing units. Returns true if there are no more, and the state is sent.
bool ImageReceiver::search(fw::CanPort& port) {
  const std::uint32_t stop = std::min(units(), search_at_ + kSearchedAtOnce);
  while (search_at_ < stop && !erased(search_at_)) ++search_at_;
  if (search_at_ == units()) {
    search_at_ = kNotSearching;
    state_due_ = true;
    return true;
  }
  if (search_at_ == stop) return false;
  const std::size_t bytes = fd_ && port.fd() ? port.frame_bytes() : 8;
  wire::update::MissingPart part(static_cast<std::uint16_t>(search_at_), bytes);
  std::uint32_t at = search_at_ + 1;
  std::uint16_t found = 1;
  for (; at < stop; ++at) {
    if (!erased(at)) continue;
    if (!part.add(static_cast<std::uint16_t>(at))) break;
    ++found;
  }
  if (!send(port, Bytes(part.encode()).first(bytes))) return false;
  missing_ = static_cast<std::uint16_t>(missing_ + found);
  search_at_ = at;
  return false;
}

}  // namespace triskin::boot
