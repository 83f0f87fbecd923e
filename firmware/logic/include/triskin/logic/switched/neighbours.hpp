// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/wire/adoption.hpp"

namespace triskin::fw {

/// What the controllers of neighbouring patches offer, and when a look at the patch is due because of it. A look while
/// open() may take in their modules. Pure: time comes as an argument. docs/adoption.md.
class Neighbours {
 public:
  static constexpr std::uint64_t kRepeat_us = 1'000'000;  ///< time between two frames of an owner that offers modules
  static constexpr std::uint64_t kForget_us = 3'000'000;  ///< an offer that is not repeated ends after this time
  static constexpr std::uint64_t kTurn_us = 100'000;      ///< adopters of one offer look one after the other
  static constexpr std::uint64_t kHandBack_us = 100'000;  ///< an owner waits so long before it takes its modules back
  static constexpr std::uint64_t kKeepAway_us = 300'000;  ///< nobody takes them in meanwhile: kHandBack_us and a look
  static constexpr std::uint64_t kNever_us = UINT64_MAX;

  /// A frame of another controller came. `own_node`: decides whose turn it is. `adopted modules`: modules are taken in
  /// now.
  void receive(const wire::Reach& reach, std::uint8_t own_node, bool adopted_modules, std::uint64_t now_us);
  /// Offers that were not repeated end. Call it a few times a second.
  void tick(bool adopted_modules, std::uint64_t now_us);
  /// A look begins. True: it may take modules in; else what was taken in is given back.
  [[nodiscard]] bool begin_look(std::uint64_t now_us);
  /// A look that could take nothing in has shown that the next one may.
  void look_again(std::uint64_t now_us);
  /// How many modules that look may take in one behind the other. One, until every neighbour has had its turn: so a
  /// neighbour takes first what touches it, and does not fill its few addresses with what others are nearer to.
  [[nodiscard]] std::uint8_t layers() const { return layers_; }
  /// Schedules another look for modules behind the adopted ones, once the other neighbours have had their turn.
  void look_further(std::uint64_t now_us);
  /// When a look is due because of the neighbours.
  [[nodiscard]] std::uint64_t look_us() const { return look_us_; }

 private:
  struct Offer {
    std::uint8_t node = 0;  // 0: none
    std::uint16_t rows = 0;
    std::uint64_t until_us = 0;
  };
  static constexpr std::size_t kMaxOffers = 4;  // A fifth owner is heard when one of these has got its modules back.
  [[nodiscard]] bool any() const;
  void end(Offer& offer, bool adopted_modules, std::uint64_t now_us);

  std::array<Offer, kMaxOffers> offers_{};
  static constexpr std::uint8_t kTurns = 4;
  std::uint8_t layers_ = 1;
  std::uint64_t look_us_ = kNever_us, away_until_us_ = 0;
};

}  // namespace triskin::fw
