// SPDX-License-Identifier: GPL-3.0-or-later
// The supply at each module: a chain and a fork by hand, and random trees as ngspice solves their circuit.
#include "triskin/design/supply.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "support/random_design.hpp"

namespace triskin {
namespace {

design::Patch tree(const std::vector<int>& parents) {
  design::Patch patch;
  for (std::size_t k = 0; k < parents.size(); ++k)
    patch.modules.push_back({.node = static_cast<int>(k), .parent = parents[k]});
  return patch;
}

// By hand, 10 mA each. A chain of three: the cable of 1 Ω carries 30 mA, the joints of 2 Ω carry 20 and 10 mA.
TEST(Supply, OfAChainByHand) {
  const auto drops = design::supply_drops_v(tree({-1, 0, 1}), 10.0, {1.0, 2.0, 2.0});
  EXPECT_NEAR(drops[0], 0.030, 1e-15);
  EXPECT_NEAR(drops[1], 0.030 + 0.040, 1e-15);
  EXPECT_NEAR(drops[2], 0.030 + 0.040 + 0.020, 1e-15);
}

// A fork: each branch carries its own current only; the longer branch has 1 Ω, then 3 Ω.
TEST(Supply, OfAForkByHand) {
  const auto drops = design::supply_drops_v(tree({-1, 0, 0, 1}), 10.0, {1.0, 1.0, 5.0, 3.0});
  EXPECT_NEAR(drops[0], 0.040, 1e-15);
  EXPECT_NEAR(drops[1], 0.040 + 0.020, 1e-15);
  EXPECT_NEAR(drops[2], 0.040 + 0.050, 1e-15);
  EXPECT_NEAR(drops[3], 0.060 + 0.030, 1e-15);
}

// Cable of 0.5 m with its plugs and a joint, by the figures of docs/routing.md: 0.61 Ω for both modules, 0.23 Ω for
// one.
TEST(Supply, OfTwoModulesByTheFiguresOfThePage) {
  design::Design d;
  d.patches = {tree({-1, 0})};
  const auto volts = design::supply_voltages_v(d, d.patches[0]);
  EXPECT_NEAR(volts[0], 3.2 - 0.61 * 0.002, 1e-12);
  EXPECT_NEAR(volts[1], 3.2 - 0.61 * 0.002 - 0.23 * 0.001, 1e-12);
  EXPECT_EQ(design::lowest_supply(d, d.patches[0]).module, 1);
  d.layout.jumpers = {{.node = {0, 1}, .side = {0, 0}, .length_mm = 200.0}};
  EXPECT_NEAR(design::supply_voltages_v(d, d.patches[0])[1], volts[1] - (0.12 + 0.2 * 0.98) * 0.001, 1e-12);
}

// Supply and ground are two nets with half of each resistance; every converter draws its current between them.
std::string circuit_of(const design::Patch& patch, const std::vector<double>& ohm, const design::SupplyModel& model) {
  std::string text =
      fmt::format("* a patch of {} modules\nVcontroller v_c 0 {}\n", patch.modules.size(), model.supply_v);
  for (std::size_t k = 0; k < patch.modules.size(); ++k) {
    const int node = patch.modules[k].node, parent = patch.modules[k].parent;
    const std::string from_v = parent < 0 ? "v_c" : fmt::format("v{}", parent);
    const std::string from_g = parent < 0 ? "0" : fmt::format("g{}", parent);
    text += fmt::format("Rv{0} {1} v{0} {3:.17g}\nRg{0} {2} g{0} {3:.17g}\nI{0} v{0} g{0} {4:.17g}\n", node, from_v,
                        from_g, ohm[k] / 2.0, model.module_ma * 1e-3);
  }
  text += ".control\nop\nset numdgt=12\n";
  for (const design::RoutedModule& m : patch.modules) text += fmt::format("print v(v{0})-v(g{0})\n", m.node);
  return text + "quit 0\n.endc\n.end\n";
}

TEST(Supply, OfTenRandomTreesAsNgspiceSolvesThem) {
  if (std::system("ngspice --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "ngspice is missing: apt install ngspice";
  constexpr std::uint64_t kSeed = 56;
  std::mt19937_64 random(kSeed);
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("supply.{}", ::getpid());
  std::filesystem::create_directories(folder);
  double worst = 0.0;
  for (int drawn = 0; drawn < 10; ++drawn) {
    const int modules = 4 + static_cast<int>(random() % 13);
    design::Design d = test::random_design(modules, random);
    const design::Patch& patch = d.patches.at(0);
    // Currents and a cable at which the drop is of the size of the supply's tolerance and above.
    const design::SupplyModel model{.module_ma = 1.0 + static_cast<double>(random() % 15),
                                    .cable_m = 0.1 + static_cast<double>(random() % 50) / 10.0};
    const auto circuit = folder / "patch.cir", answer = folder / "answer.txt";
    std::ofstream(circuit) << circuit_of(patch, design::supply_wires_ohm(d, patch, model), model);
    ASSERT_EQ(std::system(fmt::format("ngspice -b '{}' > '{}' 2>&1", circuit.string(), answer.string()).c_str()), 0);
    std::ifstream in(answer);
    std::vector<double> solved;
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with("v(v") && line.find('=') != std::string::npos)
        solved.push_back(std::stod(line.substr(line.find('=') + 1)));
    }
    const std::vector<double> volts = design::supply_voltages_v(d, patch, model);
    ASSERT_EQ(solved.size(), volts.size()) << "seed " << kSeed << ", tree " << drawn;
    for (std::size_t k = 0; k < volts.size(); ++k) {
      // 1 % of the drop, which is stricter than 1 % of the voltage.
      const double drop = model.supply_v - solved[k];
      EXPECT_NEAR(model.supply_v - volts[k], drop, 0.01 * drop)
          << "seed " << kSeed << ", tree " << drawn << ", row " << k;
      worst = std::max(worst, std::abs(model.supply_v - volts[k] - drop) / drop);
    }
  }
  std::filesystem::remove_all(folder);
  std::printf("ten trees: the drops differ from ngspice's by at most %.2g %%\n", 100.0 * worst);
}

}  // namespace
}  // namespace triskin
