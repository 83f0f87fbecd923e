// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "triskin/base/error.hpp"
#include "triskin/core/bytes.hpp"
#include "triskin/link/link.hpp"
#include "triskin/wire/iso_tp.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::session {

/// Thrown when a controller refuses a request; names the controller, the request and the reason.
class Refused : public DeviceError {
 public:
  Refused(const std::string& what, std::uint8_t code) : DeviceError(what), code_(code) {}
  /// Returns the negative response code of ISO 14229-1 (wire::nrc).
  [[nodiscard]] std::uint8_t code() const { return code_; }

 private:
  std::uint8_t code_;
};

/// Thrown when no answer arrives after all repeats.
class NoAnswer : public link::Unreachable {
 public:
  using link::Unreachable::Unreachable;
};

/// A bus exchanges requests and answers (ISO 14229-1 over ISO 15765-2) with many controllers on one link. Every waiting
/// call throws Cancelled when the process is asked to end (interrupt_request()). Not thread-safe.
class Bus {
 public:
  using Message = std::vector<std::uint8_t>;
  using OnFrame = std::function<void(const wire::CanFrame&)>;

  /// `link` must outlive the bus.
  explicit Bus(link::Link& link) : link_(link) {}
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  enum class Repeat {
    kNever,  ///< The caller has to handle a lost answer, because the request may have taken effect.
    kSafe,   ///< Sending the request twice has the same effect as sending it once.
  };
  /// Sends a request (service byte first, 1..4095 bytes) to node address `node` and waits for the answer. While the
  /// controller answers "response pending" it waits at most a minute. Returns the answer without its service byte.
  /// Throws Refused, NoAnswer (after five attempts with kSafe, one with kNever), Unreachable, and DeviceError when the
  /// request is too long.
  Message request(std::uint8_t node, Bytes request, Repeat repeat);

  /// Returns unique id and node address of every controller that answers, sorted by unique id; it works even while
  /// several share an address. Everybody is asked twice, and again (eight times at most) while a known controller is
  /// silent, since frames get lost. One that stays silent is missing from the result: see silent(). Takes 0.12 s, 0.5 s
  /// when somebody is silent; on a slow bus longer, as long as claims arrive. Throws Unreachable.
  [[nodiscard]] std::vector<wire::NodeClaim> discover();
  /// From now on discover() knows this controller, as it knows each one that has ever answered it.
  void expect(const wire::UniqueId& id) { known_.insert(id); }
  [[nodiscard]] const std::set<wire::UniqueId>& known() const { return known_; }
  /// Returns the known controllers that are not among `claims`.
  [[nodiscard]] std::vector<wire::UniqueId> silent(std::span<const wire::NodeClaim> claims) const;
  /// Gives the controller with unique id `id` the node address 1..126. The controller restarts without a confirmation,
  /// so listen for 20 ms and then discover. Throws Unreachable.
  void assign(const wire::UniqueId& id, std::uint8_t node_address);

  /// Sets the handler of frames of the data stream, which are not answers; with an empty handler they are dropped. The
  /// waiting calls of this class call it.
  void on_stream(OnFrame handler) { on_stream_ = std::move(handler); }
  /// Waits until `until_us` of the link's clock; stream frames go to the handler. Throws Unreachable.
  void listen(std::uint64_t until_us);
  /// Passes the frames that have already arrived to the handler, for at most 50 ms, without waiting. Throws
  /// Unreachable.
  void poll();
  /// Waits for one frame of any kind until `until_us`; it may return empty earlier, at the latest after 0.2 s. Throws
  /// Unreachable.
  std::optional<wire::CanFrame> receive(std::uint64_t until_us);
  /// Restores a link that was cut and resets all connections. Throws DeviceError when it stays cut.
  void reconnect();

  /// While an object of this class exists, a request to end the process (interrupt_request()) does not throw Cancelled.
  /// It protects short work that must not stop halfway. Guards may be nested.
  class Uninterrupted {
   public:
    explicit Uninterrupted(Bus& bus) : bus_(bus) { ++bus_.held_; }
    ~Uninterrupted() { --bus_.held_; }
    Uninterrupted(const Uninterrupted&) = delete;
    Uninterrupted& operator=(const Uninterrupted&) = delete;

   private:
    Bus& bus_;
  };

  [[nodiscard]] link::Link& link() { return link_; }
  /// Returns Link::name.
  [[nodiscard]] std::string name() const { return link_.name(); }
  /// Returns the error message for a silent bus: the bus, that `who` does not answer, and what to check.
  [[nodiscard]] std::string nobody_answers(const std::string& who = "no controller answers") const {
    return name() + ": " + who + "; " + link_.when_silent();
  }
  /// Link::now_us: time of the link, µs.
  [[nodiscard]] std::uint64_t now_us() const { return link_.now_us(); }

 private:
  static constexpr int kRepeats = 5;
  // A claim needs three frames. Where 10 % of them are lost, a controller is silent in eight rounds once in 30,000
  // times.
  static constexpr int kMinClaimRounds = 2, kMaxClaimRounds = 8;
  static constexpr std::uint64_t kClaimWindow_us = 60'000;
  // A claim has two frames of at most 160 bits, so two whole claims take 16 ms at 20 kbit/s and 126 of them take 2 s.
  static constexpr std::uint64_t kClaimGap_us = 20'000, kLongestClaims_us = 2'500'000;
  static constexpr std::uint64_t kLongestDrain_us = 50'000, kLongestPending_us = 60'000'000;
  // A request to end the process is noticed at the latest after this time.
  static constexpr std::uint64_t kInterruptPoll_us = 200'000;

  /// Throws Cancelled when the process is asked to end and no guard prevents it.
  void end_on_request() const;
  wire::IsoTp& connection(std::uint8_t node);
  /// Sends once and waits; returns empty if no answer arrives in time.
  Message exchange(std::uint8_t node, Bytes request);
  /// Asks everybody once; `claims` gets who answers. Returns false when a known controller was silent.
  bool ask_who_is_there(std::map<wire::UniqueId, wire::NodeClaim>& claims);
  void drain(std::uint8_t node);
  bool start(std::uint8_t node, Bytes request);
  /// Returns the next message of this node; empty if none arrives before the deadline, or it was given up.
  Message next_message(std::uint8_t node, std::uint64_t deadline_us);
  Message next_of_channel(link::MessageChannel& channel, std::uint64_t deadline_us);
  void transmit(wire::IsoTp& connection);
  wire::IsoTp::Event receive_for(wire::IsoTp& connection, std::uint64_t deadline_us);

  link::Link& link_;
  OnFrame on_stream_;
  std::map<std::uint8_t, std::unique_ptr<wire::IsoTp>> connections_;
  // A null pointer means that the kernel offers no channel.
  std::map<std::uint8_t, std::unique_ptr<link::MessageChannel>> channels_;
  int held_ = 0;
  std::set<wire::UniqueId> known_;  // everybody who has ever answered discover(), or is expected to
};

}  // namespace triskin::session
