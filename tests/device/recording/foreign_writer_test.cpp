// SPDX-License-Identifier: GPL-3.0-or-later
// A recording that the libraries of others have rewritten holds the same samples: channels from 0, definitions inside
// chunks, no chunks at all, messages in any order.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "recorded.hpp"
#include "support/temp_folder.hpp"
#include "triskin/recording/mcap_file.hpp"
#include "triskin/recording/output_file.hpp"

namespace triskin::recording {
namespace {

constexpr int kModules = 5;
constexpr std::uint64_t kSamples = 40;

// Keeps all definitions and messages of a file.
struct Everything final : mcap::Visitor {
  struct Kept {
    mcap::Message head;
    std::vector<std::uint8_t> data;
  };
  std::vector<mcap::Schema> schemas;
  std::vector<mcap::Channel> channels;
  std::vector<Kept> messages;
  void on_schema(const mcap::Schema& s) override { schemas.push_back(s); }
  void on_channel(const mcap::Channel& c) override { channels.push_back(c); }
  void on_message(const mcap::Message& m) override { messages.push_back({m, {m.data.begin(), m.data.end()}}); }
};

struct Style {
  const char* name;
  bool chunk = true, reversed = false, twins = false;  // twins: each topic has two channels, used in turn
};

class ForeignWriter : public testing::Test {
 protected:
  ForeignWriter() {
    OutputFile file(folder_ / "own.mcap");
    const auto recorder = make_recorder(Format::kMcap, file, test::strip(kModules), origin());
    for (std::uint64_t k = 0; k < kSamples; ++k) recorder->add(sample_of(k, kModules));
    recorder->finish({});
    file.close();
    (void)mcap::read_file(InputFile(folder_ / "own.mcap"), "own.mcap", everything_);
  }
  // Writes the file again with channels from 0, in one chunk with its definitions or without chunks.
  std::string written(const Style& style) {
    mcap::Buffer records, header, file;
    for (const mcap::Schema& s : everything_.schemas) records.record(mcap::Kind::kSchema, mcap::encode(s));
    for (mcap::Channel c : everything_.channels) {
      --c.id;
      records.record(mcap::Kind::kChannel, mcap::encode(c));
      if (!style.twins) continue;
      c.id = twin_of(c.id);
      records.record(mcap::Kind::kChannel, mcap::encode(c));
    }
    auto messages = everything_.messages;
    if (style.reversed) std::ranges::reverse(messages);
    std::uint64_t first_ns = UINT64_MAX, last_ns = 0;
    bool is_odd = false;
    for (Everything::Kept& m : messages) {
      --m.head.channel;
      if (style.twins && (is_odd = !is_odd)) m.head.channel = twin_of(m.head.channel);
      m.head.data = m.data;
      first_ns = std::min(first_ns, m.head.log_ns);
      last_ns = std::max(last_ns, m.head.log_ns);
      records.record(mcap::Kind::kMessage, mcap::encode(m.head));
    }
    header.text("ros2");
    header.text("someone else");
    file.bytes(mcap::kMagic);
    file.record(mcap::Kind::kHeader, header);
    file.bytes(style.chunk ? mcap::encode_chunk(first_ns, last_ns, records).view() : records.view());
    std::string path = folder_ / style.name;
    const Bytes bytes = file.view();
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path;
  }

  static std::uint16_t twin_of(std::uint16_t channel) { return static_cast<std::uint16_t>(channel + 100); }

  test::TempFolder folder_;
  Everything everything_;
};

constexpr std::array<Style, 4> kStyles{
    {{"chunk"}, {"plain", false}, {"reversed", true, true}, {"plain_reversed", false, true}}};

TEST_F(ForeignWriter, the_samples_are_the_same) {
  std::vector<Style> styles(kStyles.begin(), kStyles.end());
  styles.push_back({"twins", true, false, true});
  for (const Style& style : styles) {
    std::vector<std::pair<std::uint64_t, int>> own, foreign;
    const auto note = [](auto& list) {
      return [&list](const ModuleSample& s) { list.emplace_back(s.link_time_us, static_cast<int>(s.module)); };
    };
    const Summary before = read_recording(folder_ / "own.mcap", note(own));
    const Summary after = read_recording(written(style), note(foreign));
    EXPECT_EQ(after.samples, kSamples) << style.name;
    EXPECT_EQ(after.first_us, before.first_us) << style.name;
    EXPECT_EQ(after.last_us, before.last_us) << style.name;
    std::ranges::sort(own);
    std::ranges::sort(foreign);
    EXPECT_EQ(foreign, own) << style.name;
  }
}

// Reads a summary by the specification: behind the end of data, every schema and channel stands again.
struct Topics {
  std::size_t schemas = 0, channels = 0;
  std::uint64_t messages = 0;
};
Topics summary_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
  // The file ends with the footer (start of the summary, start of its offsets, CRC) and the magic bytes.
  ByteReader footer(Bytes(bytes).subspan(bytes.size() - 8 - 20));
  Topics topics;
  for (std::uint64_t at = footer.le64(); at + 9 < bytes.size() - 8;) {
    ByteReader r(Bytes(bytes).subspan(at));
    const auto kind = static_cast<mcap::Kind>(r.u8());
    const std::uint64_t length = r.le64();
    topics.schemas += kind == mcap::Kind::kSchema ? 1 : 0;
    topics.channels += kind == mcap::Kind::kChannel ? 1 : 0;
    if (kind == mcap::Kind::kStatistics) topics.messages = r.le64();
    at += 9 + length;
  }
  return topics;
}

TEST_F(ForeignWriter, a_recovered_file_lists_the_topics_in_its_summary) {
  for (const Style& style : kStyles) {
    const std::string to = folder_ / (std::string(style.name) + "_recovered.mcap");
    const Recovery r = recover(written(style), to);
    EXPECT_FALSE(r.was_complete) << style.name;
    const Topics topics = summary_of(to);
    EXPECT_EQ(topics.schemas, everything_.schemas.size()) << style.name;
    EXPECT_EQ(topics.channels, everything_.channels.size()) << style.name;
    EXPECT_EQ(topics.messages, everything_.messages.size()) << style.name;
    EXPECT_EQ(read_recording(to, {}).samples, kSamples) << style.name;
  }
}

// Players offer a topic as its channel says; listeners of what was said once must ask for it (transient local, 1 in
// rmw/types.h).
TEST_F(ForeignWriter, topics_that_are_written_once_are_offered_as_latched) {
  for (const mcap::Channel& c : everything_.channels) {
    const bool latched = c.metadata.at("offered_qos_profiles").find("durability: 1\n") != std::string::npos;
    EXPECT_EQ(latched, c.topic == "/skin/layout") << c.topic;
  }
  EXPECT_EQ(everything_.channels.size(), 4U);
}

}  // namespace
}  // namespace triskin::recording
