// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/logic/switched/neighbours.hpp"
#include "triskin/logic/switched/topology.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/adoption.hpp"
#include "triskin/wire/topology.hpp"

namespace triskin::fw {

/// Keeps a patch of switched modules routed. Heals after power-up and a new table, when the chain does not give back
/// what was written, when a line is held low, on command, and, while modules of the table are missing, after pauses
/// that grow. Offers modules out of reach to the neighbouring controllers and takes in those that they offer. Without a
/// chain, or when no module answers on it, the modules are strapped: nothing is done.
class RouteKeeper {
 public:
  static constexpr std::uint64_t kCheckEvery_us = 5'000;  ///< 64 µs each with 16 modules
  static constexpr std::uint64_t kFirstPause_us = 2'000'000, kLongestPause_us = 64'000'000;

  /// `chain` may be null: a board without switched modules.
  explicit RouteKeeper(RouteChain* chain)
      : topology_(chain == nullptr ? absent_ : *chain), present_(chain != nullptr) {}

  /// Call it after power-up or with a new table (null: none). It makes a rerouting due.
  void begin(const layout::PatchImage* table);
  /// Makes a rerouting due now and restarts the pauses; hosts can command it.
  void request();
  /// A line stays low, or is free again. A held one makes a rerouting due, once: what could not be freed is left alone.
  void line_state(std::uint8_t line, bool held);
  /// No module of the table answers: perhaps a switched patch that has power only now. A rerouting is due after a
  /// pause.
  void nothing_answers(std::uint64_t now_us);
  /// True when sampling must pause and reroute() be called then.
  [[nodiscard]] bool due(std::uint64_t now_us) const {
    return present_ && (now_us >= reroute_at_us_ || now_us >= look_because_of_others_us());
  }
  /// Takes up to about 60 ms with 16 modules.
  void reroute(const Clock& clock);
  /// True when a module answers on the chain.
  [[nodiscard]] bool switched() const { return route_.switched; }
  /// Reads the chain back. False: what was read since the last check does not count; a rerouting may be due then.
  bool check(std::uint64_t now_us);
  /// True when the chain has to be checked at `now_us`.
  [[nodiscard]] bool check_due(std::uint64_t now_us) const { return switched() && now_us >= check_at_us_; }
  /// Time at which a check or a discovery is due, µs; UINT64_MAX: never.
  [[nodiscard]] std::uint64_t next_event_us() const;

  /// False: the frame is no wire::Reach. `own_node`: node address of this controller.
  bool receive(const wire::CanFrame& frame, std::uint8_t own_node, std::uint64_t now_us);
  /// Sends to the others what they are to know, when that is due. Where the port has no room it is tried again.
  void send_status(CanPort& port, std::uint8_t own_node, std::uint64_t now_us);
  /// What is offered and what was taken in, as FD0E reports it.
  [[nodiscard]] const wire::Adoption& adoption() const { return adoption_; }
  /// The first so many adopted modules of the list were there in the list before it, in the same places.
  [[nodiscard]] std::uint8_t kept_adopted() const { return kept_adopted_; }

  /// What is routed now, as FD08 reports it.
  [[nodiscard]] const wire::ActiveRoute& route() const { return route_; }
  /// What the last discovery found, as FD07 reports it.
  [[nodiscard]] wire::FoundTopology found() const;

 private:
  class NoChain final : public RouteChain {
   public:
    void enable(std::uint8_t) override {}
    void exchange(Bytes, std::span<std::uint8_t> in) override {
      for (std::uint8_t& b : in) b = 0;
    }
    void latch() override {}
    [[nodiscard]] std::uint8_t stuck_lines() override { return 0; }
  };
  void note(const Topology::Report& report);
  void note_adopted();
  [[nodiscard]] bool whole() const;
  [[nodiscard]] std::uint64_t look_because_of_others_us() const { return whole() ? neighbours_.look_us() : UINT64_MAX; }
  void offer(const Topology::Report& report, std::uint64_t now_us);
  void set_offered(std::uint16_t rows);
  void plan_next(std::uint64_t now_us);

  NoChain absent_;
  Topology topology_;
  bool present_;
  Topology::Table table_;
  wire::ActiveRoute route_;
  Neighbours neighbours_;
  wire::Adoption adoption_;
  std::uint8_t kept_adopted_ = 0;
  bool beyond_ = false;    // The next look was commanded.
  bool returned_ = false;  // Neighbours were asked to give modules back before this look.
  std::uint64_t tell_at_us_ = UINT64_MAX;
  bool complete_discovery_ = false;
  std::uint8_t held_lines_ = 0;  // Lines that were reported already.
  std::uint64_t reroute_at_us_ = UINT64_MAX, check_at_us_ = 0;
  std::uint64_t pause_us_ = kFirstPause_us;
};

}  // namespace triskin::fw
