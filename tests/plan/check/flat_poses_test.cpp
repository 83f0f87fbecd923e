// SPDX-License-Identifier: GPL-3.0-or-later
// Designs plates, boxes, prisms, ridges and valleys of 20 … 170° in 500 random poses, half of them 1e5 mm from the
// origin: every design must keep every rule, and a damage of each must be found.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "plan/check/damage_kinds.hpp"
#include "plan/check/flat_parts.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::check {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kShapes = 5;

struct PosedPart {
  std::string name;
  design::Mesh mesh;
};

// Makes a part whose shape, size, angle and pose are drawn from `number` alone.
PosedPart posed_part(int number) {
  std::mt19937_64 random(static_cast<std::uint64_t>(number));
  const auto between = [&](double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random);
  };
  const double angle_deg = between(20.0, 170.0);
  const double angle_rad = angle_deg * std::numbers::pi / 180.0;
  const double x = between(60.0, 120.0), y = between(60.0, 120.0), z = between(60.0, 120.0);
  PosedPart part;
  switch (number % kShapes) {
    case 0:
      part = {"plate", parts::ridge(0.7 * x, y, 0.0)};
      break;
    case 1:
      part = {"box", parts::box(x, y, z)};
      break;
    case 2: {
      const int sides = 3 + static_cast<int>(between(0.0, 6.0));
      part = {fmt::format("prism of {} sides", sides), parts::prism(sides, 0.6 * x, y)};
      break;
    }
    case 3:
      part = {fmt::format("ridge of {:.1f}°", angle_deg), parts::ridge(x, y, angle_rad)};
      break;
    default:
      part = {fmt::format("valley of {:.1f}°", angle_deg), parts::ridge(x, y, -angle_rad)};
  }
  const double offset_mm = number / kShapes % 2 == 0 ? 100.0 : 1e5;
  part.name = fmt::format("part {}: {}, {:g} mm from the origin", number, part.name, offset_mm);
  part.mesh = parts::in_pose(std::move(part.mesh), offset_mm, random);
  return part;
}

class PosedCheck {
 public:
  PosedCheck() : folder_(fs::temp_directory_path() / ("flat_poses." + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~PosedCheck() { fs::remove_all(folder_); }
  PosedCheck(const PosedCheck&) = delete;
  PosedCheck& operator=(const PosedCheck&) = delete;

  void expect_truth(int number) {
    const PosedPart part = posed_part(number);
    SCOPED_TRACE(part.name);
    mesh::write_obj(folder_ / "part.obj", part.mesh);
    pipeline::DesignOptions options;
    options.iterations = 3;
    options.time_limit_s = 60.0;
    const design::Design design = pipeline::make_design(folder_ / "part.obj", options).design;
    EXPECT_GE(design.layout.modules.size(), 4U);
    const fs::path file = folder_ / "part.json";
    design::write_design(file, design);
    modules_ += design.layout.modules.size();
    ++designs_;
    for (const Violation& v : check_design(file).violations) {
      ++false_findings_;
      ADD_FAILURE() << v.rule << " " << v.where << " " << v.text;
    }
    damage_one(number, design, json::parse(read_file(file)), file);
  }
  void tell() const {
    std::printf("%d designs, %zu modules: %d false findings; %d of %d damages found\n", designs_, modules_,
                false_findings_, found_, damages_);
  }

 private:
  // Takes the first kind of damage from `number` on that some module can have, at a module drawn from `number`.
  void damage_one(int number, const design::Design& design, const json& good, const fs::path& file) {
    const mesh::Surface surface(design.surface);
    const auto kinds = damage::damage_kinds(surface);
    std::mt19937_64 random(static_cast<std::uint64_t>(number) << 32);
    const std::size_t modules = design.layout.modules.size();
    const std::size_t first = random() % modules;
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      const auto& kind = kinds[(static_cast<std::size_t>(number / kShapes) + k) % kinds.size()];
      for (std::size_t m = 0; m < modules; ++m) {
        json damaged = good;
        if (!kind.apply(damaged, (first + m) % modules)) continue;
        std::ofstream(file) << damaged.dump();
        damage::Names seen;
        for (const Violation& v : check_design(file).violations) seen.insert(v.rule);
        const bool found = std::ranges::any_of(kind.rules, [&](const std::string& r) { return seen.contains(r); });
        ++damages_;
        found_ += found ? 1 : 0;
        EXPECT_TRUE(found) << "module " << (first + m) % modules << " " << kind.name << " broke " << json(seen);
        return;
      }
    }
    ADD_FAILURE() << "no damage could be made";
  }

  fs::path folder_;
  std::size_t modules_ = 0;
  int designs_ = 0, false_findings_ = 0, damages_ = 0, found_ = 0;
};

constexpr int kSample = 10, kBlock = 50, kBlocks = 10;

TEST(FlatPoses, a_sample_of_each_shape_near_and_far) {
  PosedCheck check;
  for (int number = 0; number < kSample; ++number) check.expect_truth(number);
  check.tell();
}

class ManyFlatPoses : public testing::TestWithParam<int> {};
TEST_P(ManyFlatPoses, keep_every_rule_and_damages_are_found) {
  PosedCheck check;
  for (int number = GetParam() * kBlock; number < (GetParam() + 1) * kBlock; ++number) check.expect_truth(number);
  check.tell();
}
INSTANTIATE_TEST_SUITE_P(Blocks, ManyFlatPoses, testing::Range(0, kBlocks));

}  // namespace
}  // namespace triskin::check
