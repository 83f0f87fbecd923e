// SPDX-License-Identifier: GPL-3.0-or-later
#include "choose_layout.hpp"

#include <algorithm>
#include <optional>

#include "triskin/base/parallel.hpp"
#include "triskin/routing/jumpers.hpp"
#include "wire_design.hpp"

namespace triskin::pipeline {

WiredLayout priced(const mesh::Surface& surface, design::ModuleLayout layout, const design::LayoutLimits& limits,
                   const routing::RoutingOptions& routing, const mesh::SurfaceRegions* regions) {
  WiredLayout wired;
  wired.layout = std::move(layout);
  wired.module_value =
      regions == nullptr ? static_cast<double>(wired.layout.modules.size()) : regions->module_value(wired.layout);
  wired.places = routing::find_jumpers(surface, wired.layout, limits);
  routing::RoutingOptions quick = routing;
  quick.failure_analysis = false;
  quick.recombinations = 0;
  const routing::RoutingResult r = routing::route(wired_graph(wired.layout, regions), wired.places, quick);
  wired.patches = static_cast<int>(r.patches.size());
  wired.division = r.division;
  wired.jumpers = static_cast<int>(r.jumpers.size());
  wired.price = routing.price.of(wired.patches, wired.jumpers, wired.layout.islands);
  return wired;
}

std::vector<WiredLayout> priced(const mesh::Surface& surface, std::vector<design::ModuleLayout> layouts,
                                const design::LayoutLimits& limits, const routing::RoutingOptions& routing,
                                const mesh::SurfaceRegions* regions, int threads) {
  std::vector<std::optional<WiredLayout>> done(layouts.size());
  routing::RoutingOptions one_thread = routing;
  if (layouts.size() > 1) one_thread.threads = 1;  // The layouts already occupy the threads.
  in_parallel(threads, layouts.size(), [&](std::size_t k) {
    if (k == 0 || !routing.give_up || !routing.give_up())
      done[k] = priced(surface, std::move(layouts[k]), limits, one_thread, regions);
  });
  std::vector<WiredLayout> wired;
  for (std::optional<WiredLayout>& w : done) {
    if (w) wired.push_back(std::move(*w));
  }
  return wired;
}

std::vector<design::Alternative> front_of(const std::vector<WiredLayout>& wired) {
  std::vector<const WiredLayout*> sorted;
  for (const WiredLayout& w : wired) sorted.push_back(&w);
  std::ranges::stable_sort(sorted, [](const WiredLayout* a, const WiredLayout* b) {
    return a->module_value != b->module_value ? a->module_value > b->module_value : a->price < b->price;
  });
  std::vector<design::Alternative> front;
  for (const WiredLayout* w : sorted) {
    if (w->layout.modules.empty() || (!front.empty() && w->price >= front.back().price - 1e-9)) continue;
    front.push_back({w->layout, w->patches, w->jumpers, w->price, w->module_value});
  }
  return front;
}

}  // namespace triskin::pipeline
