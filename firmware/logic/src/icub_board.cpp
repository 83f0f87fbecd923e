// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/icub_board.hpp"

#include <algorithm>

#include "triskin/wire/icub_commands.hpp"

namespace triskin::fw {

using namespace wire;

IcubBoard::Reaction IcubBoard::handle(const CanFrame& frame, std::uint8_t node_address, std::uint32_t version) {
  Reaction reaction;
  if (frame.extended || frame.fd || frame.size < 1 || node_address > icub::kMaxBoard) return reaction;
  const auto destination = static_cast<std::uint8_t>(frame.id & 0xF),
             source = static_cast<std::uint8_t>(frame.id >> 4 & 0xF);
  const std::uint32_t message_class = frame.id & icub::kClassMask;
  if (message_class == icub::kPollingClass && destination == node_address) poll(frame, reaction);
  const bool addressed = destination == node_address || destination == icub::kEverybody;
  if (message_class == icub::kLoaderClass && addressed && frame.size == 1 && frame.data[0] == icub::kDiscover) {
    CanFrame& f = reaction.reply.emplace();
    f.id = icub::can_id(icub::kLoaderClass, node_address, source);
    f.size = 5;
    f.data[0] = icub::kDiscover;
    f.data[1] = icub::kBoardType;
    for (std::size_t k = 0; k < 3; ++k) f.data[2 + k] = static_cast<std::uint8_t>(version >> (24 - 8 * k));
  }
  return reaction;
}

void IcubBoard::poll(const CanFrame& frame, Reaction& reaction) {
  switch (frame.data[0]) {
    case icub::kSetTransmission:
      if (frame.size >= 2) reaction.transmit = frame.data[1] == 0;
      return;
    case icub::kSetupObsolete:
      reaction.transmit = true;
      return;
    case icub::kSetBoard:
      if (frame.size < 4) return;
      period_us_ = frame.data[2] * 1000ULL;
      resting_ = frame.data[3];
      return;
    case icub::kSetTriangles:
      set_triangles(frame);
      return;
    default:
      return;
  }
}

void IcubBoard::set_triangles(const CanFrame& frame) {
  const std::size_t first = frame.data[1], last = frame.data[2];
  if (frame.size < 7 || last >= shift_.size() || first > last) return;
  for (std::size_t k = first; k <= last; ++k) {
    shift_[k] = std::min<std::uint8_t>(frame.data[3], 15);
    const auto bit = static_cast<std::uint16_t>(1U << k);
    enabled_ = static_cast<std::uint16_t>((frame.data[4] & 1) != 0 ? enabled_ | bit : enabled_ & ~bit);
  }
}

std::uint8_t IcubBoard::value(std::size_t triangle, int change) const {
  return static_cast<std::uint8_t>(std::clamp(resting_ + change / (1 << shift_[triangle]), 0, 255));
}

bool IcubBoard::due(std::uint64_t now_us) {
  if (now_us < next_us_) return false;
  next_us_ = std::max(next_us_ + period_us_, now_us);
  return true;
}

}  // namespace triskin::fw
