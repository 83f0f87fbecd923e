// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "net.hpp"
#include "relax.hpp"
#include "rules.hpp"
#include "triskin/base/dice.hpp"
#include "triskin/base/interrupt.hpp"
#include "zones.hpp"

namespace triskin::lattice {

/// Islands may start at these points, which are spread evenly over a surface.
struct Sample {
  Vec3 point, normal;
};
[[nodiscard]] std::vector<Sample> spread_samples(const mesh::Surface& surface, double area_each_mm2,
                                                 std::uint64_t seed);

/// In one try to place a module the net within `radius_mm` of it is relaxed, in so many steps.
struct RelaxTry {
  double radius_mm;
  int steps;
};

/// A module that is refused is tried again with more of its surroundings free to move. The third try follows every
/// second failure of the second one.
struct RelaxTries {
  RelaxTry first{60.0, 5}, second{90.0, 6};
  std::optional<RelaxTry> third;
};

/// Adds modules to a net one by one; each is kept only if it and all modules that moved for it keep the rules.
class Grower {
 public:
  using Clock = std::chrono::steady_clock;
  /// `now` measures the deadline; an empty function selects the steady clock.
  Grower(const mesh::Surface& surface, const Rules& rules, const std::vector<Sample>& samples, double corner_lift_mm,
         Clock::time_point end, std::function<Clock::time_point()> now = {});

  Grower(const Grower&) = delete;  // The relaxer refers to surface_, so the object cannot be copied.
  Grower& operator=(const Grower&) = delete;

  /// Limits work to modules whose centre lies in the ball.
  struct Ball {
    Vec3 center = Vec3::Zero();
    double radius_mm = 1e9;
    [[nodiscard]] bool holds(const Vec3& p) const { return (p - center).squaredNorm() < radius_mm * radius_mm; }
  };
  /// Grows the islands that reach into the ball over their open sides until nothing more fits.
  void grow(LatticeMesh& net, const Ball& ball, Dice& random);
  /// Starts islands on uncovered surface in the ball and grows each.
  void fill(LatticeMesh& net, const Ball& ball, Dice& random, int attempts);

  /// Replaces the default tries. Those for small parts cost more and find more.
  void set_tries(const RelaxTries& tries) { tries_ = tries; }
  /// Restricts new modules to those with centres in the zone.
  void confine(const Zone& zone) { zone_ = zone; }
  [[nodiscard]] const Zone& zone() const { return zone_; }

  /// Begins an island with a module at three corners, if it keeps the rules.
  bool try_seed(LatticeMesh& net, const Triangle& corners);

  /// Removes modules that overhang the border by more than is allowed, as the final measurement finds it, except fixed
  /// triangles, and returns whether there was any. The net has to be separated afterwards. Only modules that moved
  /// since the last call are measured.
  bool remove_overrunning(LatticeMesh& net);

  [[nodiscard]] bool covered(const LatticeMesh& net, const Vec3& p) const;
  void end_at(Clock::time_point end) { end_ = end; }
  [[nodiscard]] bool late() const { return (now_ ? now_() : Clock::now()) > end_ || interrupt_request(); }
  /// Does the same as late(), but the time never ends the search for the first module, since a layout needs one.
  [[nodiscard]] bool late(const LatticeMesh& net) const { return (net.size() > 0 && late()) || interrupt_request(); }
  /// Counts the refusals by limit since the last reset.
  std::array<int, kRefusals> refused{};

 private:
  struct Side {
    int triangle, side;
  };
  bool roll(const Vec3& a, const Vec3& b, const Vec3& away, Foot& apex);
  bool try_side(LatticeMesh& net, Side side);
  bool try_corner(LatticeMesh& net, Side side, int apex);
  bool seed_at_side(LatticeMesh& net, Side side);
  bool seed_at_sample(LatticeMesh& net, const Sample& sample, Dice& random);
  bool seed_at_border(LatticeMesh& net, const Sample& sample);
  [[nodiscard]] bool crowded(const LatticeMesh& net, const Triangle& corners, int beside) const;
  bool keep_or_revert(LatticeMesh& net, int triangle);
  [[nodiscard]] Refusal refusal_of(LatticeMesh& net, int triangle, const RelaxTry& attempt);
  [[nodiscard]] std::vector<Side> open_sides(const LatticeMesh& net, const Ball& ball) const;
  [[nodiscard]] static Vec3 place_beside(const LatticeMesh& net, Side side);
  [[nodiscard]] std::uint64_t surroundings_of(const LatticeMesh& net, Side side) const;
  [[nodiscard]] std::uint64_t& last_failure(std::vector<std::array<std::uint64_t, 3>>& failures, Side side);
  void grow_from(LatticeMesh& net, const std::vector<Side>& front, const Ball& ball, Dice& random);

  NearSurface surface_;
  const Rules& rules_;
  const std::vector<Sample>& samples_;
  PointGrid sample_grid_;
  Relaxer relaxer_;
  RelaxTries tries_;
  int second_failures_ = 0;
  Zone zone_;
  std::vector<int> near_;
  // Each side has the signature of its surroundings when a module was refused there. The side is not tried again until
  // that changes.
  std::vector<std::array<std::uint64_t, 3>> failed_join_, failed_seed_;
  std::vector<KnownSides> known_sides_;
  std::vector<Triangle> known_within_;  // Each triangle was last seen within the border at this place.
  Clock::time_point end_;
  std::function<Clock::time_point()> now_;
};

}  // namespace triskin::lattice
