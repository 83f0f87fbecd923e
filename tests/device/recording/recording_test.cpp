// SPDX-License-Identifier: GPL-3.0-or-later
// A recording must read back what was written, even from a file that was cut or damaged anywhere.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "recorded.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/design_text.hpp"

namespace triskin::recording {
namespace {

using test::strip;

// Collects the chunks of a file with the times of their first and last message.
class Chunks final : public mcap::Visitor {
 public:
  void on_message(const mcap::Message& m) override { log_ns.push_back(m.log_ns); }
  std::vector<std::uint64_t> log_ns;
};

std::vector<ModuleSample> first(std::uint64_t count, int modules) {
  std::vector<ModuleSample> samples;
  for (std::uint64_t k = 0; k < count; ++k) samples.push_back(sample_of(k, modules));
  return samples;
}

// Returns the samples of one controller in their given order, because the file groups them by controller.
std::vector<ModuleSample> of_node(const std::vector<ModuleSample>& all, int node) {
  std::vector<ModuleSample> some;
  std::ranges::copy_if(all, std::back_inserter(some),
                       [&](const ModuleSample& s) { return s.sample.node_address == node; });
  return some;
}

TEST(Recording, every_sample_comes_back_as_it_was) {
  const Folder folder("recording");
  const design::Design design = strip(20);
  record_samples(folder / "r.mcap", design, 2'000);
  Summary summary;
  const auto read = samples_of(folder / "r.mcap", &summary);
  const auto written = first(2'000, 20);
  for (const int node : {1, 2}) EXPECT_EQ(of_node(read, node), of_node(written, node)) << node;
  EXPECT_EQ(summary.samples, 2'000U);
  EXPECT_TRUE(summary.file.complete) << summary.file.problem;
  EXPECT_EQ(summary.result.at("status"), "complete");
  EXPECT_EQ(summary.facts.at("design_id"), fmt::format("{:016x}", design.design_id));
  EXPECT_EQ(summary.design_text, origin().design_text);
}

// In the file module 5 of the gapped strip has its number, 12; a reader of the whole recording gets the index again.
TEST(Recording, modules_are_named_by_number) {
  const Folder folder("recording");
  const design::Design design = test::with_gaps(strip(8));
  Origin from = origin();
  from.design_text = design::design_text(design);
  record_samples(folder / "r.mcap", design, 16, from);
  EXPECT_EQ(samples_of(folder / "r.mcap"), first(16, 8));
  const std::vector<ModuleSample> one{sample_of(5, 8)};
  const std::vector<std::uint8_t> message = encode_raw(one, design.layout.numbers);
  const auto seen = [&](std::span<const int> numbers) { return decode_raw(message, numbers).value().at(0).module; };
  EXPECT_EQ(seen({}), 12);
  EXPECT_EQ(seen(design.layout.numbers), 5);
  EXPECT_EQ(seen(std::array{0, 1}), -1) << "another design";
}

TEST(Recording, modules_of_one_sample_share_a_message) {
  const Folder folder("recording");
  record_samples(folder / "r.mcap", strip(20), 2'000);
  Chunks chunks;
  const InputFile file(folder / "r.mcap");
  (void)mcap::read_file(file, "r.mcap", chunks);
  // There are layout and readers, and two controllers per sample.
  EXPECT_EQ(chunks.log_ns.size(), 2U + 2 * 2'000 / 20);
  // The values and the validity of a module take 26 bytes; everything else together costs less than that again.
  EXPECT_LT(file.size(), 2'000U * 2 * 26 + 40'000);
}

// Collects the topics of a file with the bytes of their messages.
class Topics final : public mcap::Visitor {
 public:
  void on_channel(const mcap::Channel& channel) override { names_[channel.id] = channel.topic; }
  void on_message(const mcap::Message& m) override {
    messages[names_.at(m.channel)].emplace_back(m.data.begin(), m.data.end());
  }
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> messages;

 private:
  std::map<std::uint16_t, std::string> names_;
};

bool holds(const std::vector<std::uint8_t>& message, std::string_view text) {
  return !std::ranges::search(message, text).empty();
}

// Two covers of a robot in one viewer each have their own topics and frame, and the frame has its place.
TEST(Recording, of_a_cover_on_a_robot_has_its_own_topics_and_frame) {
  const Folder folder("recording");
  Origin from = origin();
  from.part = "left_arm";
  from.parent_frame = "base_link";
  from.pose = {{0.5, 0.0, -0.25}, {0.0, 0.0, 1.0, 0.0}};
  from.cloud_period_us = 200'000;
  record_samples(folder / "r.mcap", strip(20), 400, from);
  Topics topics;
  (void)mcap::read_file(InputFile(folder / "r.mcap"), "r.mcap", topics);
  ASSERT_EQ(topics.messages["/tf_static"].size(), 1U);
  for (const char* topic : {"/skin/left_arm/raw", "/skin/left_arm/layout", "/skin/left_arm/points"})
    EXPECT_FALSE(topics.messages[topic].empty()) << topic;
  for (const char* topic : {"/skin/left_arm/layout", "/skin/left_arm/points", "/tf_static"})
    EXPECT_TRUE(holds(topics.messages[topic].front(), std::string_view("skin_left_arm", 14))) << topic;
  // By hand: 0.5 is 0x3FE0'0000'0000'0000 and -0.25 is 0xBFD0'0000'0000'0000, with seven numbers of eight bytes at the
  // end.
  const auto& tf = topics.messages["/tf_static"].front();
  ASSERT_GE(tf.size(), 56U);
  const std::vector<std::uint8_t> x(tf.end() - 56, tf.end() - 48), z(tf.end() - 40, tf.end() - 32);
  EXPECT_THAT(x, testing::ElementsAre(0, 0, 0, 0, 0, 0, 0xE0, 0x3F));
  EXPECT_THAT(z, testing::ElementsAre(0, 0, 0, 0, 0, 0, 0xD0, 0xBF));
}

TEST(Recording, no_point_of_the_first_cloud_is_zero_because_its_module_was_not_heard_yet) {
  const Folder folder("recording");
  Origin from = origin();
  from.cloud_period_us = 200'000;
  record_samples(folder / "r.mcap", strip(20), 400, from);
  Topics topics;
  (void)mcap::read_file(InputFile(folder / "r.mcap"), "r.mcap", topics);
  const auto& cloud = topics.messages["/skin/points"].front();
  // There are 240 points of 32 bytes, then is_dense; the value is at byte 28 of a point.
  for (std::size_t point = cloud.size() - 1 - std::size_t{32} * 240; point + 32 < cloud.size(); point += 32)
    ASSERT_NE(cloud[point + 28] + 256 * cloud[point + 29], 0) << point;
}

TEST(Recording, a_module_that_never_sends_does_not_keep_the_clouds_away) {
  const Folder folder("recording");
  Origin from = origin();
  from.cloud_period_us = 200'000;
  {
    const design::Design design = strip(20);
    OutputFile file(folder / "r.mcap");
    const auto recorder = make_recorder(Format::kMcap, file, design, from);
    for (std::uint64_t k = 0; k < 1'000; ++k) {
      if (k % 20 != 7) recorder->add(sample_of(k, 20));
    }
    recorder->finish({});
    file.close();
  }
  Topics topics;
  (void)mcap::read_file(InputFile(folder / "r.mcap"), "r.mcap", topics);
  EXPECT_GE(topics.messages["/skin/points"].size(), 3U);
}

TEST(Recording, a_table_of_a_simulation_says_so_in_each_row) {
  const Folder folder("recording");
  const design::Design design = strip(2);
  for (const bool simulated : {false, true}) {
    Origin from = origin();
    if (simulated) from.facts["simulated"] = "true";
    OutputFile file(folder / "r.csv");
    const auto recorder = make_recorder(Format::kCsv, file, design, from);
    recorder->add(sample_of(0, 2));
    recorder->finish({});
    file.close();
    const std::string text = triskin::read_file(folder / "r.csv");
    EXPECT_THAT(text, testing::HasSubstr(",reader_node,simulated\n"));
    EXPECT_TRUE(text.ends_with(simulated ? ",1\n" : ",0\n")) << text;
  }
}

// The files are as 0.2 wrote them before it recorded readers, and as 0.1: adopters are unknown, everything else is
// read.
TEST(Recording, one_without_readers_is_read_as_before) {
  const Folder folder("recording");
  const auto samples = first(40, 20);
  {
    OutputFile file(folder / "old.mcap");
    mcap::Writer writer(file, "ros2", "triskin");
    const auto raw =
        writer.add_channel(writer.add_schema(kRawFrameType.name, kRawFrameType.definition), "/skin/raw", {});
    for (const ModuleSample& s : samples) writer.write(raw, s.link_time_us * 1000, encode_raw(std::span(&s, 1)));
    writer.finish();
    file.close();
  }
  Summary summary;
  EXPECT_EQ(samples_of(folder / "old.mcap", &summary), samples);
  EXPECT_TRUE(summary.reader_changes.empty());
}

// By hand: module 1 of two is read by the controller at address 5, which serves patch 3; module 0 has no patch.
TEST(Recording, a_message_of_readers_is_what_its_definition_says) {
  const std::vector<Reader> readers{{layout::PatchIndex::none(), layout::NodeAddress{0}},
                                    {layout::PatchIndex{3}, layout::NodeAddress{5}}};
  const std::vector<std::uint8_t> bytes{0,    1, 0, 0,                       // The encoding is CDR, little-endian.
                                        2,    0, 0, 0, 7,    0,    0,    0,  // The time is 2.000000007 s.
                                        5,    0, 0, 0, 's',  'k',  'i',  'n',  0,  // This is the frame.
                                        0,    0, 0, 0, 0,    0,    0,              // Padding ends at a multiple of 8.
                                        0x10, 0, 0, 0, 0,    0,    0,    0,        // The number is 16 us.
                                        2,    0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF,     // There are two patches.
                                        3,    0, 0, 0, 2,    0,    0,    0,    0, 5};
  EXPECT_EQ(encode_readers(readers, 16, 2'000'000'007), bytes);
  const auto read = decode_readers(bytes);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->link_time_us, 16U);
  EXPECT_EQ(read->readers, readers);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decode_readers(Bytes(bytes).first(size))) << size;
  std::vector<std::uint8_t> unequal = bytes;
  unequal[unequal.size() - 6] = 1;  // There is one address for two patches.
  EXPECT_FALSE(decode_readers(unequal));
}

TEST(Recording, a_file_cut_anywhere_is_read_up_to_the_last_whole_chunk_and_recovered) {
  const Folder folder("recording");
  const int modules = 2;
  record_samples(folder / "whole.mcap", strip(modules), 200);  // 3.7 s give eight chunks.
  const std::string whole = triskin::read_file(folder / "whole.mcap");
  const auto written = first(200, modules);
  std::size_t before = 0;
  for (std::size_t size = 3'200; size < whole.size(); size += 131) {
    write_file_atomically(folder / "cut.mcap", whole.substr(0, size));
    Summary cut;
    const auto read = samples_of(folder / "cut.mcap", &cut);
    ASSERT_FALSE(cut.file.complete) << size;
    ASSERT_GE(read.size(), before) << size;
    ASSERT_TRUE(std::equal(read.begin(), read.end(), written.begin())) << size;
    before = read.size();
    if (read.empty()) continue;
    const Recovery r = recover(folder / "cut.mcap", {});
    ASSERT_FALSE(r.was_complete) << size;
    Summary recovered;
    ASSERT_EQ(samples_of(folder / "cut.mcap", &recovered), read) << size;
    ASSERT_TRUE(recovered.file.complete) << size << recovered.file.problem;
    ASSERT_TRUE(recover(folder / "cut.mcap", {}).was_complete) << size;
  }
  EXPECT_EQ(before, 200U);
}

// Serves bytes from memory, of which only the first ones exist.
class Cut final : public ByteSource {
 public:
  Cut(const std::string& bytes, std::size_t size) : bytes_(bytes), size_(size) {}
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::uint8_t> into) const override {
    if (offset + into.size() > size_) return false;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), into.size(), into.begin());
    return true;
  }

 private:
  const std::string& bytes_;
  std::size_t size_;
};

TEST(Recording, at_every_length_the_messages_read_are_the_first_ones) {
  const Folder folder("recording");
  record_samples(folder / "whole.mcap", strip(2), 60);
  const std::string whole = triskin::read_file(folder / "whole.mcap");
  Chunks all;
  (void)mcap::read_file(Cut(whole, whole.size()), "whole", all);
  ASSERT_EQ(all.log_ns.size(), 32U);
  std::size_t before = 0;
  for (std::size_t size = mcap::kMagic.size(); size < whole.size(); ++size) {
    Chunks cut;
    const mcap::ReadReport report = mcap::read_file(Cut(whole, size), "cut", cut);
    ASSERT_FALSE(report.complete) << size;
    ASSERT_LE(report.whole_bytes, size);
    ASSERT_GE(cut.log_ns.size(), before) << size;
    before = cut.log_ns.size();
    ASSERT_TRUE(std::equal(cut.log_ns.begin(), cut.log_ns.end(), all.log_ns.begin())) << size;
  }
  EXPECT_EQ(before, 32U);
}

TEST(Recording, a_recovered_file_is_the_file_that_was_cut) {
  const Folder folder("recording");
  record_samples(folder / "r.mcap", strip(2), 200);
  const std::string whole = triskin::read_file(folder / "r.mcap");
  write_file_atomically(folder / "cut.mcap", whole.substr(0, whole.size() - 30));  // The cut lies in the footer.
  EXPECT_EQ(recover(folder / "cut.mcap", folder / "new.mcap").messages, recover(folder / "r.mcap", {}).messages);
  std::string recovered = triskin::read_file(folder / "new.mcap");
  ASSERT_EQ(recovered.size(), whole.size());
  // Only the CRC of the data section is left out, which follows the head of the record kind 15.
  const auto data_end =
      static_cast<std::size_t>(std::mismatch(whole.begin(), whole.end(), recovered.begin()).first - whole.begin());
  EXPECT_EQ(recovered.substr(data_end, 4), std::string(4, '\0'));
  recovered.replace(data_end, 4, whole.substr(data_end, 4));
  EXPECT_EQ(recovered, whole);
  EXPECT_EQ(triskin::read_file(folder / "cut.mcap").size(), whole.size() - 30) << "the source is not touched";
}

TEST(Recording, a_flipped_bit_in_a_chunk_ends_the_reading_before_it) {
  const Folder folder("recording");
  record_samples(folder / "r.mcap", strip(2), 200);
  std::string bytes = triskin::read_file(folder / "r.mcap");
  const std::size_t middle = bytes.size() / 2;
  bytes[middle] = static_cast<char>(bytes[middle] ^ 4);
  write_file_atomically(folder / "r.mcap", bytes);
  Summary summary;
  const auto read = samples_of(folder / "r.mcap", &summary);
  EXPECT_FALSE(summary.file.complete);
  EXPECT_LT(summary.file.whole_bytes, middle);
  EXPECT_GT(read.size(), 40U);
  EXPECT_LT(read.size(), 160U);
}

TEST(Recording, damage_that_is_no_cut_is_not_dropped_in_place) {
  const Folder folder("recording");
  record_samples(folder / "r.mcap", strip(64), 64 * 3'000);
  std::string bytes = triskin::read_file(folder / "r.mcap");
  ASSERT_GT(bytes.size(), std::size_t{6} << 20);
  bytes[1'000'000] = static_cast<char>(bytes[1'000'000] ^ 4);
  write_file_atomically(folder / "r.mcap", bytes);
  EXPECT_THROW((void)recover(folder / "r.mcap", {}), InputError);
  EXPECT_EQ(triskin::read_file(folder / "r.mcap"), bytes);
  const Recovery r = recover(folder / "r.mcap", folder / "new.mcap");
  EXPECT_LT(r.dropped_bytes, std::size_t{2} << 20) << "one chunk and its index";
  Summary summary;
  EXPECT_GT(samples_of(folder / "new.mcap", &summary).size(), 64U * 2'000U);
  EXPECT_TRUE(summary.file.complete);
}

TEST(Recording, other_files_are_refused) {
  const Folder folder("recording");
  write_file_atomically(folder / "text.mcap", "no recording at all");
  EXPECT_THROW((void)samples_of(folder / "text.mcap"), InputError);
  EXPECT_THROW((void)recover(folder / "text.mcap", {}), InputError);
  EXPECT_THROW((void)samples_of(folder / "missing.mcap"), InputError);
}

TEST(Recording, what_waits_for_half_a_second_is_written_also_when_the_link_is_silent) {
  const Folder folder("recording");
  const design::Design design = strip(2);
  OutputFile file(folder / "r.mcap");
  const auto recorder = make_recorder(Format::kMcap, file, design, origin());
  recorder->add(sample_of(0, 2));
  recorder->tick(10'000'000);
  recorder->tick(10'499'999);
  EXPECT_EQ(samples_of(folder / "r.mcap").size(), 0U);
  recorder->tick(10'500'000);
  EXPECT_EQ(samples_of(folder / "r.mcap").size(), 1U);
  recorder->add(sample_of(1, 2));
  recorder->tick(20'000'000);
  EXPECT_EQ(samples_of(folder / "r.mcap").size(), 1U);
  recorder->tick(20'500'000);
  EXPECT_EQ(samples_of(folder / "r.mcap").size(), 2U);
}

TEST(Recording, a_point_cloud_has_a_point_a_taxel) {
  const Folder folder("recording");
  Origin with_cloud = origin();
  with_cloud.cloud_period_us = 100'000;
  record_samples(folder / "r.mcap", strip(2), 200, with_cloud);
  struct Clouds final : mcap::Visitor {
    void on_schema(const mcap::Schema& s) override {
      if (s.name == kPointCloudType.name) schema = s.id;
    }
    void on_channel(const mcap::Channel& c) override {
      if (c.schema == schema) channel = c.id;
    }
    void on_message(const mcap::Message& m) override {
      if (m.channel == channel) sizes.push_back(m.data.size());
    }
    std::uint16_t schema = 0, channel = 0;
    std::vector<std::size_t> sizes;
  } clouds;
  const InputFile file(folder / "r.mcap");
  (void)mcap::read_file(file, "r.mcap", clouds);
  EXPECT_GT(clouds.sizes.size(), 30U);
  EXPECT_THAT(clouds.sizes, testing::Each(testing::AllOf(testing::Gt(24U * 32), testing::Lt(24U * 32 + 400))));
}

TEST(OutputFile, is_opened_at_once_and_replaced_by_the_first_byte_only) {
  const Folder folder("recording");
  EXPECT_THROW(OutputFile(folder / "nowhere/r.mcap"), InputError);
  write_file_atomically(folder / "old.mcap", "old");
  {
    const OutputFile file(folder / "old.mcap");
    const OutputFile other(folder / "new.mcap");
  }
  EXPECT_EQ(triskin::read_file(folder / "old.mcap"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder / "new.mcap"));
  {
    OutputFile file(folder / "old.mcap");
    file.write(std::vector<std::uint8_t>{'n'});
  }
  EXPECT_EQ(triskin::read_file(folder / "old.mcap"), "n");
}

TEST(OutputFile, a_full_disk_is_said_with_what_is_there) {
  OutputFile file("/dev/full");
  const std::vector<std::uint8_t> bytes(100);
  try {
    file.write(bytes);
    FAIL();
  } catch (const WriteFailed& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("No space left on device"));
    EXPECT_THAT(e.what(), testing::HasSubstr("after 0 bytes"));
  }
}

}  // namespace
}  // namespace triskin::recording
