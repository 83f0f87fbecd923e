// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/link/combined_link.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "triskin/base/error.hpp"

namespace triskin::link {

CombinedLink::CombinedLink(std::vector<std::unique_ptr<Link>> links) : links_(std::move(links)) {}

std::uint64_t CombinedLink::now_us() const {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start_).count());
}

void CombinedLink::send(const wire::CanFrame& frame) {
  const auto target = NodeMap::target_of(frame);
  const auto only = target ? nodes_.wire_of(*target) : std::nullopt;
  nodes_.sent(frame);
  for (std::size_t k = 0; k < links_.size(); ++k) {
    if (!only || *only == static_cast<int>(k)) links_[k]->send(frame);
  }
}

std::optional<wire::CanFrame> CombinedLink::receive_from(std::size_t link, std::uint64_t wait_us) {
  auto frame = links_[link]->receive(links_[link]->now_us() + wait_us);
  if (frame) nodes_.heard(*frame, static_cast<int>(link));
  return frame;
}

std::optional<wire::CanFrame> CombinedLink::receive(std::uint64_t until_us) {
  while (true) {
    for (std::size_t k = 0; k < links_.size(); ++k) {
      if (auto frame = receive_from(k, 0)) return frame;
    }
    const std::uint64_t now = now_us();
    if (now >= until_us) return std::nullopt;
    next_ = (next_ + 1) % links_.size();
    const std::uint64_t slice_us = std::min(kSlice_us, until_us - now);
    const std::uint64_t began_us = now;
    if (auto frame = receive_from(next_, slice_us)) return frame;
    if (now_us() < began_us + slice_us) return std::nullopt;  // A channel of this link has a message.
  }
}

bool CombinedLink::fd() const {
  return std::ranges::all_of(links_, [](const auto& l) { return l->fd(); });
}

std::uint8_t CombinedLink::frame_bytes() const {
  return (*std::ranges::min_element(links_, {}, [](const auto& l) { return l->frame_bytes(); }))->frame_bytes();
}

std::uint64_t CombinedLink::answer_us() const {
  return (*std::ranges::max_element(links_, {}, [](const auto& l) { return l->answer_us(); }))->answer_us();
}

std::string CombinedLink::name() const {
  std::vector<std::string> names;
  for (const auto& l : links_) names.push_back(l->name());
  return fmt::format("{}", fmt::join(names, ","));
}

std::string CombinedLink::trouble() const {
  std::vector<std::string> troubles;
  for (const auto& l : links_) {
    if (std::string one = l->trouble(); !one.empty()) troubles.push_back(std::move(one));
  }
  return fmt::format("{}", fmt::join(troubles, "; "));
}

int CombinedLink::wire_of(std::uint8_t node) const {
  const auto link = nodes_.wire_of(node);
  return link ? *link * kWiresPerLink + links_[static_cast<std::size_t>(*link)]->wire_of(node) : 0;
}

std::unique_ptr<MessageChannel> CombinedLink::open_channel(std::uint32_t tx_id, std::uint32_t rx_id) {
  const auto link = nodes_.wire_of(static_cast<std::uint8_t>(rx_id));
  return link ? links_[static_cast<std::size_t>(*link)]->open_channel(tx_id, rx_id) : nullptr;
}

std::uint64_t CombinedLink::sample_ns(std::uint8_t node) const {
  const auto link = nodes_.wire_of(node);
  return link ? links_[static_cast<std::size_t>(*link)]->sample_ns(node) : 0;
}

std::uint64_t CombinedLink::thrown_away() const {
  std::uint64_t frames = 0;
  for (const auto& l : links_) frames += l->thrown_away();
  return frames;
}

std::vector<Link*> CombinedLink::parts() {
  std::vector<Link*> parts;
  for (const auto& l : links_) parts.push_back(l.get());
  return parts;
}

void CombinedLink::reconnect() {
  for (auto& l : links_) l->reconnect();
}

}  // namespace triskin::link
