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
#include "triskin/design/module_number.hpp"
#include "triskin/session/adopted_modules.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/bus_budget.hpp"
#include "triskin/session/clock_filter.hpp"
#include "triskin/session/module_sample.hpp"
#include "triskin/session/sample_account.hpp"
#include "triskin/session/stream_options.hpp"
#include "triskin/session/stream_report.hpp"
#include "triskin/wire/sampling.hpp"

namespace triskin::session {

class Controller;

/// A stream object reads the data stream of all controllers of a design, or of several designs on one bus. It holds a
/// lease on the stream and renews it; leases of other readers do not affect it. Every sample that was due is accounted
/// for as received, or as lost and where. Each controller is asked for its clock when the stream begins and once a
/// second, so each sample has a time and an error bound.
class Stream {
 public:
  using OnFrame = std::function<void(const ModuleSample&)>;

  /// Requests a lease from every controller of the design. `bus` must outlive the stream; the waiting calls of the bus
  /// call `handler`, with samples of the lease only. Throws DeviceError when a controller is missing, has another
  /// table, has a firmware that keeps no account, serves as many readers as it can, or would have to change its
  /// sampling while others read it; InputError when the link cannot carry the full stream (no FD frames) or what
  /// `options` asks for does not fit the bus.
  Stream(Bus& bus, const design::Design& design, OnFrame handler, StreamOptions options = {});
  /// Reads several designs (docs/robot.md) with one rate and one budget. `covers` need not outlive the call;
  /// messages use their names. ModuleSample::cover and ModuleCounts::cover follow their order.
  Stream(Bus& bus, std::span<const design::Design* const> covers, OnFrame handler, StreamOptions options = {});
  /// Gives the lease back if the link still works.
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// Receives until `until_us` of the link's clock, including frames that have already arrived. It also renews the
  /// lease, so call it at least once a second. Throws Unreachable, Cancelled.
  void run_until(std::uint64_t until_us);
  /// Ends the lease: asks the controllers what they sent, waits for samples that are in transit (at most 0.3 s beyond
  /// the pace), and gives the lease back. For controllers that do not answer, the rate gives the number of samples.
  /// Further calls do nothing. Throws nothing.
  void finish();
  /// Counts the received frames of modules.
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Counts the samples that were due and did not arrive, up to the latest sample of each module; after finish(), over
  /// the whole lease.
  [[nodiscard]] std::uint64_t lost() const { return report().total.lost(); }
  /// Returns the account of every module and of the bus.
  [[nodiscard]] StreamReport report() const { return report_of(kAllCovers); }
  /// Returns the account of the modules of one of several designs; its budget is that of the bus.
  [[nodiscard]] StreamReport report(layout::CoverIndex cover) const { return report_of(cover); }
  /// Returns how the samples fit the bus.
  [[nodiscard]] const BusBudget& budget() const { return budget_; }

 private:
  static constexpr layout::CoverIndex kAllCovers = layout::CoverIndex::none();
  struct Node {
    layout::CoverIndex cover;
    layout::PatchIndex patch;
    std::vector<layout::ModuleId> modules;  // Modules are indexed by the row of the table.
    std::vector<SampleAccount> counts;      // Counts are indexed by the row of the table.
    std::uint64_t interval_us = 0;          // Two samples of a module are nominally this far apart.
    std::uint64_t heard_us = 0;             // The node's latest frame arrived at this time of the link's clock.
    std::uint64_t begin_device_us = 0;
    ClockFilter clock;
    std::uint64_t asked_us = 0;          // The node was last asked for its clock at this time of the link's clock.
    std::uint64_t newest_device_us = 0;  // The newest sample has this time stamp of the controller.
    std::uint64_t due = 0;               // At the end, the rate gives this many samples per module.
    AdoptedReader adopted_modules;
    bool silent = false;
    bool started = false;
    // These frames arrived before the account began; the time of arrival is stored with each.
    std::deque<std::pair<wire::TaxelFrame, std::uint64_t>> early;
  };
  void find_controllers(const design::Design& design, layout::CoverIndex cover, const StreamOptions& options);
  wire::SamplingSetting set_sampling(Controller& controller, const Node& node, const StreamOptions& options);
  [[nodiscard]] StreamReport report_of(layout::CoverIndex cover) const;
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
  [[nodiscard]] bool read_by_another(const Node& node, layout::ModuleId module) const;
  void end(std::uint8_t address, Node& node);
  void wait_for_rest();
  [[nodiscard]] design::ModuleNumber number_of(const Node& node, layout::ModuleId module) const;
  [[nodiscard]] std::uint64_t silence_us(const Node& node) const;

  Bus& bus_;
  std::vector<std::vector<int>> numbers_;  // by cover, then by module
  OnFrame handler_;
  std::function<void(const std::string&)> say_;
  std::vector<std::string> covers_;
  std::vector<ModuleEnds> ends_;
  std::map<std::uint8_t, Node> nodes_;
  BusBudget budget_;
  std::uint32_t reader_ = 0;
  std::uint64_t renewed_us_ = 0;
  std::uint64_t frames_ = 0;
  std::uint64_t thrown_away_before_ = 0;
  int lapses_ = 0;
  bool finished_ = false;
};

}  // namespace triskin::session
