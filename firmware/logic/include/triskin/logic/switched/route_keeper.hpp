// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/logic/switched/neighbours.hpp"
#include "triskin/logic/switched/topology.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/adoption.hpp"
#include "triskin/wire/topology.hpp"

namespace triskin::fw {

/// Keeps a patch of switched modules routed. It reroutes after power-up and with a new table, when the chain does not
/// return what was written, when a line is held low, on command, and, while modules of the table are missing, after
/// growing pauses. It offers unreachable modules to the neighbouring controllers and adopts those that they offer. If
/// there is no chain, or no module answers on it, the modules are strapped, and it does nothing.
class RouteKeeper {
 public:
  static constexpr std::uint64_t kCheckEvery_us = 5'000;  ///< A check takes 64 µs with 16 modules.
  static constexpr std::uint64_t kFirstPause_us = 2'000'000, kLongestPause_us = 64'000'000;

  /// `chain` may be null for a board without switched modules.
  explicit RouteKeeper(RouteChain* chain)
      : topology_(chain == nullptr ? absent_ : *chain), present_(chain != nullptr) {}

  /// Makes a reroute due. Call it after power-up or with a new table (null: none).
  void begin(const layout::PatchImage* table);
  /// Makes a reroute due now and restarts the pauses; hosts can command it.
  void request();
  /// Reports that a line stays low, or is free again. A held line makes a reroute due only once, because a line that
  /// could not be freed is left alone.
  void line_state(std::uint8_t line, bool held);
  /// Reports that no module of the table answers, perhaps because a switched patch was powered later. A reroute becomes
  /// due after a pause.
  void nothing_answers(std::uint64_t now_us);
  /// Returns true when sampling must pause so that reroute() can be called.
  [[nodiscard]] bool due(std::uint64_t now_us) const {
    return present_ && (now_us >= reroute_at_us_ || now_us >= look_because_of_others_us());
  }
  /// Searches for modules and activates a new tree; takes up to about 60 ms with 16 modules.
  void reroute(const Clock& clock);
  /// Returns true when a module answers on the chain.
  [[nodiscard]] bool switched() const { return route_.switched; }
  /// Reads the chain back. If it returns false, the samples since the last check do not count, and a reroute may become
  /// due.
  bool check(std::uint64_t now_us);
  /// Returns true when the chain has to be checked at `now_us`.
  [[nodiscard]] bool check_due(std::uint64_t now_us) const { return switched() && now_us >= check_at_us_; }
  /// Returns the time in µs at which a check or a discovery is due; UINT64_MAX means never.
  [[nodiscard]] std::uint64_t next_event_us() const;

  /// Handles a wire::Reach frame; returns false for any other. `own_node` is the node address of this controller.
  bool receive(const wire::CanFrame& frame, std::uint8_t own_node, std::uint64_t now_us);
  /// Sends this controller's state to the others when that is due. If the port has no room, it tries again.
  void send_status(CanPort& port, std::uint8_t own_node, std::uint64_t now_us);
  /// Returns the offered and the adopted modules, as FD0E reports them.
  [[nodiscard]] const wire::Adoption& adoption() const { return adoption_; }
  /// This many modules at the front of the list were also in the previous list, in the same places.
  [[nodiscard]] std::uint8_t kept_adopted() const { return kept_adopted_; }

  /// Returns the present route, as FD08 reports it.
  [[nodiscard]] const wire::ActiveRoute& route() const { return route_; }
  /// Returns the result of the last discovery, as FD07 reports it.
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
  bool beyond_ = false;    // The next search was commanded.
  bool returned_ = false;  // Before this search, neighbours were asked to give modules back.
  std::uint64_t tell_at_us_ = UINT64_MAX;
  bool complete_discovery_ = false;
  std::uint8_t held_lines_ = 0;  // These lines were reported already.
  std::uint64_t reroute_at_us_ = UINT64_MAX, check_at_us_ = 0;
  std::uint64_t pause_us_ = kFirstPause_us;
};

}  // namespace triskin::fw
