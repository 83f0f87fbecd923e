// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/session/adopted_modules.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/bus_budget.hpp"
#include "triskin/session/clock_filter.hpp"
#include "triskin/session/module_sample.hpp"
#include "triskin/session/sample_account.hpp"
#include "triskin/session/stream_options.hpp"
#include "triskin/session/stream_report.hpp"
#include "triskin/wire/sampling.hpp"

namespace triskin::device {

class Controller;

/// A reader of the data stream of all controllers of a design, or of several designs that share a bus. It has a lease
/// on the stream and renews it; the ends of other readers leave it alone. Every sample that was due is accounted for:
/// received, or lost and where. Each controller is asked for its clock when the stream begins and once a second, so
/// each sample has a time and a bound.
class Stream {
 public:
  using OnFrame = std::function<void(const ModuleSample&)>;

  /// Takes a lease from every controller of the design. `bus` outlives the stream; `handler` is called inside the
  /// waiting calls of the bus, with samples of the lease only. Throws DeviceError when a controller is missing, holds
  /// another table, has a firmware that keeps no account, serves as many readers as it can, or is to sample in another
  /// way while others read it; InputError when the link cannot carry the full stream (no FD frames) or what `options`
  /// asks for does not fit the bus.
  Stream(Bus& bus, const design::Design& design, OnFrame handler, StreamOptions options = {});
  /// The same for several designs (docs/robot_file.md), one rate and one budget for all of them: `covers` need not
  /// outlive the call, their names stand in messages. ModuleSample::cover and ModuleCounts::cover count in their order.
  Stream(Bus& bus, std::span<const design::Design* const> covers, OnFrame handler, StreamOptions options = {});
  /// Gives the lease back, if the link still works.
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// Receives until `until_us` of the link's clock, and takes what has come already. Renews the lease: call it at least
  /// once a second. Throws Unreachable, Cancelled.
  void run_until(std::uint64_t until_us);
  /// Ends the lease: asks the controllers what they sent, waits for samples that are under way (at most 0.3 s beside
  /// the pace), gives the lease back. Controllers that do not answer are counted by their rate. Further calls do
  /// nothing. Throws nothing.
  void finish();
  /// Module frames received.
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Samples that were due and did not come, up to the latest sample of each module; after finish() of the whole lease.
  [[nodiscard]] std::uint64_t lost() const { return report().total.lost(); }
  /// Account of every module and of the bus.
  [[nodiscard]] StreamReport report() const { return report_of(kAllCovers); }
  /// Account of the modules of one of several designs; its budget is that of the bus.
  [[nodiscard]] StreamReport report(int cover) const { return report_of(cover); }
  /// How the samples fit the bus.
  [[nodiscard]] const BusBudget& budget() const { return budget_; }

 private:
  static constexpr int kAllCovers = -1;
  struct Node {
    int cover = 0;
    int patch = 0;
    std::vector<int> modules;           // Module of each row.
    std::vector<SampleAccount> counts;  // Counts of each row.
    std::uint64_t interval_us = 0;      // Nominal time between two samples of a module.
    std::uint64_t heard_us = 0;         // Time of its latest frame by the clock of the link.
    std::uint64_t begin_device_us = 0;
    ClockFilter clock;
    std::uint64_t asked_us = 0;          // Time of the last question about its clock, by the clock of the link.
    std::uint64_t newest_device_us = 0;  // Time stamp of its newest sample.
    std::uint64_t due = 0;               // Samples of a module that the rate gives, known at the end.
    AdoptedReader adopted_modules;
    bool silent = false;
    bool started = false;
    // Frames that arrived before the account began, with their times.
    std::deque<std::pair<wire::TaxelFrame, std::uint64_t>> early;
  };
  void find_controllers(const design::Design& design, int cover, const StreamOptions& options);
  wire::SamplingSetting set_sampling(Controller& controller, const Node& node, const StreamOptions& options);
  [[nodiscard]] StreamReport report_of(int cover) const;
  [[nodiscard]] std::string name_of(const Node& node) const;
  void choose_rate(const StreamOptions& options);
  void begin(std::uint8_t address, Node& node);
  void send_lease(std::uint8_t lasts_10ms);
  void give_back();
  void renew_when_due();
  void watch();
  void ask_clocks();
  void ask_clock(std::uint8_t address, Node& node);
  void handle(const wire::CanFrame& frame);
  void take(Node& node, const wire::TaxelFrame& sample, std::uint64_t heard_us);
  void take_adopted(Node& node, const wire::TaxelFrame& sample, std::uint64_t heard_us);
  void ask_adopted();
  [[nodiscard]] bool read_by_another(const Node& node, int module) const;
  void end(std::uint8_t address, Node& node);
  void wait_for_rest();
  [[nodiscard]] std::uint64_t silence_us(const Node& node) const;

  Bus& bus_;
  OnFrame handler_;
  std::function<void(const std::string&)> say_;
  std::vector<std::string> covers_;  // Names of the covers.
  std::vector<ModuleEnds> ends_;     // Joints of the covers' modules.
  std::map<std::uint8_t, Node> nodes_;
  BusBudget budget_;
  std::uint32_t reader_ = 0;
  std::uint64_t renewed_us_ = 0;
  std::uint64_t frames_ = 0;
  std::uint64_t thrown_away_before_ = 0;
  int lapses_ = 0;
  bool finished_ = false;
};

}  // namespace triskin::device
