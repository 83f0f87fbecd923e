// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "grower.hpp"
#include "layout_front.hpp"
#include "net_price.hpp"
#include "place_value.hpp"
#include "triskin/lattice/grow_lattice.hpp"
#include "zones.hpp"

namespace triskin::lattice {

inline constexpr double kNothing = -1e300;  // The search gives this value to an empty layout.

/// The value of a layout less its price, in the forms that the search compares.
struct Value {
  double module_value = kNothing;  ///< Modules and joints are counted here, in units of modules.
  EstimatedPrice price;
  [[nodiscard]] double rounded() const { return module_value - price.rounded; }
  /// `share` (0 … 1) scales the price of the jumpers and islands that join the controllers.
  [[nodiscard]] double relaxed(double share = 1.0) const {
    return module_value - price.relaxed.controllers - share * price.relaxed.joining;
  }
};

/// From room for kRoundedModules on, layouts are priced by whole controllers; from kLargeModules on, a part is large.
inline constexpr double kRoundedModules = 48.0, kLargeModules = 128.0;

struct SearchPlan {
  int starts;         ///< The race begins with this many complete layouts.
  double race_share;  ///< Each round of the race takes this fraction of the search.
  /// The price of jumpers and islands counts by this fraction at the beginning of an annealing and in full at
  /// `rounded_from`: an early island is room found for modules, and later steps join it to others.
  double first_share;
  double rounded_from;  ///< From this fraction of an annealing on, whole controllers count; above 1 they never do.
  double hot;           ///< At the start of an annealing a step may lose this many modules.
  RelaxTries tries;
  [[nodiscard]] static SearchPlan of(double room_modules);
};

/// Holds the data that all chains of a search share. Refers to its arguments.
struct GrowthTask {
  const mesh::Surface& surface;
  const Rules& rules;
  const SurfaceLatticeOptions& options;
  const std::vector<Sample>& samples;
  const CopiedRegions& regions;
  double jumper_mm, corner_lift_mm;
  const LatticeMesh& started;  ///< The net holds the kept modules, or is empty.
  Grower::Clock::time_point start, end;
  SearchPlan plan;

  [[nodiscard]] Grower::Clock::time_point now() const { return options.now ? options.now() : Grower::Clock::now(); }
  [[nodiscard]] Value value(LatticeMesh& net, NetPrice& price, PlaceValue& module_value) const;
  [[nodiscard]] double kept_value(const Value& value) const {
    return plan.rounded_from <= 1.0 ? value.rounded() : value.relaxed();
  }
  /// Returns the progress of the search after so many steps of each chain, 0 … 1.
  [[nodiscard]] double fraction(int steps) const;
};

/// Anneals a sequence of ruin and recreate. Alone it follows its own schedule; in a team it works in a zone of the
/// layout of the team's first chain, whose schedule it follows. Used by one thread at a time.
class Chain {
 public:
  Chain(const GrowthTask& task, std::uint64_t seed);

  /// Makes complete layouts from several starts, because place and turn of the first module decide more than later
  /// steps can mend. The better half is improved for a while, then again its better half, until one remains.
  void build();
  /// Divides the rest of the search into annealings; `chains` share the steps of each.
  void plan_runs(int chains);
  /// Makes another start if the next annealing is due.
  void begin_due_run();
  void run(int steps);
  /// Changes the time at which this chain's growth gives up.
  void end_at(Grower::Clock::time_point end) { grower_.end_at(end); }
  /// Takes over a layout of another chain.
  void adopt(const NetCopy& net);

  /// Makes this chain change only what lies in the zone, in a copy of the leader's layout.
  void work_in(const Zone& zone, const Chain& leader);
  [[nodiscard]] ZoneNet zone_net() const { return {now_, pinned_}; }
  /// Takes the merged layout of a team as its own, and all of space as its zone.
  void take_merged(LatticeMesh net);

  [[nodiscard]] const LatticeMesh& now() const { return now_; }
  [[nodiscard]] const NetCopy& best() const { return best_; }
  [[nodiscard]] double best_value() const { return best_value_; }
  [[nodiscard]] const LayoutFront& front() const { return front_; }
  [[nodiscard]] int steps() const { return steps_; }
  [[nodiscard]] Dice& random() { return random_; }
  /// Returns true in the last annealing, when results of other chains may be taken over.
  [[nodiscard]] bool in_last_run() const { return schedule_.run == schedule_.runs - 1; }

 private:
  struct Schedule {
    double begun_at = 0.0;  // The annealing began at this fraction of the search.
    int runs = 1, run = 0;
  };
  void set(LatticeMesh net);
  void confine(const Zone& zone);
  void start_anew();
  void take(const FoundLayout& found);
  void improve(FoundLayout& start, double until);
  [[nodiscard]] double runs_done() const;
  [[nodiscard]] double heat() const;
  [[nodiscard]] double searched(const Value& value) const;
  void step();
  Value ruin_and_recreate();
  [[nodiscard]] double kept_value() const { return task_.kept_value(value_); }
  [[nodiscard]] bool is_best() const { return kept_value() > best_value_ + 1e-9; }
  [[nodiscard]] bool would_be_kept() const { return is_best() || front_.would_keep(now_, kept_value()); }
  void keep_if_worth_it();
  void keep();
  [[nodiscard]] const Sample& some_sample();
  [[nodiscard]] Vec3 place_to_ruin();
  [[nodiscard]] std::optional<int> some_triangle_of_small_island();
  [[nodiscard]] Grower::Ball ruin();
  [[nodiscard]] std::optional<Grower::Ball> ruin_island();

  const GrowthTask& task_;
  Dice random_;
  NetPrice price_;
  PlaceValue worth_;
  Grower grower_;
  std::vector<int> samples_;  // These samples of the task lie in the zone.
  std::vector<int> pinned_;   // These triangles lie outside the zone.
  LatticeMesh now_;           // price_ knows this lattice.
  NetCopy best_;
  LayoutFront front_;
  Value value_;
  double best_value_ = kNothing;
  double race_heat_ = 0.0;   // A positive value replaces the heat of the schedule.
  double fraction_ = 0.0;    // Progress of the current annealing, 0 … 1.
  double raced_from_ = 0.0;  // The race began after this fraction of the search.
  Schedule schedule_;
  int steps_ = 0;
};

}  // namespace triskin::lattice
