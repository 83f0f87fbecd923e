// SPDX-License-Identifier: GPL-3.0-or-later
#include "kept_wiring.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "triskin/base/index.hpp"
#include "triskin/routing/jumpers.hpp"
#include "triskin/routing/routing.hpp"
#include "wire_design.hpp"

namespace triskin::pipeline {
namespace {

// Returns the jumper between the new ids, the lesser first; −1 stands for a module that is gone.
design::Jumper renamed(design::Jumper jumper, const std::vector<int>& new_id) {
  for (int& node : jumper.node) node = new_id[at(node)];
  if (jumper.node[0] > jumper.node[1]) {
    std::swap(jumper.node[0], jumper.node[1]);
    std::swap(jumper.side[0], jumper.side[1]);
  }
  return jumper;
}

// Returns the same jumper among the places, with its cable measured on the new surface.
std::optional<design::Jumper> jumper_now(const design::Jumper& was, const std::vector<design::Jumper>& places) {
  const auto now =
      std::ranges::find_if(places, [&](const auto& j) { return j.node == was.node && j.side == was.side; });
  return now == places.end() ? std::nullopt : std::optional(*now);
}

// Keeps the patches whose modules and joints are unchanged.
class PatchKeeper {
 public:
  PatchKeeper(const design::Design& old, const design::Design& now, const std::vector<int>& new_id,
              std::vector<design::Jumper> places)
      : old_(old), now_(now), new_id_(new_id), places_(std::move(places)), wiring_(design::wiring_of(old)) {}

  routing::KeptWiring kept() {
    routing::KeptWiring kept;
    for (std::size_t p = 0; p < old_.patches.size(); ++p) {
      std::vector<design::Jumper> jumpers;
      const bool stays = !old_.patches[p].is_gap() && has_modules(old_.patches[p]) && has_joints(old_.patches[p]) &&
                         has_jumpers(p, jumpers);
      kept.patches.push_back(stays ? renamed_patch(old_.patches[p]) : design::Patch{});
      if (stays) kept.jumpers.insert(kept.jumpers.end(), jumpers.begin(), jumpers.end());
    }
    return kept;
  }

 private:
  [[nodiscard]] bool has_modules(const design::Patch& patch) const {
    return std::ranges::all_of(patch.modules, [&](const auto& m) { return new_id_[at(m.node)] >= 0; });
  }
  // Only joints to modules of the same patch count; those to others may change.
  [[nodiscard]] bool has_joints(const design::Patch& patch) const {
    const int index = wiring_[at(patch.modules.front().node)].patch;
    return std::ranges::all_of(patch.modules, [&](const auto& m) {
      for (std::size_t s = 0; s < 3; ++s) {
        const int was = old_.layout.modules[at(m.node)].neighbour[s];
        if (was < 0 || wiring_[at(was)].patch != index) continue;
        if (now_.layout.modules[at(new_id_[at(m.node)])].neighbour[s] != new_id_[at(was)]) return false;
      }
      return true;
    });
  }
  [[nodiscard]] bool has_jumpers(std::size_t patch, std::vector<design::Jumper>& jumpers) const {
    for (const design::Jumper& jumper : old_.layout.jumpers) {
      if (wiring_[at(jumper.node[0])].patch != static_cast<int>(patch)) continue;
      const auto now = jumper_now(renamed(jumper, new_id_), places_);
      if (!now) return false;
      jumpers.push_back(*now);
    }
    return true;
  }
  [[nodiscard]] design::Patch renamed_patch(design::Patch patch) const {
    const auto rename = [&](int& node) { node = node < 0 ? node : new_id_[at(node)]; };
    rename(patch.entry);
    rename(patch.second_entry);
    for (design::RoutedModule& m : patch.modules) {
      rename(m.node);
      rename(m.parent);
    }
    for (auto& joint : patch.cut_joints) std::ranges::for_each(joint, rename);
    return patch;
  }

  const design::Design& old_;
  const design::Design& now_;
  const std::vector<int>& new_id_;
  std::vector<design::Jumper> places_;
  std::vector<design::ModuleWiring> wiring_;
};

}  // namespace

std::vector<layout::PatchIndex> wire_around(const design::Design& old, design::Design& now,
                                            const mesh::Surface& surface, const mesh::SurfaceRegions* regions,
                                            const std::vector<int>& new_id, const ProgressSink& progress) {
  std::vector<design::Jumper> fitted;
  for (const design::Jumper& jumper : old.layout.jumpers) fitted.push_back(renamed(jumper, new_id));
  const std::vector<design::Jumper> places = routing::find_jumpers(surface, now.layout, now.limits, fitted);
  const routing::KeptWiring kept = PatchKeeper(old, now, new_id, places).kept();
  wire(now, surface, regions, places, progress, nullptr, &kept);
  std::vector<layout::PatchIndex> stayed;
  for (std::size_t p = 0; p < kept.patches.size(); ++p) {
    if (!kept.patches[p].is_gap()) stayed.emplace_back(p);
  }
  return stayed;
}

}  // namespace triskin::pipeline
