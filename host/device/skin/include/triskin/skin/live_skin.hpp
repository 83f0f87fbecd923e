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

namespace triskin::session {
class Stream;
}

/// docs/stream.md explains an open skin: LiveSkin has a LiveBus for each bus, which has a LiveCover for each cover.
namespace triskin::skin {

/// One call that receives samples has these limits and callbacks.
struct LiveRun {
  std::uint64_t until_us = UINT64_MAX;  ///< Receiving ends at this time of the link.
  std::uint64_t slice_us = 100'000;     ///< The functions below are called this often, in time of the link, > 0.
  std::function<void()> before_slice{};
  std::function<bool()> after_slice{};  ///< The run ends when the function returns false.
};

/// Samples either arrive or are lost, and both are counted.
struct LiveTotals {
  std::uint64_t frames = 0, lost = 0;
  LiveTotals& operator+=(const LiveTotals& other) {
    frames += other.frames;
    lost += other.lost;
    return *this;
  }
};

/// Only one thread may use a bus of a skin at a time; different threads may use different buses.
class LiveBus {
 public:
  using OnSample = std::function<void(const LiveSample&)>;

  /// Stores the configuration without opening anything. `site` must outlive the bus; `bus` is its index in the site.
  LiveBus(const robot::Site& site, std::size_t bus, connect::LinkOptions link);
  ~LiveBus();
  LiveBus(const LiveBus&) = delete;
  LiveBus& operator=(const LiveBus&) = delete;

  /// Opens the link, or opens it again. Throws as open_bus.
  void open();
  /// Ends a running stream and closes the link. The covers are destroyed.
  void close();
  /// Returns the index in LiveSkin::buses().
  [[nodiscard]] std::size_t index() const { return index_; }
  /// Returns the entry of the bus in the robot file.
  [[nodiscard]] const robot::BusConfig& config() const { return config_; }
  /// Returns the link. Like the next two functions, it may only be called while the link is open.
  [[nodiscard]] link::Link& link() { return *link_; }
  /// Returns the object that sends requests to the controllers on the link.
  [[nodiscard]] session::Bus& bus() { return *bus_; }
  /// Returns the time of the link in µs.
  [[nodiscard]] std::uint64_t now_us() const { return link_->now_us(); }
  /// Returns the chosen covers in the order of the site; none while the link is closed.
  [[nodiscard]] std::deque<LiveCover>& covers() { return covers_; }
  [[nodiscard]] const std::deque<LiveCover>& covers() const { return covers_; }
  /// Converts a time of the link to calendar time, ns since 1970. The two clocks are compared when the link is opened.
  [[nodiscard]] std::uint64_t unix_ns(std::uint64_t link_us) const;

  /// Finds the controllers and sets the rest values of all covers; controllers whose covers have no stored ones are
  /// asked. Takes 0.12 s. Throws Unreachable, and InputError
  /// when stored rest values are damaged.
  void find_controllers(RestSource rest = RestSource::kKept);
  /// Throws DeviceError, which asks to flash first, when a patch of a cover has no controller with a table at its
  /// address while controllers without one are there. A controller that is missing says so when it is asked.
  void require_flashed() const;
  /// Returns the controllers that answered find_controllers().
  [[nodiscard]] std::span<const wire::NodeClaim> claims() const { return claims_; }
  /// Searches the calibration of a cover as calibration_of does, and asks the controllers for theirs. `boards` have
  /// priority over what controllers and this computer store. Call it after find_controllers();
  /// LiveCover::set_calibration takes the result. Throws as calibration_of.
  [[nodiscard]] FoundCalibration find_calibration(const LiveCover& cover,
                                                  std::span<const design::BoardCalibration> boards);

  /// Starts the stream of all covers, after find_controllers() if that was not called. The rate and the neighbours of
  /// the robot file are added to `options`. `on_sample` is called inside the waiting calls of this class. Throws as
  /// Stream.
  void start(const session::StreamOptions& options, OnSample on_sample);
  /// Returns true while a stream is running.
  [[nodiscard]] bool runs() const { return stream_ != nullptr; }
  /// Receives until the run ends or the process is asked to end (interrupt_request()). Throws Unreachable and the
  /// exceptions of the functions in `run`; the stream has then ended.
  void run(const LiveRun& run);
  /// Takes new rest values on all covers and receives until they are complete, at most for Tare::kLimit_us. Throws
  /// Unreachable, and DeviceError when no valid sample arrived. Returns early when the process is asked to end.
  void tare();
  /// Ends the stream; its reports remain. Takes at most 0.5 s. It has no effect when no stream runs.
  void finish();
  /// Opens, starts and runs. If the link cannot be opened or fails, `on_cut` gets the reason, and the link is tried
  /// again every second. Returns when the run ends or the process is asked to end. Throws InputError.
  void follow(const session::StreamOptions& options, const OnSample& on_sample, const LiveRun& run,
              const std::function<void(const std::string&)>& on_cut);

  /// Returns the account of the running stream, or of the last one, for all covers or for one.
  [[nodiscard]] session::StreamReport report() const;
  [[nodiscard]] session::StreamReport report(std::size_t cover) const;
  /// Returns the totals over all streams of this bus.
  [[nodiscard]] LiveTotals totals() const;

 private:
  void take(const session::ModuleSample& sample, const OnSample& on_sample);
  void forget_stream();

  const robot::Site& site_;
  std::size_t index_;
  const robot::BusConfig& config_;
  connect::LinkOptions link_options_;
  std::unique_ptr<link::Link> link_;
  std::unique_ptr<session::Bus> bus_;
  std::deque<LiveCover> covers_;
  std::vector<wire::NodeClaim> claims_;
  bool discovered_ = false;
  std::uint64_t opened_us_ = 0, opened_unix_ns_ = 0;
  std::unique_ptr<session::Stream> stream_;
  session::StreamReport last_report_;
  std::vector<session::StreamReport> last_reports_;  // The reports are indexed by cover.
  LiveTotals before_;                                // These totals belong to streams that have ended.
};

/// A skin is a robot or a design together with its links.
class LiveSkin {
 public:
  /// Stores the configuration without opening anything. Buses without a chosen cover are left out (robot::choose).
  LiveSkin(robot::Site site, const connect::LinkOptions& link);

  /// Opens the links of all buses. Throws as open_bus.
  void open();
  /// Returns the contents of the robot file: buses and covers.
  [[nodiscard]] const robot::Site& site() const { return *site_; }
  /// Returns the buses, indexed as in the site.
  [[nodiscard]] const std::vector<std::unique_ptr<LiveBus>>& buses() const { return buses_; }
  /// Returns the open links, indexed like the buses.
  [[nodiscard]] std::vector<link::Link*> links() const;
  /// Runs `work` for all buses in parallel. Throws as robot::on_each_bus.
  void on_each_bus(const std::function<void(LiveBus& bus)>& work);

 private:
  std::unique_ptr<const robot::Site> site_;
  std::vector<std::unique_ptr<LiveBus>> buses_;
};

}  // namespace triskin::skin
