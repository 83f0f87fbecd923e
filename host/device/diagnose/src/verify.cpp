// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "controller_check.hpp"
#include "cover_place.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/diagnose/board_report.hpp"
#include "triskin/session/scheduler.hpp"
#include "triskin/session/stream.hpp"
#include "verification.hpp"

namespace triskin::diagnose {
namespace {

constexpr std::uint64_t kStartLimit_us = 3'000'000;
constexpr std::uint64_t kPoll_us = 20'000;

// Waits until every module was found and checked, or is known to be absent.
void wait_until_checked(session::Bus& bus, const PatchState& p) {
  const std::uint64_t limit_us = bus.now_us() + kStartLimit_us;
  while (bus.now_us() < limit_us) {
    const wire::ModuleStates states = p.controller(bus).module_states();
    if (std::ranges::none_of(states.rows(), [](wire::ModuleState s) { return s == wire::ModuleState::kUnknown; }))
      return;
    bus.listen(bus.now_us() + kPoll_us);
  }
}

// Reads and deletes the earlier faults, so that a fault is recorded again when it recurs.
void start_patch(session::Bus& bus, PatchState& p) {
  wait_until_checked(bus, p);
  session::Controller c = p.controller(bus);
  p.earlier = c.faults();
  p.crash = c.crash();
  p.first = c.taxels();
  if (p.earlier.count > 0 || p.crash) c.clear_faults();
}

// Removes adopted modules, which belong to another patch, from a topology.
wire::FoundTopology without_adopted(const wire::FoundTopology& found, const wire::Adoption& adoption) {
  const auto is_adopted = [&](std::size_t m) { return found.row[m] != wire::kNoRow && found.row[m] >= adoption.rows; };
  if (adoption.count == 0) return found;
  std::array<std::uint8_t, layout::kMaxModules> number{};
  wire::FoundTopology own = found;
  own.count = 0;
  for (std::size_t m = 0; m < found.count; ++m) number[m] = is_adopted(m) ? wire::kNoRow : own.count++;
  for (std::size_t m = 0; m < found.count; ++m) {
    if (number[m] == wire::kNoRow) continue;
    own.row[number[m]] = found.row[m];
    for (std::size_t p = 0; p < layout::kPorts; ++p) {
      const std::uint8_t joint = found.joints[m][p];
      const bool kept = joint != 0 && number[layout::joint_row(joint)] != wire::kNoRow;
      own.joints[number[m]][p] =
          kept ? layout::joint_to(number[layout::joint_row(joint)], layout::joint_port(joint)) : std::uint8_t{0};
    }
  }
  return own;
}

// Lets switched modules be searched again before anything is asked of them.
void find_topology(session::Bus& bus, PatchState& p) {
  session::Controller c = p.controller(bus);
  c.reroute();
  p.note(c.adoption());
  p.topology = without_adopted(c.topology(), p.adoption);
  p.route = c.route();
}

void read_patch(session::Bus& bus, PatchState& p) {
  session::Controller c = p.controller(bus);
  p.states = c.module_states();
  p.faults = c.faults();
  if (const auto crash = c.crash()) p.crash = crash;
  p.line_states = c.line_states();
  p.note(c.adoption());
  p.now = c.taxels();
  if (p.states.count != p.image.module_count || p.now.count != p.image.module_count) {
    throw DeviceError(fmt::format("{}: controller {} changed its table while it was verified; run verify again",
                                  bus.link().name(), c.node()));
  }
}

void add_crashes(const std::vector<PatchState>& patches, const VerifyOptions& options, VerifyResult& result) {
  for (const PatchState& p : patches) {
    if (!p.crash) continue;
    result.findings.push_back(controller_finding(options.elf.empty() ? Seen::kCrash : Seen::kCrashNamed, p.patch,
                                                 fmt::arg("node", p.image.node_address),
                                                 fmt::arg("crash", crash_text(*p.crash, options.elf))));
  }
}

// Asks patches on different wires in parallel.
void ask_all(session::Bus& bus, std::vector<PatchState>& patches,
             const std::function<void(session::Bus&, PatchState&)>& ask) {
  std::vector<session::Task> tasks;
  for (PatchState& p : patches) {
    if (p.usable) tasks.push_back({p.image.node_address, [&](session::Bus& own) { ask(own, p); }});
  }
  for (const std::exception_ptr& e : session::run_tasks(bus.link(), tasks)) {
    if (e) std::rethrow_exception(e);
  }
}

std::size_t usable_modules(const std::vector<PatchState>& patches) {
  std::size_t modules = 0;
  for (const PatchState& p : patches) modules += p.usable ? p.image.module_count : 0;
  return modules;
}

std::vector<TouchOutcome> touch_all(session::Bus& bus, const design::Design& design, std::vector<PatchState>& patches,
                                    const VerifyOptions& options, const ProgressSink& progress) {
  std::vector<TouchOutcome> outcomes;
  TouchTest test(bus, options.actuator, design, patches);
  test.take_rest();
  const std::size_t total = usable_modules(patches);
  std::size_t done = 0;
  for (const PatchState& p : patches) {
    for (std::size_t row = 0; p.usable && row < p.image.module_count; ++row) {
      report(progress, "touching", static_cast<double>(done++) / static_cast<double>(total),
             fmt::format("module {}", design::number_of(design, p.module(row))));
      if (const auto outcome = test.press(p.module(row), p, options)) outcomes.push_back(*outcome);
    }
  }
  test.finish();
  return outcomes;
}

// Reads the stream for a while; samples that were due and did not arrive become findings of their patches.
void watch_stream(session::Bus& bus, const design::Design& design, const VerifyOptions& options, std::uint64_t until_us,
                  VerifyResult& result) {
  constexpr std::uint64_t kMinStream_us = 500'000;
  session::StreamOptions stream_options;
  stream_options.neighbours = options.neighbours;
  session::Stream stream(bus, design, {}, stream_options);
  stream.run_until(std::max(until_us, bus.now_us() + kMinStream_us));
  stream.finish();
  result.stream = stream.report();
  std::map<layout::PatchIndex, session::SampleCounts> patches;
  for (const session::ModuleCounts& m : result.stream->modules) patches[m.patch] += m.counts;
  for (const auto& [patch, c] : patches) {
    const std::uint64_t lost = c.dropped + c.on_the_way + c.silent;  // Unread samples have their own findings.
    if (lost == 0) continue;
    result.findings.push_back(controller_finding(
        Seen::kSamplesLost, patch, fmt::arg("lost", lost), fmt::arg("samples", counted(c.expected, "sample")),
        fmt::arg("dropped", c.dropped), fmt::arg("on_the_way", c.on_the_way), fmt::arg("silent", c.silent),
        fmt::arg("budget", describe(result.stream->budget))));
  }
}

// The result is indexed by patch; a patch without a controller on this bus has no rows and is never usable.
std::vector<PatchState> states_of(const design::Design& design) {
  std::vector<PatchState> patches(design.patches.size());
  for (std::size_t k = 0; k < patches.size(); ++k) {
    patches[k].patch = layout::PatchIndex{k};
    patches[k].design = &design;
  }
  for (const layout::PatchIndex patch : design::patches_here(design))
    patches[static_cast<std::size_t>(patch)].image = session::image_of(design, patch);
  return patches;
}

// A finding about a controller, a cable or a line gets the place where the cable of its patch enters the cover.
void add_places(const design::Design& design, std::vector<Finding>& findings) {
  for (Finding& f : findings) {
    if (!f.place.empty() || f.patch < 0) continue;
    const layout::ModuleId entry{design.patches[static_cast<std::size_t>(f.patch)].entry};
    f.place = fmt::format("cable of patch {} at module {}, {}", f.patch, design::number_of(design, entry),
                          place_on_cover(design, entry));
  }
}

int modules_here(const design::Design& design) {
  auto modules = design.layout.modules.size();
  for (std::size_t p = 0; p < design.patches.size(); ++p) {
    if (design::node_address_of(design, layout::PatchIndex{p}) == 0) modules -= design.patches[p].modules.size();
  }
  return static_cast<int>(modules);
}

void check_controllers(session::Bus& bus, const design::Design& design, std::vector<PatchState>& patches,
                       std::vector<Finding>& findings) {
  ControllerCheck controllers(bus, design);
  for (const int patch : design::patches_here(design)) {
    PatchState& p = patches[static_cast<std::size_t>(patch)];
    p.usable = controllers.check(p, findings);
  }
  controllers.summarise(findings);
}

bool is_as_designed(const PatchState& p) {
  return p.image.module_count == 0 || (p.usable && !p.on_backup);
}

}  // namespace

VerifyResult verify(session::Bus& bus, const design::Design& design, const VerifyOptions& options,
                    const ProgressSink& progress) {
  const std::uint64_t start_us = bus.now_us();
  report(progress, "finding controllers", -1.0);
  VerifyResult result;
  std::vector<PatchState> patches = states_of(design);
  result.modules = modules_here(design);
  check_controllers(bus, design, patches, result.findings);
  ask_all(bus, patches, [&](session::Bus& own, PatchState& p) {
    report(progress, "asking the modules", 0.0, fmt::format("patch {}", p.patch), p.patch);
    find_topology(own, p);
    start_patch(own, p);
    p.lines = p.controller(own).discover();
    report(progress, "asked", 1.0, fmt::format("patch {}", p.patch), p.patch);
  });
  std::vector<TouchOutcome> touches;
  if (options.touch) touches = touch_all(bus, design, patches, options, progress);
  const auto watch_us = static_cast<std::uint64_t>(std::max(0.0, options.watch_s) * 1e6);
  if (bus.link().fd() && std::ranges::all_of(patches, is_as_designed)) {
    watch_stream(bus, design, options, start_us + watch_us, result);
  } else if (std::ranges::any_of(patches, &PatchState::usable)) {
    bus.listen(start_us + watch_us);
  }
  ask_all(bus, patches, read_patch);
  add_crashes(patches, options, result);
  result.touched = static_cast<int>(touches.size());
  Diagnosis(design, std::move(patches), std::move(touches), options.rest).run(result);
  add_places(design, result.findings);
  return result;
}

}  // namespace triskin::diagnose
