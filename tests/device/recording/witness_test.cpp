// SPDX-License-Identifier: GPL-3.0-or-later
// Foreign readers open recordings: @mcap/core reads whole, cut and recovered ones and must find all CRCs right, and
// Foxglove's decoder reads every message by the definition in the file. `tools/setup test` installs them if npm is
// there; without them the tests are skipped.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "recorded.hpp"
#include "support/places.hpp"
#include "triskin/base/files.hpp"

namespace triskin::recording {
namespace {

namespace fs = std::filesystem;

// Returns the folder whose node_modules has this package; empty if there is none or no Node.
fs::path modules_folder(const char* package) {
  const char* given = std::getenv("TRISKIN_NPM");
  const fs::path folder = given != nullptr ? fs::path(given) : fs::path(test::source_folder()) / "build" / "npm";
  const bool is_there = fs::exists(folder / "node_modules" / package);
  return is_there && std::system("node --version > /dev/null 2>&1") == 0 ? folder : fs::path{};
}

// Returns the output of a witness for a file. read_recording.mjs says the messages read in order, those found by the
// index, and the topics.
std::string ask(const fs::path& modules, const fs::path& file, const fs::path& out,
                const char* witness = "read_recording.mjs") {
  const fs::path script = modules / witness;  // Node looks for packages beside the script.
  std::error_code none;
  fs::copy_file(fs::path(test::source_folder()) / "tests/device/recording" / witness, script,
                fs::copy_options::overwrite_existing, none);
  const std::string line = "node '" + script.string() + "' '" + file.string() + "' > '" + out.string() + "' 2>&1";
  const int status = std::system(line.c_str());
  return WEXITSTATUS(status) == 0 ? triskin::read_file(out) : "failed: " + triskin::read_file(out);
}

TEST(Witness, mcap_core_reads_whole_cut_and_recovered_recordings) {
  const fs::path modules = modules_folder("@mcap/core");
  if (modules.empty()) GTEST_SKIP() << "@mcap/core is not installed; run tools/setup test where npm is there";
  const Folder folder("witness");
  Origin with_cloud = origin();
  with_cloud.cloud_period_us = 100'000;
  record_samples(folder / "r.mcap", test::strip(20), 2'000, with_cloud);
  // 100 samples of 20 modules are 3.7 s: 200 raw frames of two controllers; a cloud with every third sample, the first
  // after 100 ms, which makes 34; one layout; the readers at the beginning.
  EXPECT_EQ(ask(modules, folder / "r.mcap", folder / "out"),
            "read 236, indexed 236, /skin/contacts /skin/layout /skin/points /skin/raw /skin/readers, attachment "
            "design.json, "
            "metadata triskin triskin_result\n");
  const std::string whole = triskin::read_file(folder / "r.mcap");
  write_file_atomically(folder / "cut.mcap", whole.substr(0, whole.size() / 2));
  const std::string cut = ask(modules, folder / "cut.mcap", folder / "out");
  Summary summary;
  (void)samples_of(folder / "cut.mcap", &summary);
  EXPECT_EQ(cut, "read " + std::to_string(summary.file.messages) + ", no index\n");
  (void)recover(folder / "cut.mcap", {});
  const std::string count = std::to_string(summary.file.messages);
  EXPECT_EQ(ask(modules, folder / "cut.mcap", folder / "out"),
            "read " + count + ", indexed " + count +
                ", /skin/contacts /skin/layout /skin/points /skin/raw /skin/readers, attachment design.json, metadata "
                "triskin\n");
}

// A cover of a robot, of which the decoder knows nothing but the file. All figures follow from sample_of() and strip().
TEST(Witness, every_message_is_decoded_by_the_definition_in_the_file) {
  const fs::path modules = modules_folder("@foxglove/rosmsg2-serialization");
  if (modules.empty()) GTEST_SKIP() << "the decoder is not installed; run tools/setup test where npm is there";
  constexpr std::uint64_t kSamples = 2'000;
  const Folder folder("decode");
  Origin from = origin();
  from.cloud_period_us = 100'000;
  from.part = "arm";
  from.parent_frame = "base_link";
  const design::Design design = test::strip(20);
  record_samples(folder / "r.mcap", design, kSamples, from);
  const std::string said = ask(modules, folder / "r.mcap", folder / "out", "decode_recording.mjs");
  std::map<std::string, nlohmann::json> topics;
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    nlohmann::json fact = nlohmann::json::parse(line, nullptr, false);
    ASSERT_FALSE(fact.is_discarded()) << said;
    const auto topic = fact["topic"].get<std::string>();
    topics[topic] = std::move(fact);
  }
  double counts = 0.0;
  for (std::uint64_t k = 0; k < kSamples; ++k) {
    for (const std::uint16_t value : sample_of(k, 20).sample.value) counts += value;
  }
  EXPECT_EQ(topics["/skin/arm/raw"]["messages"], 200) << said;
  EXPECT_EQ(topics["/skin/arm/raw"]["samples"], kSamples);
  EXPECT_EQ(topics["/skin/arm/raw"]["counts"], counts);
  EXPECT_EQ(topics["/skin/arm/layout"]["position"], 20 * 36);
  EXPECT_EQ(topics["/skin/arm/layout"]["frame"], "skin_arm");
  const auto& points = topics["/skin/arm/points"];
  EXPECT_EQ(points["type"], "sensor_msgs/msg/PointCloud2");
  EXPECT_EQ(points["messages"], 34);
  EXPECT_EQ(points["points"], 20 * 12);
  EXPECT_EQ(points["fits"], true);
  EXPECT_EQ(points["frame"], "skin_arm");
  EXPECT_EQ(points["first_mm"], topics["/skin/arm/layout"]["first_mm"]);
  EXPECT_EQ(topics["/tf_static"]["frames"], nlohmann::json::array({"base_link>skin_arm"}));
}

}  // namespace
}  // namespace triskin::recording
