// SPDX-License-Identifier: GPL-3.0-or-later
// recover must keep every chunk that is whole, wherever the damage is, and state what is missing. The oracle knows the
// file only by the offsets of its chunks, which a walk over the undamaged file gives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "recorded.hpp"
#include "triskin/base/files.hpp"

namespace triskin::recording {
namespace {

using test::strip;
using ::testing::HasSubstr;

constexpr int kModules = 2;
constexpr std::uint64_t kSamples = 200;

struct Span {
  std::size_t from, to;
  mcap::Kind kind;
};

// Returns the records of the data section, with a chunk and its indexes together.
std::vector<Span> records_of(const std::string& bytes) {
  std::vector<Span> records;
  for (std::size_t at = mcap::kMagic.size(); at + mcap::kHeadBytes <= bytes.size();) {
    ByteReader r(Bytes(reinterpret_cast<const std::uint8_t*>(bytes.data()) + at, mcap::kHeadBytes));
    const auto kind = static_cast<mcap::Kind>(r.u8());
    const std::size_t end = at + mcap::kHeadBytes + r.le64();
    if (kind == mcap::Kind::kMessageIndex)
      records.back().to = end;
    else
      records.push_back({at, end, kind});
    if (kind == mcap::Kind::kDataEnd) break;
    at = end;
  }
  return records;
}

// Returns the samples of chunks that have no byte of `damaged` behind the first `free_bytes` of their contents.
std::vector<ModuleSample> samples_without(const Folder& folder, const std::string& whole,
                                          const std::vector<std::size_t>& damaged, std::size_t free_bytes) {
  std::string kept = whole.substr(0, mcap::kMagic.size());
  for (const Span& record : records_of(whole)) {
    ByteReader r(Bytes(reinterpret_cast<const std::uint8_t*>(whole.data()) + record.from + 1, 8));
    const std::size_t end = record.from + mcap::kHeadBytes + r.le64();  // The indexes can be made again.
    const std::size_t times = record.from + mcap::kHeadBytes;  // Its 24 bytes of times and size can be made again.
    const bool is_hit = record.kind == mcap::Kind::kChunk && std::ranges::any_of(damaged, [&](std::size_t at) {
                          return at >= record.from && at < end && (at < times || at >= times + free_bytes);
                        });
    if (!is_hit) kept += whole.substr(record.from, record.to - record.from);
  }
  write_file_atomically(folder / "kept.mcap", kept);
  return samples_of(folder / "kept.mcap");
}

std::string changed(std::string bytes, std::size_t at, std::mt19937_64& random) {
  bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1 + random() % 255));
  return bytes;
}

class Salvaged : public ::testing::Test {
 protected:
  Salvaged() : folder_("salvage") {
    record_samples(folder_ / "whole.mcap", strip(kModules), kSamples);
    whole_ = triskin::read_file(folder_ / "whole.mcap");
    const auto records = records_of(whole_);
    data_end_ = records.back().from;
    for (const Span& r : records) {
      if (r.kind != mcap::Kind::kChunk) continue;
      if (first_chunk_ == 0) first_chunk_ = r.from;
      chunks_.push_back(r);
    }
  }

  Recovery recovered(const std::string& bytes) {
    write_file_atomically(folder_ / "damaged.mcap", bytes);
    const Recovery r = recover(folder_ / "damaged.mcap", folder_ / "new.mcap");
    EXPECT_EQ(triskin::read_file(folder_ / "damaged.mcap"), bytes) << "the original is not touched";
    Summary summary;
    samples_ = samples_of(folder_ / "new.mcap", &summary);
    EXPECT_TRUE(summary.file.complete) << summary.file.problem;
    EXPECT_TRUE(recover(folder_ / "new.mcap", {}).was_complete);
    return r;
  }

  // Expects the samples of the new file to be those of the chunks that have no byte of `damaged`.
  ::testing::AssertionResult is_kept_but(const std::vector<std::size_t>& damaged, std::size_t free_bytes = 24) {
    const auto wanted = samples_without(folder_, whole_, damaged, free_bytes);
    if (samples_ == wanted) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << samples_.size() << " samples, wanted " << wanted.size();
  }

  Folder folder_;
  std::string whole_;
  std::size_t first_chunk_ = 0, data_end_ = 0;
  std::vector<Span> chunks_;
  std::vector<ModuleSample> samples_;
};

TEST_F(Salvaged, chunks_on_both_sides_of_a_changed_byte_are_kept) {
  ASSERT_GE(chunks_.size(), 7U);
  std::mt19937_64 random(1);
  const std::size_t at = chunks_[2].from + 200;
  const Recovery r = recovered(changed(whole_, at, random));
  EXPECT_TRUE(is_kept_but({at}));
  EXPECT_LT(samples_.size(), kSamples);
  ASSERT_EQ(r.losses.size(), 1U);
  EXPECT_EQ(r.losses[0].offset, chunks_[2].from);
  EXPECT_EQ(r.losses[0].bytes, chunks_[2].to - chunks_[2].from);
  EXPECT_EQ(r.losses[0].what, "a chunk");
  EXPECT_FALSE(r.losses[0].is_mended);
  EXPECT_GT(r.losses[0].to_s, r.losses[0].from_s);
}

TEST_F(Salvaged, a_closed_file_is_never_changed_in_place) {
  std::mt19937_64 random(2);
  for (const std::size_t at :
       {first_chunk_ / 2, chunks_[3].from + 1, chunks_[3].from + 300, data_end_ + 2, whole_.size() - 20}) {
    const std::string bytes = changed(whole_, at, random);
    write_file_atomically(folder_ / "damaged.mcap", bytes);
    try {
      const Recovery r = recover(folder_ / "damaged.mcap", {});
      EXPECT_TRUE(r.was_complete) << at;
      ADD_FAILURE() << "byte " << at << " was changed and nobody says so";
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("-o NEW"));
    }
    EXPECT_EQ(triskin::read_file(folder_ / "damaged.mcap"), bytes) << at;
  }
}

// Every 41st byte of the file is changed: a prime, so that the bytes fall on every field of the records.
TEST_F(Salvaged, a_changed_byte_anywhere_costs_the_chunk_that_it_is_in_and_is_said) {
  std::mt19937_64 random(3);
  for (std::size_t at = 0; at < whole_.size() - mcap::kMagic.size(); at += 41) {
    const Recovery r = recovered(changed(whole_, at, random));
    ASSERT_TRUE(is_kept_but({at})) << "byte " << at << ": " << r.problem;
    ASSERT_FALSE(r.was_complete) << "byte " << at;
  }
}

TEST_F(Salvaged, two_changed_bytes_cost_the_chunks_that_they_are_in) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 100; ++trial) {
    // Either one may hit the definitions of the channels or their copy in the summary, but not both.
    const std::size_t a = random() % whole_.size(), b = first_chunk_ + random() % (data_end_ - first_chunk_);
    if (a == b || a >= whole_.size() - mcap::kMagic.size()) continue;
    const Recovery r = recovered(changed(changed(whole_, a, random), b, random));
    ASSERT_TRUE(is_kept_but({a, b})) << "bytes " << a << ", " << b;
    ASSERT_FALSE(r.was_complete);
  }
}

TEST_F(Salvaged, bytes_that_are_missing_or_too_many_cost_the_chunk_around_them) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const std::size_t at = first_chunk_ + random() % (data_end_ - first_chunk_), count = 1 + random() % 300;
    std::string bytes = whole_;
    std::vector<std::size_t> gone;
    if (trial % 2 == 0) {
      bytes.erase(at, std::min(count, data_end_ - at));
      for (std::size_t k = 0; k < count; ++k) gone.push_back(at + k);
    } else {
      bytes.insert(at, std::string(count, static_cast<char>(random())));
      gone = {at};
      const bool is_between = std::ranges::any_of(chunks_, [&](const Span& c) { return c.from == at; });
      if (is_between) gone.clear();
    }
    const Recovery r = recovered(bytes);
    ASSERT_TRUE(is_kept_but(gone, 0)) << "trial " << trial << ", byte " << at << ", " << count
                                      << " bytes: " << r.problem << ", " << r.losses.size();
  }
}

TEST_F(Salvaged, damage_before_a_cut_needs_another_file) {
  std::mt19937_64 random(6);
  const std::string cut = whole_.substr(0, chunks_[5].from + 100);
  write_file_atomically(folder_ / "damaged.mcap", changed(cut, chunks_[1].from + 100, random));
  EXPECT_THROW((void)recover(folder_ / "damaged.mcap", {}), InputError);
  const Recovery r = recovered(triskin::read_file(folder_ / "damaged.mcap"));
  EXPECT_EQ(r.losses.size(), 2U);
  EXPECT_EQ(r.losses[1].to_s, -1.0) << "nothing is behind the cut";
}

TEST_F(Salvaged, messages_without_the_definition_of_their_channel_are_counted) {
  std::mt19937_64 random(7);
  const auto records = records_of(whole_);
  const auto channel = std::ranges::find(records, mcap::Kind::kChannel, &Span::kind);
  std::string cut = whole_.substr(0, chunks_[5].from);
  cut.erase(channel->from, channel->to - channel->from);  // No summary has a second copy of it.
  write_file_atomically(folder_ / "damaged.mcap", cut);
  const Recovery r = recover(folder_ / "damaged.mcap", folder_ / "new.mcap");
  ASSERT_FALSE(r.losses.empty());
  EXPECT_THAT(r.losses.back().what, HasSubstr("messages whose channel has lost its definition"));
}

TEST_F(Salvaged, the_damaged_recording_is_not_its_own_output) {
  std::mt19937_64 random(8);
  const std::string bytes = changed(whole_, chunks_[2].from + 200, random);
  write_file_atomically(folder_ / "damaged.mcap", bytes);
  EXPECT_THROW((void)recover(folder_ / "damaged.mcap", folder_ / "damaged.mcap"), InputError);
  EXPECT_EQ(triskin::read_file(folder_ / "damaged.mcap"), bytes);
}

}  // namespace
}  // namespace triskin::recording
