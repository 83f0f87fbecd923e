// SPDX-License-Identifier: GPL-3.0-or-later
// A recording must tell which controller read each module at which time, including modules that a neighbour adopts.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "app/cli/shell_case.hpp"
#include "joined_patches.hpp"
#include "support/places.hpp"
#include "triskin/base/files.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/hardware/sim_link.hpp"
#include "triskin/hdf5/recording.hpp"
#include "triskin/hdf5/taxel_table.hpp"
#include "triskin/recording/recorder.hpp"
#include "triskin/recording/recording.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::test {
namespace {

class AdoptionRecording : public ShellCase {
 protected:
  using Sample = std::pair<int, std::uint64_t>;  // The pair is the module and its arrival time.

  // A module fails after half a second, and is whole again two seconds later.
  void record() {
    hardware::Scene scene = scene_of(design_);
    hardware::SimLink link(std::move(scene));
    session::Bus bus(link);
    deploy::flash(bus, design_);
    bus.listen(bus.now_us() + 3'000'000);
    design::write_design(folder_ / "design.json", design_);
    recording::OutputFile file(folder_ / "adoption.mcap");
    recording::Origin origin;
    origin.design_text = read_file(folder_ / "design.json");
    origin.link_start_us = bus.now_us();
    origin.unix_start_ns = 1'700'000'000'000'000'000;
    const auto recorder = recording::make_recorder(recording::Format::kMcap, file, design_, origin);
    recording::OutputFile csv_file(folder_ / "adoption.csv"), hdf5_file(folder_ / "adoption.h5");
    std::vector<std::unique_ptr<recording::Recorder>> others;
    others.push_back(recording::make_recorder(recording::Format::kCsv, csv_file, design_, origin));
    if (hdf5::can_write()) others.push_back(hdf5::make_recorder(hdf5_file, design_, origin));
    session::Stream stream(bus, design_, [&](const session::ModuleSample& f) {
      recorder->add({f.module, f.link_time_us, f.sample});
      for (const auto& other : others) other->add({f.module, f.link_time_us, f.sample});
      adopter_[{f.module, f.link_time_us}] = f.adopter;
      if (f.sample.valid == 0) empty_.insert({f.module, f.link_time_us});
    });
    auto& hardware = link.skin().switched();
    const auto run_us = [&](std::uint64_t us) { stream.run_until(bus.now_us() + us); };
    run_us(500'000);
    failed_us_ = bus.now_us();
    hardware.patch(layout::PatchIndex{0}).set_dead(hardware.row_of(layout::ModuleId{unreachable_.dead}), true);
    run_us(2'000'000);
    whole_us_ = bus.now_us();
    hardware.patch(layout::PatchIndex{0}).set_dead(hardware.row_of(layout::ModuleId{unreachable_.dead}), false);
    run_us(5'000'000);
    stream.finish();
    recorder->finish({{"status", "complete"}});
    for (const auto& other : others) other->finish({});
    others.clear();
    file.close();
    csv_file.close();
  }

  const design::Design design_ = joined_patches(4, 8);
  const Unreachable unreachable_ = unreachable_of(design_).front();
  std::map<Sample, int> adopter_;  // The stream reported these adopters.
  std::set<Sample> empty_;         // For these samples the controller did not reach the module.
  std::uint64_t failed_us_ = 0, whole_us_ = 0;
};

TEST_F(AdoptionRecording, says_who_read_each_module_at_each_time) {
  record();
  std::size_t adopted = 0, read = 0;
  const recording::Summary summary =
      recording::read_recording(folder_ / "adoption.mcap", [&](const recording::ModuleSample& s) {
        const auto truth = adopter_.find({s.module, s.link_time_us});
        ASSERT_NE(truth, adopter_.end());
        EXPECT_EQ(s.adopter, truth->second) << "module " << s.module << " at " << s.link_time_us;
        adopted += s.adopter >= 0 ? 1 : 0;
        ++read;
      });
  EXPECT_EQ(read, adopter_.size());
  EXPECT_GE(adopted, 20 * unreachable_.modules.size());
  // Each unreachable module moved to a neighbour and back, and nothing else changed its reader.
  std::map<int, std::vector<recording::ReaderChange>> changes;
  for (const auto& c : summary.reader_changes) changes[c.module].push_back(c);
  EXPECT_EQ(changes.size(), unreachable_.modules.size());
  for (const int m : unreachable_.modules) {
    ASSERT_EQ(changes[m].size(), 2U) << m;
    const auto& [there, back] = std::pair(changes[m][0], changes[m][1]);
    EXPECT_NE(there.reader.patch, unreachable_.patch);
    EXPECT_EQ(there.reader.node, there.reader.patch + 1);
    EXPECT_FALSE(there.own);
    EXPECT_GT(there.link_time_us, failed_us_);
    EXPECT_LT(there.link_time_us, failed_us_ + 1'500'000);
    EXPECT_EQ(back.reader,
              (recording::Reader{layout::PatchIndex{unreachable_.patch}, layout::NodeAddress{unreachable_.patch + 1}}));
    EXPECT_TRUE(back.own);
    EXPECT_GT(back.link_time_us, whole_us_);
    // Checks by time that the reader in the changes read every sample with data of the module. Until the stream knows
    // its adopter, its own controller reports that it cannot reach it.
    for (const auto& [sample, adopter] : adopter_) {
      if (sample.first != m || empty_.contains(sample)) continue;
      const bool away = sample.second >= there.link_time_us && sample.second < back.link_time_us;
      EXPECT_EQ(adopter, away ? there.reader.patch : -1) << m << " at " << sample.second;
    }
  }
}

// Returns the fields of the lines of a CSV file, by name of the column.
std::vector<std::map<std::string, std::string>> lines_of(const std::string& text) {
  const auto split = [](const std::string& line) {
    std::vector<std::string> fields(1);
    for (const char c : line) c == ',' ? fields.emplace_back() : fields.back() += c;
    return fields;
  };
  std::istringstream in(text);
  std::string line;
  std::getline(in, line);
  const auto names = split(line);
  std::vector<std::map<std::string, std::string>> list;
  while (std::getline(in, line)) {
    const auto fields = split(line);
    EXPECT_EQ(fields.size(), names.size()) << line;
    for (auto& row = list.emplace_back(); const std::string& name : names) row[name] = fields[row.size()];
  }
  return list;
}

TEST_F(AdoptionRecording, as_csv_and_hdf5_says_who_read_each_sample) {
  record();
  const auto own = design::wiring_of(design_);
  std::size_t adopted = 0;
  const auto lines = lines_of(read_file(folder_ / "adoption.csv"));
  ASSERT_EQ(lines.size(), adopter_.size());
  for (auto line : lines) {
    const int module = std::stoi(line["module"]);
    const int truth = adopter_.at({module, std::stoull(line["link_time_us"])});
    const int patch = truth >= 0 ? truth : own[static_cast<std::size_t>(module)].patch;
    ASSERT_EQ(line["reader_patch"], std::to_string(patch)) << "module " << module << " at " << line["link_time_us"];
    ASSERT_EQ(line["reader_node"], std::to_string(patch + 1));
    adopted += truth >= 0 ? 1 : 0;
  }
  EXPECT_GE(adopted, 20 * unreachable_.modules.size());
  if (!hdf5::can_write()) GTEST_SKIP() << "built without HDF5";
  const std::string script = test::source_folder() + "/tests/output/hdf5/recording_test.py";
  const int status = std::system(
      fmt::format("python3 {} --compare {}/adoption.h5 {}/adoption.csv", script, folder_.string(), folder_.string())
          .c_str());
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "h5py is missing";
  EXPECT_EQ(status, 0);
}

TEST_F(AdoptionRecording, replay_shows_who_read_a_module) {
  record();
  const Outcome o = run("replay adoption.mcap --speed 0 --json");
  ASSERT_EQ(o.status, 0) << o.messages;
  std::vector<nlohmann::json> lines;
  for (std::size_t at = 0; at < o.out.size(); at = o.out.find('\n', at) + 1)
    lines.push_back(nlohmann::json::parse(o.out.substr(at, o.out.find('\n', at) - at)));
  const std::set<int> unreachable_modules(unreachable_.modules.begin(), unreachable_.modules.end());
  bool any = false;
  for (const auto& line : lines) {
    if (!line.contains("adopted")) continue;
    any = true;
    for (const auto& a : line["adopted"])
      EXPECT_TRUE(unreachable_modules.contains(a["module"].get<int>())) << line.dump();
  }
  EXPECT_TRUE(any);
  EXPECT_FALSE(lines.back().contains("adopted"));  // All modules are back.
  EXPECT_EQ(lines.back()["readers"].size(), 2 * unreachable_modules.size());
  const Outcome said = run("replay adoption.mcap --speed 0");
  EXPECT_NE(said.out.find(fmt::format("module {} is read by its own, the controller of patch {}",
                                      unreachable_.modules.front(), unreachable_.patch)),
            std::string::npos)
      << said.out;
}

}  // namespace
}  // namespace triskin::test
