// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <functional>
#include <random>
#include <set>
#include <vector>

#include "triskin/hardware/switched_patch.hpp"
#include "triskin/logic/switched/topology.hpp"

namespace triskin::test {

using hardware::SwitchedPatch;

struct RandomPatch {
  design::PortEnds joints;
  int cable_port = 0;
  [[nodiscard]] int size() const { return static_cast<int>(joints.size()); }
  [[nodiscard]] SwitchedPatch::End end(int m, int p) const {
    return joints[static_cast<std::size_t>(m)][static_cast<std::size_t>(p)];
  }
  /// Lists each joint once.
  [[nodiscard]] std::vector<SwitchedPatch::End> joint_ends() const {
    std::vector<SwitchedPatch::End> list;
    for (int m = 0; m < size(); ++m) {
      for (int p = 0; p < 3; ++p) {
        if (end(m, p).row > m) list.push_back({layout::TableRow{m}, p});
      }
    }
    return list;
  }
};

inline int free_port(const RandomPatch& patch, int m, std::mt19937_64& random) {
  std::vector<int> free;
  for (int p = 0; p < 3; ++p) {
    if (patch.end(m, p).row < 0 && !(m == 0 && p == patch.cable_port)) free.push_back(p);
  }
  return free.empty() ? -1 : free[random() % free.size()];
}

inline bool joined(const RandomPatch& patch, int a, int b) {
  return std::any_of(patch.joints[static_cast<std::size_t>(a)].begin(), patch.joints[static_cast<std::size_t>(a)].end(),
                     [&](auto e) { return e.row == b; });
}

inline bool add_joint(RandomPatch& patch, int a, int b, std::mt19937_64& random) {
  if (a == b || joined(patch, a, b)) return false;
  const int p = free_port(patch, a, random), q = free_port(patch, b, random);
  if (p < 0 || q < 0) return false;
  patch.joints[static_cast<std::size_t>(a)][static_cast<std::size_t>(p)] = {layout::TableRow{b}, q};
  patch.joints[static_cast<std::size_t>(b)][static_cast<std::size_t>(q)] = {layout::TableRow{a}, p};
  return true;
}

/// Makes a random tree with random ports, then adds up to `cycles` more joints; it is more tangled than modules on a
/// surface can be.
inline RandomPatch random_patch(int modules, int cycles, std::mt19937_64& random) {
  RandomPatch patch;
  patch.joints.resize(1);
  patch.cable_port = static_cast<int>(random() % 3);
  while (patch.size() < modules) {
    patch.joints.emplace_back();
    const int child = patch.size() - 1;
    while (!add_joint(patch, static_cast<int>(random() % static_cast<std::uint64_t>(child)), child, random)) {
    }
  }
  const auto n = static_cast<std::uint64_t>(modules);
  for (int tries = 0; tries < 200 && cycles > 0; ++tries) {
    if (add_joint(patch, static_cast<int>(random() % n), static_cast<int>(random() % n), random)) --cycles;
  }
  return patch;
}

/// Connects the firmware's port to the modelled modules.
class ModelledChain final : public fw::RouteChain {
 public:
  explicit ModelledChain(SwitchedPatch& patch) : patch_(patch) {}
  void enable(std::uint8_t cables) override { patch_.enable(cables); }
  void exchange(Bytes out, std::span<std::uint8_t> in) override {
    ++exchanges;
    patch_.exchange(out, in);
  }
  void latch() override {
    patch_.latch();
    if (watch) watch();
  }
  std::uint8_t stuck_lines() override { return patch_.stuck_lines(); }

  int exchanges = 0;
  std::function<void()> watch;  ///< The model calls this in every settled state.

 private:
  SwitchedPatch& patch_;
};

inline fw::PatchGraph table_of(const RandomPatch& patch) {
  fw::PatchGraph graph;
  graph.count = static_cast<std::uint8_t>(patch.size());
  graph.cable_port = static_cast<std::uint8_t>(patch.cable_port);
  for (std::size_t m = 0; m < patch.joints.size(); ++m) {
    for (std::size_t p = 0; p < 3; ++p) {
      const auto e = patch.joints[m][p];
      if (e.row >= 0) graph.joint[m][p] = {static_cast<std::uint8_t>(e.row), static_cast<std::uint8_t>(e.port)};
    }
  }
  return graph;
}

/// Renumbers the modules of the same graph in the order of a walk from the entry, ports A, B, C: isomorphic graphs
/// become equal.
inline fw::PatchGraph canonical(const fw::PatchGraph& g) {
  std::vector<int> number(layout::kMaxModules, -1);
  std::vector<std::size_t> queue;
  if (g.count > 0) {
    queue.push_back(0);
    number[0] = 0;
  }
  for (std::size_t k = 0; k < queue.size(); ++k) {
    for (const auto& e : g.joint[queue[k]]) {
      if (e.module == fw::kNoModule || number[e.module] >= 0) continue;
      number[e.module] = static_cast<int>(queue.size());
      queue.push_back(e.module);
    }
  }
  fw::PatchGraph out;
  out.count = g.count;
  out.cable_port = g.cable_port;
  for (std::size_t k = 0; k < queue.size(); ++k) {
    for (std::size_t p = 0; p < 3; ++p) {
      const auto e = g.joint[queue[k]][p];
      if (e.module != fw::kNoModule) out.joint[k][p] = {static_cast<std::uint8_t>(number[e.module]), e.port};
    }
  }
  return out;
}

}  // namespace triskin::test
