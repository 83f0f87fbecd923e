// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/layout/patch_image.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/adoption.hpp"
#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/topology.hpp"

namespace triskin::fw {

/// Replaces RouteKeeper in an image without switched modules: every patch is strapped, and nothing is ever due. The
/// answers are those of a board without a chain.
class StrappedRoute {
 public:
  explicit StrappedRoute(RouteChain*) {}

  void begin(const layout::PatchImage* table) { adoption_.rows = table == nullptr ? 0 : table->module_count; }
  void request() {}
  void line_state(std::uint8_t, bool) {}
  void nothing_answers(std::uint64_t) {}
  [[nodiscard]] static constexpr bool due(std::uint64_t) { return false; }
  void reroute(const Clock&) {}
  [[nodiscard]] static constexpr bool switched() { return false; }
  [[nodiscard]] static constexpr bool check(std::uint64_t) { return true; }
  [[nodiscard]] static constexpr bool check_due(std::uint64_t) { return false; }
  [[nodiscard]] static constexpr std::uint64_t next_event_us() { return UINT64_MAX; }
  [[nodiscard]] static constexpr bool receive(const wire::CanFrame&, std::uint8_t, std::uint64_t) { return false; }
  void send_status(CanPort&, std::uint8_t, std::uint64_t) {}
  [[nodiscard]] const wire::Adoption& adoption() const { return adoption_; }
  [[nodiscard]] static constexpr std::uint8_t kept_adopted() { return 0; }
  [[nodiscard]] static wire::ActiveRoute route() { return {}; }
  [[nodiscard]] static wire::FoundTopology found() { return {}; }

 private:
  wire::Adoption adoption_;
};

}  // namespace triskin::fw
