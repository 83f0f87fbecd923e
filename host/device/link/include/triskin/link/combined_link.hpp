// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <memory>
#include <vector>

#include "triskin/link/link.hpp"
#include "triskin/link/node_map.hpp"

namespace triskin::link {

/// Joins several links into one bus, as in `--link can:can0,can:can1`. Node addresses must be unique over all of them.
class CombinedLink final : public Link {
 public:
  /// Takes one link or more, all in real time (not the in-process simulation).
  explicit CombinedLink(std::vector<std::unique_ptr<Link>> links);

  void send(const wire::CanFrame& frame) override;
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override;
  [[nodiscard]] std::uint64_t now_us() const override;
  [[nodiscard]] bool fd() const override;
  [[nodiscard]] std::uint8_t frame_bytes() const override;
  [[nodiscard]] std::uint64_t answer_us() const override;
  [[nodiscard]] std::string name() const override;
  [[nodiscard]] std::string trouble() const override;
  [[nodiscard]] std::unique_ptr<MessageChannel> open_channel(std::uint32_t tx_id, std::uint32_t rx_id) override;
  [[nodiscard]] int wire_of(std::uint8_t node) const override;
  [[nodiscard]] std::uint64_t sample_ns(std::uint8_t node) const override;
  [[nodiscard]] std::uint64_t thrown_away() const override;
  [[nodiscard]] std::vector<Link*> parts() override;
  void reconnect() override;

 private:
  static constexpr int kWiresPerLink = 1024;
  static constexpr std::uint64_t kSlice_us = 500;
  [[nodiscard]] std::optional<wire::CanFrame> receive_from(std::size_t link, std::uint64_t wait_us);

  std::vector<std::unique_ptr<Link>> links_;
  NodeMap nodes_;
  std::size_t next_ = 0;  // The next wait uses this link.
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace triskin::link
