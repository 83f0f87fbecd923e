// SPDX-License-Identifier: GPL-3.0-or-later
// A foreign reader, @mcap/core, opens whole, cut and recovered recordings and must find all CRCs right. `tools/setup
// test` installs it if npm is there; without it the test is skipped.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>

#include "recorded.hpp"
#include "support/places.hpp"
#include "triskin/base/files.hpp"

namespace triskin::recording {
namespace {

namespace fs = std::filesystem;

// Returns the folder with node_modules/@mcap/core; empty if there is none.
fs::path modules_folder() {
  const char* given = std::getenv("TRISKIN_NPM");
  const fs::path folder = given != nullptr ? fs::path(given) : fs::path(test::source_folder()) / "build" / "npm";
  return fs::exists(folder / "node_modules/@mcap/core") ? folder : fs::path{};
}

// Returns the output of the witness for a file: messages read in order, messages found by the index, topics.
std::string ask(const fs::path& modules, const fs::path& file, const fs::path& out) {
  const fs::path script = modules / "read_recording.mjs";  // Node looks for packages beside the script.
  std::error_code none;
  fs::copy_file(fs::path(test::source_folder()) / "tests/recording/read_recording.mjs", script,
                fs::copy_options::overwrite_existing, none);
  const std::string line = "node '" + script.string() + "' '" + file.string() + "' > '" + out.string() + "' 2>&1";
  const int status = std::system(line.c_str());
  return WEXITSTATUS(status) == 0 ? triskin::read_file(out) : "failed: " + triskin::read_file(out);
}

TEST(Witness, mcap_core_reads_whole_cut_and_recovered_recordings) {
  const fs::path modules = modules_folder();
  if (modules.empty() || std::system("node --version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "@mcap/core is not installed; run tools/setup test where npm is there";
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

}  // namespace
}  // namespace triskin::recording
