// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/icub_stream.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/wire/icub_commands.hpp"

namespace triskin::session {
namespace {

using namespace wire;

constexpr std::uint64_t kAnswers_us = 200'000;
constexpr std::uint8_t kPeriod_ms = 50, kRest = 245, kSkinType = 0, kShift = 6;

CanFrame command(std::uint32_t message_class, std::uint8_t board, std::initializer_list<std::uint8_t> bytes) {
  CanFrame f;
  f.id = icub::can_id(message_class, 0, board);
  f.size = static_cast<std::uint8_t>(bytes.size());
  std::ranges::copy(bytes, f.data.begin());
  return f;
}

}  // namespace

IcubStream::IcubStream(Bus& bus, OnTaxels handler) : bus_(bus), handler_(std::move(handler)) {
  bus_.on_stream([this](const CanFrame& f) { handle(f); });
  bus_.link().send(command(icub::kLoaderClass, icub::kEverybody, {icub::kDiscover}));
  bus_.listen(bus_.now_us() + kAnswers_us);
  std::ranges::sort(boards_, {}, &IcubBoardInfo::address);
  if (boards_.empty()) {
    bus_.on_stream({});
    throw DeviceError(bus_.nobody_answers("no skin board with the iCub protocol answers"));
  }
  for (const IcubBoardInfo& b : boards_) {
    poll(b.address, {icub::kSetBoard, kSkinType, kPeriod_ms, kRest});
    poll(b.address, {icub::kSetTriangles, 0, 15, kShift, 1, 0, 0x22});
    poll(b.address, {icub::kSetTransmission, 0});
  }
}

IcubStream::~IcubStream() {
  bus_.on_stream({});
  try {
    for (const IcubBoardInfo& b : boards_) poll(b.address, {icub::kSetTransmission, 1});
  } catch (const Error&) {
    return;  // Without the link the boards cannot be stopped.
  }
}

void IcubStream::poll(std::uint8_t board, std::initializer_list<std::uint8_t> bytes) {
  bus_.link().send(command(icub::kPollingClass, board, bytes));
}

void IcubStream::handle(const CanFrame& f) {
  if (f.extended) return;
  const auto source = static_cast<std::uint8_t>(f.id >> 4 & 0xF);
  if ((f.id & icub::kClassMask) == icub::kLoaderClass && f.size >= 5 && f.data[0] == icub::kDiscover) {
    const bool known = std::ranges::any_of(boards_, [&](const auto& b) { return b.address == source; });
    if (!known && f.data[1] == icub::kBoardType)
      boards_.push_back({source, f.data[1], f.data[2], f.data[3], f.data[4]});
    return;
  }
  if ((f.id & icub::kClassMask) != 0x400 || f.size != 8) return;
  if (f.data[0] == kIcubFirst) {
    lost_ += first_.contains(f.id) ? 1 : 0;
    first_[f.id] = f;
    return;
  }
  const auto first = first_.find(f.id);
  if (first == first_.end()) {
    lost_ += f.data[0] == kIcubSecond ? 1 : 0;
    return;
  }
  const auto taxels = decode_icub(first->second, f);
  first_.erase(first);
  if (!taxels) return;
  ++frames_;
  if (handler_) handler_(*taxels);
}

}  // namespace triskin::session
