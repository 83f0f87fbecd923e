// SPDX-License-Identifier: GPL-3.0-or-later
#include "choose_layout.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

#include "triskin/design/module_graph.hpp"
#include "triskin/geometry/jumpers.hpp"

namespace triskin::pipeline {
namespace {

void wire_quickly(const geometry::Surface& surface, const design::LayoutLimits& limits,
                  const geometry::RoutingOptions& routing, WiredLayout& wired) {
  wired.places = geometry::find_jumpers(surface, wired.layout, limits);
  geometry::RoutingOptions quick = routing;
  quick.failure_analysis = false;
  quick.recombinations = 0;
  const geometry::RoutingResult r = geometry::route(design::graph_of(wired.layout), wired.places, quick);
  wired.patches = static_cast<int>(r.patches.size());
  wired.jumpers = static_cast<int>(r.jumpers.size());
  wired.price = routing.price.of(wired.patches, wired.jumpers, wired.layout.islands);
}

}  // namespace

std::vector<WiredLayout> by_value(const geometry::Surface& surface, std::vector<design::ModuleLayout> layouts,
                                  const design::LayoutLimits& limits, const geometry::RoutingOptions& routing,
                                  int threads) {
  std::vector<WiredLayout> wired(layouts.size());
  for (std::size_t k = 0; k < layouts.size(); ++k) wired[k].layout = std::move(layouts[k]);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t k = next++; k < wired.size(); k = next++) wire_quickly(surface, limits, routing, wired[k]);
  };
  {
    std::vector<std::jthread> others;
    for (int k = 1; k < threads; ++k) others.emplace_back(work);
    work();
  }
  std::ranges::stable_sort(wired, std::greater{}, &WiredLayout::value);
  return wired;
}

std::vector<design::Alternative> front_of(const std::vector<WiredLayout>& wired) {
  std::vector<const WiredLayout*> sorted;
  for (const WiredLayout& w : wired) sorted.push_back(&w);
  std::ranges::stable_sort(sorted, [](const WiredLayout* a, const WiredLayout* b) {
    return a->layout.modules.size() != b->layout.modules.size() ? a->layout.modules.size() > b->layout.modules.size()
                                                                : a->price < b->price;
  });
  std::vector<design::Alternative> front;
  for (const WiredLayout* w : sorted) {
    if (w->layout.modules.empty() || (!front.empty() && w->price >= front.back().price - 1e-9)) continue;
    front.push_back({w->layout, w->patches, w->jumpers, w->price});
  }
  return front;
}

}  // namespace triskin::pipeline
