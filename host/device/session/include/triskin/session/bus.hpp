// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "triskin/base/bytes.hpp"
#include "triskin/host/error.hpp"
#include "triskin/link/link.hpp"
#include "triskin/wire/iso_tp.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::device {

/// A controller refused a request: which one, what was asked, and why.
class Refused : public DeviceError {
 public:
  Refused(const std::string& what, std::uint8_t code) : DeviceError(what), code_(code) {}
  [[nodiscard]] std::uint8_t code() const { return code_; }

 private:
  std::uint8_t code_;
};

/// No answer, after all repeats.
class NoAnswer : public Unreachable {
 public:
  using Unreachable::Unreachable;
};

/// Requests and answers (ISO 14229-1 over ISO 15765-2) with many controllers on one link. Everything that waits throws
/// Cancelled when the process was asked to end (interrupt_request()). Not thread-safe.
class Bus {
 public:
  using Message = std::vector<std::uint8_t>;
  using OnFrame = std::function<void(const wire::CanFrame&)>;

  explicit Bus(Link& link) : link_(link) {}
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  enum class Repeat {
    kNever,  ///< a lost answer must be noticed by the caller: the request may have taken effect
    kSafe,   ///< asking again has no other effect than asking once
  };
  /// Answer without its service byte. Waits on while the controller says "response pending". Throws Refused, NoAnswer.
  Message request(std::uint8_t node, Bytes request, Repeat repeat);

  /// Everybody's unique id and node address, sorted by unique id. Also while addresses are not unique.
  [[nodiscard]] std::vector<wire::NodeClaim> discover();
  /// Gives a controller another address. It starts anew.
  void assign(const wire::UniqueId& id, std::uint8_t node_address);

  /// Frames that are no answers: the data stream.
  void on_stream(OnFrame handler) { on_stream_ = std::move(handler); }
  /// Receives until `until_us` of the link's clock; stream frames go to the handler.
  void listen(std::uint64_t until_us);
  /// One frame of any kind until `until_us`; may return without one before.
  std::optional<wire::CanFrame> receive(std::uint64_t until_us);
  /// Revives a link that was cut. Throws DeviceError when it still is.
  void reconnect();

  /// While one of these lives, requests to end are put off: what it guards is short and must not be left half done.
  class Uninterrupted {
   public:
    explicit Uninterrupted(Bus& bus) : bus_(bus) { ++bus_.held_; }
    ~Uninterrupted() { --bus_.held_; }
    Uninterrupted(const Uninterrupted&) = delete;
    Uninterrupted& operator=(const Uninterrupted&) = delete;

   private:
    Bus& bus_;
  };

  [[nodiscard]] Link& link() { return link_; }
  [[nodiscard]] std::string name() const { return link_.name(); }
  [[nodiscard]] std::uint64_t now_us() const { return link_.now_us(); }

 private:
  static constexpr int kRepeats = 5;
  static constexpr std::uint64_t kClaimWindow_us = 60'000;
  static constexpr std::uint64_t kInterruptPoll_us = 200'000;  // longest time between two checks for a request to end

  wire::IsoTp& connection(std::uint8_t node);
  /// Sends once and waits; empty: no answer in time.
  Message exchange(std::uint8_t node, Bytes request);
  void drain(std::uint8_t node);
  bool start(std::uint8_t node, Bytes request);
  /// The next message of this node; empty: none until the deadline, or it was given up.
  Message next_message(std::uint8_t node, std::uint64_t deadline_us);
  Message next_of_channel(MessageChannel& channel, std::uint64_t deadline_us);
  void transmit(wire::IsoTp& connection);
  wire::IsoTp::Event receive_for(wire::IsoTp& connection, std::uint64_t deadline_us);

  Link& link_;
  OnFrame on_stream_;
  std::map<std::uint8_t, std::unique_ptr<wire::IsoTp>> connections_;
  std::map<std::uint8_t, std::unique_ptr<MessageChannel>> channels_;  // null: none to be had
  int held_ = 0;
};

}  // namespace triskin::device
