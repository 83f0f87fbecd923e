// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels for AVX-512, AVX2 and plain processors must give the same answers to the last bit, by the same steps.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "polygons.hpp"
#include "support/places.hpp"

namespace triskin {
namespace {

nlohmann::json answer(const std::string& unit, const std::filesystem::path& outline, const std::string& options) {
  const std::string command =
      "TRISKIN_VECTOR_UNIT=" + unit + " " + test::program_file() + " place " + outline.string() + " --json " + options;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  std::array<char, 4096> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe.get())) text.append(buffer.data(), n);
  nlohmann::json json = nlohmann::json::parse(text);
  json.erase("seconds");
  json.erase("search_seconds");
  return json;
}

TEST(VectorUnits, agree_bit_for_bit) {
  std::mt19937_64 random(61);
  const auto file = std::filesystem::path(testing::TempDir()) / "triskin_vector_unit.geojson";
  for (int k = 0; k < 4; ++k) {
    const auto p = test::random_polygon(random, 20 + 10 * k, 150, k % 2);
    nlohmann::json rings = nlohmann::json::array();
    const auto add = [&](std::vector<design::Vec2> ring) {
      ring.push_back(ring.front());
      nlohmann::json points = nlohmann::json::array();
      for (const auto& v : ring) points.push_back({v.x(), v.y()});
      rings.push_back(points);
    };
    add(p.outer);
    for (const auto& hole : p.holes) add(hole);
    std::ofstream(file) << nlohmann::json{{"type", "Polygon"}, {"coordinates", rings}};
    for (const std::string options :
         {"--deficit", "--no-clearance --corner-cut-mm 3", "--shape hexagon", "--shape square --gap-mm 1"}) {
      const nlohmann::json plain = answer("plain", file, options);
      EXPECT_GT(plain.at("evaluations").get<int>(), 0);
      EXPECT_EQ(answer("avx2", file, options), plain) << options;
      EXPECT_EQ(answer("avx512", file, options), plain) << options;
    }
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace triskin
