// SPDX-License-Identifier: GPL-3.0-or-later
// A robot of twelve covers streams for hours of virtual time. It is recorded into files of an hour, and a browser looks
// at it now and then. Memory must not grow, and every sample that a board sent must be in a file or counted as lost.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "device/robot/robots.hpp"
#include "output/view/browser.hpp"
#include "triskin/recording/recorder.hpp"
#include "triskin/recording/recording.hpp"
#include "triskin/skin/live_skin.hpp"
#include "triskin/skin/skin_contacts.hpp"
#include "triskin/view/server.hpp"
#include "triskin/wire/taxel_frames.hpp"

namespace triskin::test {
namespace {

namespace fs = std::filesystem;

constexpr int kCovers = 12, kBuses = 3, kModules = 2;
constexpr std::uint64_t kMinute_us = 60'000'000, kSlice_us = 1'000'000;
constexpr int kMinutesPerHour = 60, kMinutesBetweenViewers = 10;
constexpr std::uint64_t kSeed = 20261127;

/// Counts what each cover sent, and loses about one sample in 20,000 between the boards and the computer.
class Wire {
 public:
  Wire(skin::LiveBus& bus, std::uint64_t seed) : random_(seed) {
    for (std::size_t c = 0; c < bus.covers().size(); ++c) {
      for (const int node : bus.covers()[c].design().node_addresses) cover_of_[node] = c;
    }
    sent_.resize(bus.covers().size());
    lost_.resize(bus.covers().size());
    dynamic_cast<hardware::InProcessLink&>(bus.link())
        .skin()
        .on_delivery([this](std::size_t receiver, const wire::CanFrame& frame) { return hears(receiver, frame); });
  }
  [[nodiscard]] std::uint64_t sent(std::size_t cover) const { return sent_[cover]; }
  [[nodiscard]] std::uint64_t lost(std::size_t cover) const { return lost_[cover]; }

 private:
  bool hears(std::size_t receiver, const wire::CanFrame& frame) {
    if (receiver != hardware::VirtualSkin::kToHost) return true;
    const auto sample = wire::decode_full(frame);
    if (!sample) return true;
    const std::size_t cover = cover_of_.at(sample->node_address);
    ++sent_[cover];
    const bool is_lost = random_() % 20'000 == 0;
    if (is_lost) ++lost_[cover];
    return !is_lost;
  }

  std::mt19937_64 random_;
  std::map<int, std::size_t> cover_of_;  // The key is a node address.
  std::vector<std::uint64_t> sent_, lost_;
};

/// Records one cover and reads each file when it is complete.
class HourFiles {
 public:
  HourFiles(skin::LiveBus& bus, skin::LiveCover& cover, fs::path folder)
      : bus_(bus), cover_(cover), folder_(std::move(folder)) {}

  void begin() {
    recording::Origin origin;
    origin.design_text = "{}";
    origin.link_start_us = bus_.now_us();
    origin.unix_start_ns = bus_.unix_ns(origin.link_start_us);
    file_ = std::make_unique<recording::OutputFile>(path());
    recorder_ = recording::make_recorder(recording::Format::kMcap, *file_, cover_.design(), std::move(origin));
  }
  void add(const skin::LiveSample& s) {
    recorder_->add({s.module, s.raw.link_time_us, s.raw.sample, s.unix_ns, s.error_us});
    ++added_;
  }
  void slice() {
    std::vector<recording::Contact> contacts;
    for (const skin::SkinContact& c : skin::contacts_of(cover_.touches(), cover_.design(), {})) {
      recording::Contact& contact = contacts.emplace_back();
      contact.position_mm = c.position_mm;
      contact.change_counts = c.change_counts;
    }
    if (!contacts.empty()) recorder_->add_contacts(bus_.now_us(), contacts);
    contacts_ += contacts.size();
    recorder_->tick(bus_.now_us());
  }
  /// Completes the file of the hour, reads it and removes it, because a day of samples would fill a disk.
  void finish() {
    recorder_->finish({{"status", "complete"}});
    recorder_.reset();
    file_->close();
    file_.reset();
    const recording::Summary summary =
        recording::read_recording(path(), [this](const recording::ModuleSample& s) { read(s); });
    EXPECT_TRUE(summary.file.complete) << path();
    fs::remove(path());
  }
  [[nodiscard]] std::uint64_t added() const { return added_; }
  [[nodiscard]] std::uint64_t in_files() const { return in_files_; }
  /// Returns how many numbers are missing between the first and the last sample of the modules, over all files.
  [[nodiscard]] std::uint64_t gaps() const { return gaps_; }
  [[nodiscard]] std::uint64_t contacts() const { return contacts_; }

 private:
  [[nodiscard]] fs::path path() const { return folder_ / (cover_.config().name + ".mcap"); }
  void read(const recording::ModuleSample& s) {
    ++in_files_;
    const auto [last, is_new] = numbers_.try_emplace(s.module, s.sample.sample);
    if (is_new) return;
    gaps_ += s.sample.sample - last->second - 1;
    last->second = s.sample.sample;
  }

  skin::LiveBus& bus_;
  skin::LiveCover& cover_;
  fs::path folder_;
  std::unique_ptr<recording::OutputFile> file_;
  std::unique_ptr<recording::Recorder> recorder_;
  std::map<int, std::uint32_t> numbers_;
  std::uint64_t added_ = 0, in_files_ = 0, gaps_ = 0, contacts_ = 0;
};

/// Streams one bus into the files of its covers and onto the page.
class BusDay {
 public:
  BusDay(skin::LiveBus& bus, const fs::path& folder, view::LatestSamples& page) : bus_(bus), page_(page) {
    for (std::size_t c = 0; c < bus.covers().size(); ++c) {
      (void)deploy::flash(bus.bus(), bus.covers()[c].design(),
                          robot::flash_options(bus.config(), bus.config().covers[c], {}));
      files_.emplace_back(bus, bus.covers()[c], folder);
    }
    bus.find_controllers();
    wire_.emplace(bus, kSeed + bus.index());
    for (HourFiles& file : files_) file.begin();
    bus_.start({}, [this](const skin::LiveSample& s) { take(s); });
  }
  void pass_minute(int minute) {
    // Each minute something presses another module of a cover, or all are free.
    skin::LiveCover& cover = bus_.covers()[static_cast<std::size_t>(minute / 2) % bus_.covers().size()];
    if (minute % 2 == 0)
      cover.actuator()->press({layout::ModuleId{minute % kModules}, layout::TaxelIndex{5}});
    else
      cover.actuator()->lift();
    skin::LiveRun run{bus_.now_us() + kMinute_us, kSlice_us, {}, {}};
    run.after_slice = [this] {
      for (HourFiles& file : files_) file.slice();
      return true;
    };
    bus_.run(run);
  }
  void begin_files() {
    for (HourFiles& file : files_) file.begin();
  }
  void finish_files() {
    for (HourFiles& file : files_) file.finish();
  }
  void finish_stream() { bus_.finish(); }

  /// Every sample that was due must be in a file or counted as lost, by three accounts that know nothing of each other:
  /// the boards' and the reader's, the frames on the bus, and the numbers in the files.
  [[nodiscard]] skin::LiveTotals expect_exact_account() const {
    for (std::size_t c = 0; c < files_.size(); ++c) {
      const session::SampleCounts counts = bus_.report(c).total;
      EXPECT_EQ(counts.expected, files_[c].in_files() + counts.lost()) << c;
      EXPECT_EQ(counts.received, files_[c].in_files()) << c;
      EXPECT_EQ(files_[c].added(), files_[c].in_files()) << c;
      EXPECT_EQ(wire_->sent(c), files_[c].in_files() + wire_->lost(c)) << c;
      EXPECT_EQ(counts.lost(), wire_->lost(c)) << c;
      EXPECT_EQ(files_[c].gaps(), wire_->lost(c)) << c;
      EXPECT_GT(files_[c].contacts(), 0U) << c;
    }
    return bus_.totals();
  }

 private:
  void take(const skin::LiveSample& s) {
    files_[static_cast<std::size_t>(s.cover)].add(s);
    const int cover = bus_.covers()[static_cast<std::size_t>(s.cover)].config().cover;
    page_.add(layout::SkinModule{kModules * cover + s.module}, {s.raw.sample.state, s.valid, s.change_counts},
              static_cast<std::int64_t>(s.unix_ns / 1000));
  }

  skin::LiveBus& bus_;
  view::LatestSamples& page_;
  std::deque<HourFiles> files_;
  std::optional<Wire> wire_;
};

/// Opens the page's stream, waits for a frame of samples and goes.
void look_at(const view::Server& server) {
  RawClient browser(server.port());
  browser.send(fmt::format(
      "GET /{0}/live HTTP/1.1\r\nHost: 127.0.0.1:{1}\r\nOrigin: http://127.0.0.1:{1}\r\nUpgrade: websocket\r\n"
      "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
      server.token(), server.port()));
  EXPECT_THAT(browser.read_to("\r\n\r\n"), testing::StartsWith("HTTP/1.1 101"));
  constexpr char kBinaryMessage = static_cast<char>(0x82);
  EXPECT_NE(browser.read_to(std::string(1, kBinaryMessage)), "");
}

struct Memory {
  std::size_t heap_bytes = 0, resident_bytes = 0;
};
Memory memory_now() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  return {mallinfo2().uordblks, pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE))};
}

class Day : public testing::Test {
 protected:
  Day() : folder_(fs::temp_directory_path() / ("day_test." + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    ::setenv("XDG_STATE_HOME", folder_.c_str(), 1);
  }
  ~Day() override { fs::remove_all(folder_); }

  /// Returns the hours of virtual time: two, or TRISKIN_DAY_HOURS.
  static int hours() {
    const char* wanted = std::getenv("TRISKIN_DAY_HOURS");
    return wanted == nullptr ? 2 : std::max(2, std::atoi(wanted));
  }
  static robot::Site twelve_covers() {
    robot::Assembly a = bare_robot(kBuses);
    for (int c = 0; c < kCovers; ++c) add_strip(a, fmt::format("cover{}", c), c % kBuses, kModules, kModules);
    return robot::site_of(a);
  }
  /// Waits until the server has noticed that the browser is gone.
  static void wait_until_alone(const view::Server& server) {
    for (int tries = 0; server.connections() > 0 && tries < 3000; ++tries)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(server.connections(), 0U);
  }

  fs::path folder_;
};

TEST_F(Day, a_robot_of_twelve_covers_streams_is_recorded_and_viewed) {
  skin::LiveSkin skin(twelve_covers(), {.link = "", .chosen = false, .scene = "", .own_interrupts = false});
  skin.open();
  view::LatestSamples page(std::size_t{kCovers} * kModules);
  std::deque<BusDay> buses;
  for (const auto& bus : skin.buses()) buses.emplace_back(*bus, folder_, page);
  const view::Server server({{"", {"text/html", "the page"}}}, page, 0, [](const view::Command&) {}, {});
  Memory first;
  for (int hour = 0; hour < hours(); ++hour) {
    if (hour > 0)
      for (BusDay& bus : buses) bus.begin_files();
    for (int minute = 0; minute < kMinutesPerHour; ++minute) {
      for (BusDay& bus : buses) bus.pass_minute(minute);
      if (minute % kMinutesBetweenViewers == 0) look_at(server);
    }
    if (hour + 1 == hours())
      for (BusDay& bus : buses) bus.finish_stream();
    for (BusDay& bus : buses) bus.finish_files();
    wait_until_alone(server);
    const Memory now = memory_now();
    std::printf("hour %2d: heap %zu bytes, resident %zu KiB\n", hour + 1, now.heap_bytes, now.resident_bytes / 1024);
    std::fflush(stdout);  // Whoever runs a day wants to see its hours.
    if (hour == 0) first = now;
    // A byte kept of each sample would be 2 MB an hour.
    EXPECT_LT(now.heap_bytes, first.heap_bytes + 256 * 1024);
    EXPECT_LT(now.resident_bytes, first.resident_bytes + 4 * 1024 * 1024);
  }
  skin::LiveTotals totals;
  for (const BusDay& bus : buses) totals += bus.expect_exact_account();
  EXPECT_GT(totals.lost, 0U);
  std::printf("%d hours: %llu samples in files, %llu lost, all accounted for\n", hours(),
              static_cast<unsigned long long>(totals.frames), static_cast<unsigned long long>(totals.lost));
}

}  // namespace
}  // namespace triskin::test
