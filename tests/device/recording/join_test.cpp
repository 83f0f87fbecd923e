// SPDX-License-Identifier: GPL-3.0-or-later
// These tests join recordings of several covers into one file for viewers.
#include "triskin/recording/join.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "device/recording/recorded.hpp"
#include "triskin/recording/mcap_file.hpp"

namespace triskin::recording {
namespace {

using test::strip;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

// The summary of a file has topics with the times of their messages, and names of attachments and tables.
class Contents final : public mcap::Visitor {
 public:
  explicit Contents(const std::filesystem::path& path)
      : report_(mcap::read_file(InputFile(path), path.string(), *this)) {}
  void on_channel(const mcap::Channel& c) override {
    EXPECT_TRUE(topics_.insert(c.topic).second) << c.topic << " has two channels";
    names_[c.id] = c.topic;
  }
  void on_message(const mcap::Message& m) override {
    times[names_.at(m.channel)].push_back(m.log_ns);
    all_times.push_back(m.log_ns);
  }
  void on_attachment(const mcap::Attachment& a) override { attachments.push_back(a.name); }
  void on_metadata(const mcap::Metadata& m) override { tables.push_back(m.name); }
  [[nodiscard]] const mcap::ReadReport& report() const { return report_; }

  std::map<std::string, std::vector<std::uint64_t>> times;
  std::vector<std::uint64_t> all_times;
  std::vector<std::string> attachments, tables;

 private:
  std::set<std::string> topics_;
  std::map<std::uint16_t, std::string> names_;
  mcap::ReadReport report_;
};

Origin of_part(const std::string& part) {
  Origin from = origin();
  from.part = part;
  from.parent_frame = "base_link";
  return from;
}

TEST(Join, has_every_message_of_both_covers_about_in_order) {
  const Folder folder("join");
  record_samples(folder / "arm.mcap", strip(20), 4'000, of_part("arm"));
  record_samples(folder / "leg.mcap", strip(20), 2'000, of_part("leg"));
  const Contents arm(folder / "arm.mcap"), leg(folder / "leg.mcap");
  OutputFile file(folder / "robot.mcap");
  const std::vector<JoinPart> parts{{"arm", folder / "arm.mcap"}, {"leg", folder / "leg.mcap"}};
  const std::uint64_t messages = join(parts, file);
  file.close();
  const Contents robot(folder / "robot.mcap");
  EXPECT_TRUE(robot.report().complete);
  EXPECT_EQ(messages, arm.all_times.size() + leg.all_times.size());
  for (const auto& [topic, times] : arm.times) {
    if (topic == "/tf_static") continue;
    EXPECT_EQ(robot.times.at(topic), times) << topic;
  }
  EXPECT_EQ(robot.times.at("/skin/leg/raw"), leg.times.at("/skin/leg/raw"));
  EXPECT_EQ(robot.times.at("/tf_static").size(), 2U) << "the place of each cover, on one channel";
  EXPECT_THAT(robot.attachments, UnorderedElementsAre("arm/design.json", "leg/design.json"));
  EXPECT_THAT(robot.tables,
              UnorderedElementsAre("triskin/arm", "triskin_result/arm", "triskin/leg", "triskin_result/leg"));
  // A message may be later than one behind it by at most the span of a chunk.
  std::uint64_t latest = 0;
  for (const std::uint64_t ns : robot.all_times) {
    EXPECT_GE(ns + mcap::ChunkLimits{}.span_ns, latest);
    latest = std::max(latest, ns);
  }
}

// The modules have the same numbers on each cover, so a reader of one cover would mix them.
TEST(Join, a_joint_file_is_not_read_as_one_cover) {
  const Folder folder("join");
  record_samples(folder / "arm.mcap", strip(4), 100, of_part("arm"));
  record_samples(folder / "leg.mcap", strip(4), 100, of_part("leg"));
  OutputFile file(folder / "robot.mcap");
  const std::vector<JoinPart> parts{{"arm", folder / "arm.mcap"}, {"leg", folder / "leg.mcap"}};
  (void)join(parts, file);
  file.close();
  try {
    (void)read_recording(folder / "robot.mcap", {});
    ADD_FAILURE() << "it was read";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("holds several covers"));
  }
}

}  // namespace
}  // namespace triskin::recording
