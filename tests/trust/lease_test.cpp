// SPDX-License-Identifier: GPL-3.0-or-later
// Readers of one bus begin, end and die: none of them may end the stream of another.
#include <gtest/gtest.h>

#include <random>

#include "shared_skin.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::session {
namespace {

using test::kSequence_us;
using test::SharedSkin;
using test::strip_scene;

/// Simulates a reading program with its own link, bus and stream.
class Reader {
 public:
  Reader(SharedSkin& hub, int every) : link_(hub), bus_(link_) {
    session::StreamOptions options;
    options.every = every;
    stream_.emplace(bus_, hub.design(), [this](const session::ModuleSample&) { ++frames_; }, options);
    begin_us_ = bus_.now_us();
    every_ = every;
  }
  void run(std::uint64_t us) { stream_->run_until(bus_.now_us() + us); }
  void die() {
    link_.cut();
    stream_.reset();
  }
  /// Ends properly; every sample of the lease must be there.
  void go(std::size_t modules) {
    const double seconds_us = static_cast<double>(bus_.now_us() - begin_us_);
    stream_->finish();
    const session::StreamReport r = stream_->report();
    EXPECT_TRUE(r.complete()) << session::sentences(r).at(0);
    EXPECT_EQ(r.total.received, frames_);
    const double due = static_cast<double>(modules) * seconds_us / kSequence_us / every_;
    EXPECT_GE(static_cast<double>(r.total.received) + 2.0 * static_cast<double>(modules), 0.95 * due);
  }

 private:
  SharedSkin::Client link_;
  session::Bus bus_;
  std::optional<session::Stream> stream_;
  std::uint64_t frames_ = 0, begin_us_ = 0;
  int every_ = 1;
};

// One reader has 54 samples a second; another that wants 108 would change what the first one reads.
TEST(Leases, decimation_is_chosen_by_the_first_reader) {
  SharedSkin hub(strip_scene(6, 3));
  hub.flash();
  SharedSkin::Client link(hub), other_link(hub);
  session::Bus bus(link), other_bus(other_link);
  session::StreamOptions options;
  options.decimation = wire::Decimation::k128;
  session::Stream first(bus, hub.design(), [](const session::ModuleSample&) {}, options);
  first.run_until(bus.now_us() + 2'000'000);
  options.decimation = wire::Decimation::k64;
  try {
    const session::Stream second(other_bus, hub.design(), [](const session::ModuleSample&) {}, options);
    ADD_FAILURE() << "changed under the first reader";
  } catch (const DeviceError& e) {
    EXPECT_NE(std::string(e.what()).find("patch 0 at decimation 128; end them first"), std::string::npos) << e.what();
  }
  options.decimation = wire::Decimation::k128;
  {
    const session::Stream third(other_bus, hub.design(), [](const session::ModuleSample&) {}, options);
  }
  first.finish();
  const session::StreamReport r = first.report();
  // The oscillators are known to 12 % until the first end is measured, so a module's first sequence may pass unread.
  EXPECT_LE(r.total.unread, 6U) << session::sentences(r).at(0);
  EXPECT_EQ(r.total.lost(), r.total.unread) << session::sentences(r).at(0);
  EXPECT_NEAR(static_cast<double>(r.total.expected), 6 * 2.0 / 0.0184, 0.05 * 6 * 2.0 / 0.0184);
  options.decimation = wire::Decimation::k256;  // Nobody reads now.
  EXPECT_NO_THROW(session::Stream(other_bus, hub.design(), [](const session::ModuleSample&) {}, options));
}

// The reader that ended first used to switch the streams off; the other then had half its data and "0 lost".
TEST(Leases, the_end_of_one_reader_leaves_the_other_its_stream) {
  SharedSkin hub(strip_scene(6, 3));
  hub.flash();
  Reader long_one(hub, 1);
  {
    Reader short_one(hub, 1);
    for (int k = 0; k < 10; ++k) {
      short_one.run(50'000);
      long_one.run(50'000);
    }
    short_one.go(6);
  }
  for (int k = 0; k < 40; ++k) long_one.run(50'000);
  long_one.go(6);
}

TEST(Leases, a_stream_without_reader_ends_by_itself) {
  SharedSkin hub(strip_scene(3, 3));
  hub.flash();
  Reader reader(hub, 1);
  reader.run(500'000);
  reader.die();
  hub.skin().run_until(hub.skin().now_us() + 1'100'000);
  hub.forget();
  hub.skin().run_until(hub.skin().now_us() + 500'000);
  EXPECT_TRUE(hub.on_bus().empty());
}

TEST(Leases, a_ninth_reader_is_told_so) {
  SharedSkin hub(strip_scene(3, 3));
  hub.flash();
  std::vector<std::unique_ptr<Reader>> readers;
  for (int k = 0; k < 8; ++k) {
    readers.push_back(std::make_unique<Reader>(hub, 1));
    for (auto& r : readers) r->run(1'000);
  }
  EXPECT_THROW(Reader(hub, 1), DeviceError);
  for (auto& r : readers) r->go(3);
}

constexpr std::uint64_t kLease_us = 1'000'000;

/// Readers with every sample or each second or third one begin, end and die in any order.
struct Interleaving {
  SharedSkin& hub;
  std::vector<std::uint64_t> died_us;  // Each reader that died did so at one of these times.
  int refused = 0;

  // A dead reader keeps its place until its lease ends; a reader that finds no place gets a message, and no other does.
  std::unique_ptr<Reader> begin(int every, std::size_t alive) {
    const std::uint64_t now_us = hub.skin().now_us();
    try {
      return std::make_unique<Reader>(hub, every);
    } catch (const DeviceError&) {
      ++refused;
      const auto kept = std::ranges::count_if(died_us, [&](std::uint64_t t) { return t + kLease_us >= now_us; });
      EXPECT_GE(alive + static_cast<std::size_t>(kept), wire::kMaxLeases);
      return nullptr;
    }
  }

  void run(std::mt19937_64& random) {
    const std::size_t modules = hub.design().layout.modules.size();
    std::vector<std::unique_ptr<Reader>> readers;
    for (int turn = 0; turn < 24; ++turn) {
      const auto dice = random() % 8;
      if (dice < 3 && readers.size() < 4) {
        if (auto reader = begin(1 + static_cast<int>(random() % 3), readers.size()))
          readers.push_back(std::move(reader));
      } else if (dice >= 6 && !readers.empty()) {
        const auto which = readers.begin() + static_cast<std::ptrdiff_t>(random() % readers.size());
        if (dice == 6) {
          (*which)->go(modules);
        } else {
          (*which)->die();
          died_us.push_back(hub.skin().now_us());
        }
        readers.erase(which);
      }
      std::ranges::shuffle(readers, random);
      // Time passes only while somebody waits; without this, leases of eight dead readers would last forever.
      if (readers.empty()) hub.skin().run_until(hub.skin().now_us() + random() % 100'000);
      for (auto& r : readers) r->run(random() % 30'000);
    }
    for (auto& r : readers) r->go(modules);
  }
};

TEST(Leases, a_thousand_random_interleavings_lose_nothing) {
  SharedSkin hub(strip_scene(4, 2));
  hub.flash();
  Interleaving interleaving{hub, {}};
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    interleaving.run(random);
    hub.forget();
    ASSERT_FALSE(testing::Test::HasFailure());
  }
  EXPECT_LT(interleaving.refused, 500);  // There are some 6,000 readers.
}

}  // namespace
}  // namespace triskin::session
