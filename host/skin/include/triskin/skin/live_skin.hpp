// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "triskin/connect/open_bus.hpp"
#include "triskin/robot/site.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/stream_options.hpp"
#include "triskin/session/stream_report.hpp"
#include "triskin/skin/calibrate.hpp"
#include "triskin/skin/live_cover.hpp"

/// A skin that is open (docs/live_skin.md): LiveSkin has a LiveBus for each bus, which has a LiveCover for each cover.
namespace triskin::device {

class Stream;

/// A stretch of receiving.
struct LiveRun {
  std::uint64_t until_us = UINT64_MAX;  ///< end, time of the link
  std::uint64_t slice_us = 100'000;     ///< how often the functions below are called, time of the link, > 0
  std::function<void()> before_slice{};
  std::function<bool()> after_slice{};  ///< false ends the run
};

/// Samples that arrived and that were lost.
struct LiveTotals {
  std::uint64_t frames = 0, lost = 0;
  LiveTotals& operator+=(const LiveTotals& other) {
    frames += other.frames;
    lost += other.lost;
    return *this;
  }
};

/// One bus of a skin. Threads: one at a time; different buses may be used by different threads.
class LiveBus {
 public:
  using OnSample = std::function<void(const LiveSample&)>;

  /// Opens nothing yet. `site` outlives it. `bus`: index in the site.
  LiveBus(const robot::Site& site, std::size_t bus, LinkOptions link);
  ~LiveBus();
  LiveBus(const LiveBus&) = delete;
  LiveBus& operator=(const LiveBus&) = delete;

  /// Opens the link, anew when it is open. Throws as open_bus.
  void open();
  /// Ends the stream, if there is one, and closes the link. The covers are gone then.
  void close();
  /// Its index in LiveSkin::buses().
  [[nodiscard]] std::size_t index() const { return index_; }
  /// What the robot file says of it.
  [[nodiscard]] const robot::BusConfig& config() const { return config_; }
  /// The link. Only while it is open, as the next two.
  [[nodiscard]] Link& link() { return *link_; }
  /// Requests to the controllers on the link.
  [[nodiscard]] Bus& bus() { return *bus_; }
  /// Time of the link, µs.
  [[nodiscard]] std::uint64_t now_us() const { return link_->now_us(); }
  /// The covers that were chosen, in the order of the site; none while the link is closed.
  [[nodiscard]] std::deque<LiveCover>& covers() { return covers_; }
  [[nodiscard]] const std::deque<LiveCover>& covers() const { return covers_; }
  /// Calendar time, ns since 1970, of a time of the link. The two clocks are compared when the link is opened.
  [[nodiscard]] std::uint64_t unix_ns(std::uint64_t link_us) const;

  /// Asks who is there, and sets the rest values of all covers. Takes 0.12 s. Throws Unreachable, InputError when kept
  /// rest values are damaged.
  void find_controllers(RestSource rest = RestSource::kKept);
  /// Who answered when find_controllers() asked.
  [[nodiscard]] std::span<const wire::NodeClaim> claims() const { return claims_; }
  /// What is known of the calibration of a cover, as calibration_of has it; asks the controllers. `boards` go before
  /// what controllers and this computer keep. Call after find_controllers(); LiveCover::set_calibration uses it. Throws
  /// as calibration_of.
  [[nodiscard]] FoundCalibration find_calibration(const LiveCover& cover,
                                                  std::span<const design::BoardCalibration> boards);

  /// Begins the stream of all covers, after find_controllers() if that was not called. The rate and the neighbours of
  /// the robot file are added to `options`. `on_sample` is called in the calls of this class that wait. Throws as
  /// Stream.
  void start(const StreamOptions& options, OnSample on_sample);
  /// True while a stream has begun and not ended.
  [[nodiscard]] bool runs() const { return stream_ != nullptr; }
  /// Receives until the run ends or the process is asked to end (interrupt_request()). Throws Unreachable and what the
  /// functions of `run` throw; the stream has ended then.
  void run(const LiveRun& run);
  /// Takes new rest values on all covers, and receives until they are there, at most Tare::kLimit_us. Throws
  /// Unreachable, and DeviceError when no valid sample arrived. Returns early when the process is asked to end.
  void tare();
  /// Ends the stream; its reports stay. Takes at most 0.5 s. No effect when none runs.
  void finish();
  /// Opens, starts and runs; a link that cannot be opened or fails is said by `on_cut` and opened again every second.
  /// Returns when the run ends or the process is asked to end. Throws InputError.
  void follow(const StreamOptions& options, const OnSample& on_sample, const LiveRun& run,
              const std::function<void(const std::string&)>& on_cut);

  /// Account of the running stream, or of the last one: of all covers, or of one.
  [[nodiscard]] StreamReport report() const;
  [[nodiscard]] StreamReport report(std::size_t cover) const;
  /// Over all streams of this bus.
  [[nodiscard]] LiveTotals totals() const;

 private:
  void take(const ModuleSample& sample, const OnSample& on_sample);
  void forget_stream();

  const robot::Site& site_;
  std::size_t index_;
  const robot::BusConfig& config_;
  LinkOptions link_options_;
  std::unique_ptr<Link> link_;
  std::unique_ptr<Bus> bus_;
  std::deque<LiveCover> covers_;
  std::vector<wire::NodeClaim> claims_;
  bool discovered_ = false;
  std::uint64_t opened_us_ = 0, opened_unix_ns_ = 0;
  std::unique_ptr<Stream> stream_;
  StreamReport last_report_;
  std::vector<StreamReport> last_reports_;  // Indexed by cover.
  LiveTotals before_;                       // Totals of streams that have ended.
};

/// A robot or a design on its links.
class LiveSkin {
 public:
  /// Opens nothing yet. Buses without a chosen cover are left out (robot::choose).
  LiveSkin(robot::Site site, const LinkOptions& link);

  /// Opens the links of all buses. Throws as open_bus.
  void open();
  /// The file that was read: its buses and covers.
  [[nodiscard]] const robot::Site& site() const { return *site_; }
  /// Indexed as the buses of the site.
  [[nodiscard]] const std::vector<std::unique_ptr<LiveBus>>& buses() const { return buses_; }
  /// The open links, indexed as the buses.
  [[nodiscard]] std::vector<Link*> links() const;
  /// Runs `work` for each bus, side by side. Throws as robot::on_each_bus.
  void on_each_bus(const std::function<void(LiveBus& bus)>& work);

 private:
  std::unique_ptr<const robot::Site> site_;
  std::vector<std::unique_ptr<LiveBus>> buses_;
};

}  // namespace triskin::device
