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

#include "triskin/base/error.hpp"
#include "triskin/core/bytes.hpp"
#include "triskin/link/link.hpp"
#include "triskin/wire/iso_tp.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::device {

/// A controller refused a request: which one, what was asked, and why.
class Refused : public DeviceError {
 public:
  Refused(const std::string& what, std::uint8_t code) : DeviceError(what), code_(code) {}
  /// Negative response code of ISO 14229-1 (wire::nrc).
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

  /// `link` outlives the bus.
  explicit Bus(Link& link) : link_(link) {}
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  enum class Repeat {
    kNever,  ///< The caller must notice a lost answer, because the request may have taken effect.
    kSafe,   ///< Asking again has no other effect than asking once.
  };
  /// Sends a request (service byte first, 1..4095 bytes) to node address `node` and waits for the answer, also while
  /// the controller answers "response pending", at most a minute. Returns the answer without its service byte. Throws
  /// Refused, NoAnswer (after five attempts with kSafe, one with kNever), Unreachable, DeviceError when the request is
  /// too long.
  Message request(std::uint8_t node, Bytes request, Repeat repeat);

  /// Unique id and node address of every controller on the link, sorted by unique id; also while several share an
  /// address. Takes 0.12 s; on a slow bus as long as claims come, at most 5 s. Throws Unreachable.
  [[nodiscard]] std::vector<wire::NodeClaim> discover();
  /// Gives the controller with unique id `id` the node address 1..126. It restarts and does not confirm: listen for
  /// 20 ms, then discover. Throws Unreachable.
  void assign(const wire::UniqueId& id, std::uint8_t node_address);

  /// Sets the handler of frames that are no answers, that is of the data stream; empty: they are dropped. It is called
  /// inside the waiting calls of this class.
  void on_stream(OnFrame handler) { on_stream_ = std::move(handler); }
  /// Waits until `until_us` of the link's clock; stream frames go to the handler. Throws Unreachable.
  void listen(std::uint64_t until_us);
  /// Hands the frames that have come already to the handler, for at most 50 ms; does not wait. Throws Unreachable.
  void poll();
  /// Waits for one frame of any kind until `until_us`; may return empty before, at the latest after 0.2 s. Throws
  /// Unreachable.
  std::optional<wire::CanFrame> receive(std::uint64_t until_us);
  /// Restores a link that was cut and forgets all connections. Throws DeviceError when it stays cut.
  void reconnect();

  /// While one of these lives, a request to end the process (interrupt_request()) does not throw Cancelled. Guards
  /// short work that must not stop half done. Guards may be nested.
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
  /// Link::name.
  [[nodiscard]] std::string name() const { return link_.name(); }
  /// Message for a bus without an answer: its name, `who` does not answer, and what to look at.
  [[nodiscard]] std::string nobody_answers(const std::string& who = "no controller answers") const {
    return name() + ": " + who + "; " + link_.when_silent();
  }
  /// Link::now_us: time of the link, µs.
  [[nodiscard]] std::uint64_t now_us() const { return link_.now_us(); }

 private:
  static constexpr int kRepeats = 5;
  static constexpr std::uint64_t kClaimWindow_us = 60'000;
  // A claim has two frames of at most 160 bits: 16 ms between two whole claims at 20 kbit/s. 126 of them take 2 s
  // there.
  static constexpr std::uint64_t kClaimGap_us = 20'000, kLongestClaims_us = 2'500'000;
  static constexpr std::uint64_t kLongestDrain_us = 50'000, kLongestPending_us = 60'000'000;
  static constexpr std::uint64_t kInterruptPoll_us = 200'000;  // Longest time between two checks for a request to end.

  /// Throws Cancelled when the process was asked to end and nothing holds it.
  void end_on_request() const;
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
  std::map<std::uint8_t, std::unique_ptr<MessageChannel>> channels_;  // Null if the kernel offers none.
  int held_ = 0;
};

}  // namespace triskin::device
