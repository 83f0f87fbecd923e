// SPDX-License-Identifier: GPL-3.0-or-later
// Every number of a design takes extreme values in turn: the readers and the checker must quickly refuse or accept the
// file. Other faults are tested too: lists of a wrong length, unknown keys, values of another type, derived values that
// do not follow from the others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/design_text.hpp"

namespace triskin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Ranges : public testing::Test {
 protected:
  Ranges() : path_(fs::temp_directory_path() / ("range_test." + std::to_string(::getpid()) + ".json")) {
    design::write_design(path_, test::strip(2));
    good_ = json::parse(read_file(path_));
    violations_ = check::check_design(path_).violations.size();
  }
  ~Ranges() override { fs::remove(path_); }

  // Collects pointers to all numbers of the file.
  static void collect(const json& j, const json::json_pointer& at, std::vector<json::json_pointer>& out) {
    if (j.is_number()) out.push_back(at);
    if (j.is_object())
      for (const auto& [key, value] : j.items()) collect(value, at / key, out);
    if (j.is_array())
      for (std::size_t k = 0; k < j.size(); ++k) collect(j[k], at / k, out);
  }
  // Returns true when reader and checker both accepted the file; any exception must name it.
  [[nodiscard]] bool is_taken(const json& document) const {
    const std::string text = document.dump();
    bool taken = true;
    try {
      (void)design::parse_design(text, path_.string());
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr(path_.string()));
      taken = false;
    }
    write(text);
    try {
      (void)check::check_design(path_);
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr(path_.string()));
      taken = false;
    }
    return taken;
  }
  // True when the reader that all commands share refuses the file.
  [[nodiscard]] bool is_refused(const json& document) const {
    try {
      (void)design::parse_design(document.dump(), path_.string());
      return false;
    } catch (const InputError&) {
      return true;
    }
  }
  [[nodiscard]] bool checker_refuses(const json& document) const {
    write(document.dump());
    try {
      return check::check_design(path_).violations.size() > violations_;
    } catch (const InputError&) {
      return true;
    }
  }
  void write(const std::string& text) const {
    fs::remove(path_);  // Truncating and rewriting a file would flush it to the disk, so it is removed first.
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << text;
  }

  fs::path path_;
  json good_;
  std::size_t violations_ = 0;  // The undamaged file, which is no real cover, has this number.
};

TEST_F(Ranges, no_number_crashes_or_stops_a_reader_or_the_checker) {
  ASSERT_TRUE(is_taken(good_));
  std::vector<json::json_pointer> numbers;
  collect(good_, json::json_pointer(), numbers);
  ASSERT_GT(numbers.size(), 200U);
  const std::vector<json> extremes{
      -1e308, 1e308, 1e15, -1e12, 1e12,        1e9,    -1e9,         1e6, 1e-300, -1e-300,
      0,      -1,    127,  255,   2147483647L, 65536L, -2147483648L, 0.5, 1e30,   json(18446744073709551615ULL)};
  std::size_t refused = 0;
  for (const json::json_pointer& at : numbers) {
    for (const json& extreme : extremes) {
      json document = good_;
      document[at] = extreme;
      const std::clock_t before = std::clock();
      if (!is_taken(document)) ++refused;
      // Processor time is measured, so that other programs do not count; the limit for a hang is 2 s of one core.
      const double used_s = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
      EXPECT_LT(used_s, 20.0) << at.to_string() << " = " << extreme;
    }
  }
  EXPECT_GT(refused, numbers.size());
}

TEST_F(Ranges, a_list_of_another_length_is_refused_by_all) {
  for (const char* place : {"/modules/0/taxels/3/position", "/modules/0/taxels/3/normal", "/modules/0/corners/1",
                            "/modules/0/corners", "/modules/0/neighbours", "/modules/0/fold_rad", "/modules/0/taxels",
                            "/surface/vertices/0", "/surface/faces/0"}) {
    const json::json_pointer at(place);
    json longer = good_, shorter = good_;
    longer[at].push_back(longer[at].back());
    shorter[at].erase(shorter[at].size() - 1);
    for (const json& changed : {longer, shorter}) {
      EXPECT_TRUE(is_refused(changed)) << place;
      EXPECT_TRUE(checker_refuses(changed)) << place;
    }
  }
}

TEST_F(Ranges, a_value_of_another_kind_is_refused_by_all) {
  const std::vector<std::pair<const char*, json>> changes{
      {"/modules/0/up", 127},          {"/modules/0/up", "true"},  {"/modules/0/island", 0.5},
      {"/modules/0/corners/0/0", "1"}, {"/surface/faces/0/0", -1}, {"/modules/1/neighbours/0", 2},
      {"/modules/0/i", 1e9},           {"/islands", nullptr},      {"/method", 3}};
  for (const auto& [place, value] : changes) {
    json changed = good_;
    changed[json::json_pointer(place)] = value;
    EXPECT_TRUE(is_refused(changed)) << place << " = " << value;
    EXPECT_TRUE(checker_refuses(changed)) << place << " = " << value;
  }
}

TEST_F(Ranges, an_unknown_key_is_refused_by_all) {
  for (const char* place :
       {"", "/source", "/surface", "/limits", "/modules/0", "/modules/1/taxels/4", "/patches/0", "/report"}) {
    json changed = good_;
    changed[json::json_pointer(place)]["unheard_of"] = 1;
    EXPECT_TRUE(is_refused(changed)) << place;
    EXPECT_TRUE(checker_refuses(changed)) << place;
  }
}

// The file states values that also follow from others.
TEST_F(Ranges, derived_values_are_compared_by_all) {
  std::vector<json> changes(6, good_);
  std::swap(changes[0]["modules"][0]["taxels"][1], changes[0]["modules"][0]["taxels"][2]);
  changes[1]["modules"][0]["taxels"][5]["position"][2] = 0.01;
  changes[2]["modules"][1]["taxels"][5]["normal"] = {0, 0, -1};
  changes[3]["modules"][1]["patch"] = -1;
  changes[4]["modules"][1]["depth"] = 2;
  changes[5]["modules"][0]["overrun_mm"] = -1.0;
  for (std::size_t k = 0; k < changes.size(); ++k) {
    EXPECT_TRUE(k == 4 || is_refused(changes[k])) << k;  // The depth of a module is not read twice.
    EXPECT_TRUE(checker_refuses(changes[k])) << k;
  }
}

}  // namespace
}  // namespace triskin
