// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/icub/icub_board.hpp"

#include <algorithm>
#include <string_view>

namespace triskin::fw {

using namespace wire;
using icub::SkinType;

namespace {

std::uint8_t source_of(const CanFrame& f) {
  return static_cast<std::uint8_t>(f.id >> 4 & 0xF);
}
bool to_everybody(const CanFrame& f) {
  return (f.id & 0xF) == icub::kEverybody;
}

}  // namespace

IcubBoard::Reaction IcubBoard::handle(const CanFrame& frame, const Self& self) {
  Reaction reaction;
  if (frame.extended || frame.fd || frame.size < 1 || !icub::is_board(self.node_address)) return reaction;
  if (!to_everybody(frame) && (frame.id & 0xF) != self.node_address) return reaction;
  const std::uint32_t message_class = frame.id & icub::kClassMask;
  if (message_class == icub::kPollingClass) poll(frame, self, reaction);
  if (message_class == icub::kLoaderClass) load(frame, self, reaction);
  return reaction;
}

void IcubBoard::poll(const CanFrame& frame, const Self& self, Reaction& reaction) {
  switch (frame.data[0] & icub::kCommandMask) {
    case icub::kSetTransmission:
      if (frame.size >= 2) reaction.transmit = frame.data[1] == 0;
      return;
    case icub::kGetVersion:
      return answer_version(frame, self);
    case icub::kSetAddress:
      return set_address(frame, self, 0, reaction);
    case icub::kSetupObsolete:
      set_defaults();
      period_ms_ = kObsoletePeriod_ms;
      reaction.calibrate = true;
      reaction.transmit = true;
      return;
    case icub::kSetBoard:
      return set_board(frame);
    case icub::kSetTriangles:
      return set_triangles(frame, reaction);
    default:
      return refuse(frame, icub::State::kCommandRefused);
  }
}

void IcubBoard::load(const CanFrame& frame, const Self& self, Reaction& reaction) {
  switch (frame.data[0]) {
    case icub::kRestart:
      reaction.restart = true;
      return;
    case icub::kGetDescription:
      return answer_description(frame, self);
    case icub::kGetTimeOfLife:
      return answer_time(frame, self);
    case icub::kSetAddress: {
      const bool masked = frame.size >= 4;
      return set_address(frame, self, static_cast<std::uint16_t>(masked ? frame.data[2] | frame.data[3] << 8 : 0),
                         reaction);
    }
    case icub::kDiscover: {
      const auto part = [&](int shift) { return static_cast<std::uint8_t>(self.version >> shift); };
      return answer(frame, self, {icub::kDiscover, icub::kBoardType, part(24), part(16), part(8)});
    }
    default:
      return refuse(frame, icub::State::kCommandRefused);
  }
}

// The shifts stay, as on an MTB4 board.
void IcubBoard::set_defaults() {
  skin_type_ = SkinType::kCompensated;
  no_load_ = kNoLoad;
  enabled_ = 0xFFFF;
}

void IcubBoard::set_board(const CanFrame& frame) {
  if (frame.size < 4) return;
  const auto type = static_cast<SkinType>(frame.data[1]);
  const bool known = type == SkinType::kCompensated || type == SkinType::kPalm || type == SkinType::kRaw;
  skin_type_ = known ? type : SkinType::kUncompensated;
  period_ms_ = frame.data[2];
  no_load_ = frame.data[3];
  enabled_ = 0;  // Triangles stay disabled until the host configures them.
  next_us_ = 0;
}

void IcubBoard::set_triangles(const CanFrame& frame, Reaction& reaction) {
  const std::size_t first = frame.data[1], last = frame.data[2];
  if (frame.size < 7 || last >= shift_.size() || first > last) return;
  for (std::size_t k = first; k <= last; ++k) {
    shift_[k] = std::min<std::uint8_t>(frame.data[3], 15);
    const auto bit = static_cast<std::uint16_t>(1U << k);
    enabled_ = static_cast<std::uint16_t>((frame.data[4] & 1) != 0 ? enabled_ | bit : enabled_ & ~bit);
  }
  if ((frame.data[5] | frame.data[6] << 8) != icub::kUsualOffset) refuse(frame, icub::State::kOffsetRefused);
  reaction.transmit = false;
  reaction.calibrate = true;
}

// FF selects any address that is not excluded, and a different one for each board as far as 14 addresses allow.
void IcubBoard::set_address(const CanFrame& frame, const Self& self, std::uint16_t excluded, Reaction& reaction) {
  std::uint8_t address = frame.size >= 2 ? frame.data[1] : 0;
  if (address == 0xFF) {
    const auto seed = static_cast<std::uint32_t>(crc32(self.unique_id) + self.now_us);
    for (std::uint32_t k = 0; k < icub::kMaxBoard && !icub::is_board(address); ++k) {
      const auto candidate = static_cast<std::uint8_t>(1 + (seed + k) % icub::kMaxBoard);
      if ((excluded >> candidate & 1) == 0) address = candidate;
    }
  }
  if (to_everybody(frame) || !icub::is_board(address)) return refuse(frame, icub::State::kAddressRefused);
  reaction.node_address = address;
}

void IcubBoard::refuse(const CanFrame& frame, std::uint8_t flag) {
  flags_ |= flag;
  last_refused_ = frame.data[0];
  if (refused_ < 0xFF) ++refused_;
}

void IcubBoard::answer(const CanFrame& asked, const Self& self, std::initializer_list<std::uint8_t> bytes) {
  if (reply() == nullptr) reply_at_ = reply_count_ = 0;
  if (reply_count_ == replies_.size()) return;
  CanFrame& f = replies_[reply_count_++];
  f = {};
  f.id = icub::can_id(asked.id & icub::kClassMask, self.node_address, source_of(asked));
  f.size = static_cast<std::uint8_t>(bytes.size());
  std::ranges::copy(bytes, f.data.begin());
}

void IcubBoard::answer_version(const CanFrame& asked, const Self& self) {
  const std::uint8_t major = asked.size >= 3 ? asked.data[1] : 0, minor = asked.size >= 3 ? asked.data[2] : 0;
  const bool fits = major == icub::kProtocolMajor && minor <= icub::kProtocolMinor;
  const auto part = [&](int shift) { return static_cast<std::uint8_t>(self.version >> shift); };
  answer(asked, self,
         {icub::kGetVersion, icub::kBoardType, part(24), part(16), part(8), icub::kProtocolMajor, icub::kProtocolMinor,
          static_cast<std::uint8_t>(fits ? 1 : 0)});
}

// The description is "Triskin " and the unique id in hexadecimal, exactly the 32 characters that fit.
void IcubBoard::answer_description(const CanFrame& asked, const Self& self) {
  constexpr std::string_view kName = "Triskin ", kDigits = "0123456789ABCDEF";
  static_assert(kName.size() + 2 * std::tuple_size_v<UniqueId> == 32);
  const auto character = [&](std::size_t at) {
    if (at < kName.size()) return static_cast<std::uint8_t>(kName[at]);
    const std::uint8_t byte = self.unique_id[(at - kName.size()) / 2];
    return static_cast<std::uint8_t>(kDigits[at % 2 == 0 ? byte >> 4 : byte & 0xF]);
  };
  for (std::uint8_t k = 0; k < 8; ++k) {
    const std::size_t at = 4U * k;
    answer(asked, self,
           {icub::kGetDescription, k, character(at), character(at + 1), character(at + 2), character(at + 3)});
  }
}

void IcubBoard::answer_time(const CanFrame& asked, const Self& self) {
  const auto byte = [&](int k) { return static_cast<std::uint8_t>(self.now_us >> (8 * k)); };
  answer(asked, self, {icub::kGetTimeOfLife, byte(0), byte(1), byte(2), byte(3), byte(4), byte(5), byte(6)});
}

bool IcubBoard::due(std::uint64_t now_us) {
  if (now_us < next_us_) return false;
  next_us_ = std::max(next_us_ + std::uint64_t{period_ms_} * 1000, now_us);
  return true;
}

icub::State IcubBoard::state(std::uint8_t node_address) const {
  icub::State s;
  s.flags = static_cast<std::uint8_t>(flags_ | (icub::is_board(node_address) ? 0 : icub::State::kNoBoard));
  s.last_refused = last_refused_;
  s.refused = refused_;
  s.skin_type = static_cast<std::uint8_t>(skin_type_);
  s.period_ms = period_ms_;
  s.no_load = no_load_;
  s.shift = shift_[0];
  s.enabled = enabled_;
  return s;
}

}  // namespace triskin::fw
