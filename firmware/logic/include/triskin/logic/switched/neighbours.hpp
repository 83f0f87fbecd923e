// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/wire/adoption.hpp"

namespace triskin::fw {

/// Tracks what the controllers of neighbouring patches offer, and when a search of the patch is due because of it. A
/// search while open() may adopt their modules. Time is an argument. See docs/switched_module.md.
class Neighbours {
 public:
  /// An owner that offers modules repeats its frame at this interval.
  static constexpr std::uint64_t kRepeat_us = 1'000'000;
  static constexpr std::uint64_t kForget_us = 3'000'000;  ///< An offer that is not repeated expires after this time.
  /// Adopters of one offer search one after the other, this far apart.
  static constexpr std::uint64_t kTurn_us = 100'000;
  /// An owner waits this long before it takes its modules back.
  static constexpr std::uint64_t kHandBack_us = 100'000;
  /// During this time, kHandBack_us and a search, no neighbour adopts them.
  static constexpr std::uint64_t kKeepAway_us = 300'000;
  static constexpr std::uint64_t kNever_us = UINT64_MAX;

  /// Handles a frame of another controller. `own_node` decides whose turn it is. `adopted_modules` says that modules
  /// are adopted now.
  void receive(const wire::Reach& reach, std::uint8_t own_node, bool adopted_modules, std::uint64_t now_us);
  /// Ends offers that were not repeated. Call it a few times a second.
  void tick(bool adopted_modules, std::uint64_t now_us);
  /// Starts a search. Returns true if it may adopt modules; otherwise the adopted ones are given back.
  [[nodiscard]] bool begin_look(std::uint64_t now_us);
  /// Notes that a search that could adopt nothing has shown that the next one may.
  void look_again(std::uint64_t now_us);
  /// Returns how many modules in a row this search may adopt. It is one until every neighbour has had its turn, so that
  /// a neighbour first adopts the modules that touch it and does not fill its few addresses with modules that are
  /// nearer to others.
  [[nodiscard]] std::uint8_t layers() const { return layers_; }
  /// Schedules another search for modules behind the adopted ones, once the other neighbours have had their turn.
  void look_further(std::uint64_t now_us);
  /// Returns when a search is due because of the neighbours.
  [[nodiscard]] std::uint64_t look_us() const { return look_us_; }

 private:
  struct Offer {
    std::uint8_t node = 0;  // Zero means that the offer is unused.
    std::uint16_t rows = 0;
    std::uint64_t until_us = 0;
  };
  static constexpr std::size_t kMaxOffers = 4;  // A fifth owner is heard when one of these has its modules back.
  [[nodiscard]] bool any() const;
  void end(Offer& offer, bool adopted_modules, std::uint64_t now_us);

  std::array<Offer, kMaxOffers> offers_{};
  static constexpr std::uint8_t kTurns = 4;
  std::uint8_t layers_ = 1;
  std::uint64_t look_us_ = kNever_us, away_until_us_ = 0;
};

}  // namespace triskin::fw
