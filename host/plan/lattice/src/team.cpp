// SPDX-License-Identifier: GPL-3.0-or-later
#include "team.hpp"

#include <algorithm>
#include <utility>

namespace triskin::lattice {
namespace {

constexpr int kMinInAZone = 32;  // This many modules, including half of the band around the zone, make a zone worth it.
constexpr double kBehind = 0.5;  // The last annealing rarely makes up for a deficit of this many modules.

}  // namespace

Team::Team(const GrowthTask& task, std::deque<Chain>& chains, std::size_t first, std::size_t count)
    : task_(task), chains_(chains), first_(first), count_(count) {
  for (std::size_t k = 1; k < count; ++k) {
    if (chain(k).best_value() > chain(0).best_value()) chain(0).adopt(chain(k).best());
  }
  chain(0).plan_runs(static_cast<int>(count));
}

void Team::divide_work() {
  Chain& leader = chain(0);
  leader.begin_due_run();
  working_ = std::clamp<std::size_t>(at(leader.now().size() / kMinInAZone), 1, count_);
  if (working_ == 1) return;
  const std::vector<Zone> zones = divide(leader.now(), static_cast<int>(working_), leader.random());
  for (std::size_t k = working_; k-- > 0;) chain(k).work_in(zones[k], leader);
}

void Team::merge() {
  if (working_ == 1) return;
  std::vector<ZoneNet> nets;
  for (std::size_t k = 0; k < working_; ++k) nets.push_back(chain(k).zone_net());
  const LatticeMesh empty(task_.surface.mesh().vertices, task_.options.corner_cut_mm);
  chain(0).take_merged(merge_zones(empty, nets));
}

void Team::catch_up(const Chain& best) {
  Chain& leader = chain(0);
  if (&leader != &best && leader.in_last_run() && leader.best_value() < best.best_value() - kBehind)
    leader.adopt(best.best());
}

std::vector<Team> teams_of(const GrowthTask& task, std::deque<Chain>& chains, int most) {
  std::vector<Team> teams;
  for (std::size_t first = 0; first < chains.size(); first += at(most))
    teams.emplace_back(task, chains, first, std::min(at(most), chains.size() - first));
  return teams;
}

}  // namespace triskin::lattice
