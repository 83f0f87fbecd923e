// SPDX-License-Identifier: GPL-3.0-or-later
#include "stream_options.hpp"

#include <cstdio>

#include "triskin/session/clock_filter.hpp"

namespace triskin::cli {
namespace {

nlohmann::json losses_of(const session::StreamReport& r) {
  nlohmann::json rows = nlohmann::json::array();
  for (const session::ModuleCounts& m : r.modules) {
    if (m.counts.lost() == 0 && !m.never_heard() && !m.slow) continue;
    rows.push_back({{"module", m.number},
                    {"patch", m.patch},
                    {"expected", m.counts.expected},
                    {"received", m.counts.received},
                    {"with_data", m.counts.with_data},
                    {"unread", m.counts.unread},
                    {"dropped", m.counts.dropped},
                    {"on_the_way", m.counts.on_the_way},
                    {"silent", m.counts.silent}});
  }
  return rows;
}

nlohmann::json clocks_of(const session::StreamReport& r) {
  nlohmann::json rows = nlohmann::json::array();
  for (const session::ClockState& c : r.clocks) {
    rows.push_back({{"patch", c.patch}, {"node", c.node}, {"drift_ppm", c.drift_ppm}, {"restarts", c.restarts}});
    if (c.error_us != session::LinkTime::kUnbounded) rows.back()["error_us"] = c.error_us;
  }
  return rows;
}

}  // namespace

void add_decimation_option(CLI::App& app, session::StreamOptions& options) {
  app.add_option_function<int>(
         "--decimation",
         [&options](const int& readings) {
           for (const auto d : {wire::Decimation::k256, wire::Decimation::k128, wire::Decimation::k64})
             if (wire::readings_added(d) == readings) options.decimation = d;
         },
         "readings per sample: 256, 128 or 64, for 27, 54 or 108 samples a second with more noise; kept until "
         "power-off (default: as set)")
      ->check(CLI::IsMember({256, 128, 64}));
  app.add_option_function<std::string>(
         "--readings",
         [&options](const std::string& name) {
           options.timing = name == "timer" ? wire::SamplingTiming::kTimer : wire::SamplingTiming::kTracked;
         },
         "when converters are read: tracked (their twelve results belong together) or timer (as installed iCub boards "
         "do); kept until power-off (default: as set)")
      ->check(CLI::IsMember({"tracked", "timer"}));
}

void add_stream_options(CLI::App& app, session::StreamOptions& options) {
  add_decimation_option(app, options);
  app.add_option("--every", options.every, "stream each n-th sample (0: the smallest n that fits the bus)")
      ->check(CLI::Range(0, 255))
      ->capture_default_str();
  app.add_flag("--overload", options.overload,
               "with --every: stream even if it does not fit the bus; lost samples are counted");
}

session::StreamOptions speaking(session::StreamOptions options) {
  options.say = say_aside;
  return options;
}

void add_stream_keys(const session::StreamReport& r, nlohmann::json& result) {
  result["samples"] = r.total.received;
  result["expected"] = r.total.expected;
  result["lost"] = r.total.lost();
  result["never_heard"] = r.never_heard;
  result["every"] = r.budget.every;
  result["bus_load"] = r.budget.load;
  result["starved"] = r.starved;
  result["silent"] = r.silent;
  result["losses"] = losses_of(r);
  result["clocks"] = clocks_of(r);
}

int conclude(const session::StreamReport& r, Output& output) {
  for (const std::string& line : sentences(r)) output.say(line);
  add_stream_keys(r, output.result);
  return r.complete() ? 0 : 1;
}

}  // namespace triskin::cli
