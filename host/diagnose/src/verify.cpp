// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "triskin/session/scheduler.hpp"
#include "triskin/session/stream.hpp"
#include "verification.hpp"

namespace triskin::device {
namespace {

constexpr std::uint64_t kStartLimit_us = 3'000'000;
constexpr std::uint64_t kPoll_us = 20'000;

Finding controller_finding(FindingKind kind, int patch, std::string text, std::string remedy) {
  Finding f;
  f.kind = kind;
  f.patch = patch;
  f.text = std::move(text);
  f.remedy = std::move(remedy);
  return f;
}

// Whether the controller of a patch is there and holds the table of the design.
class ControllerCheck {
 public:
  ControllerCheck(Bus& bus, const design::Design& design) : bus_(bus), design_(design), claims_(bus.discover()) {
    for (const auto& c : claims_) {
      ++users_[c.node_address];
      if (!c.has_table) ++without_table_;
    }
    if (claims_.empty())
      throw DeviceError(fmt::format("{}: no controller answers; check power, cable and bit rate", bus.link().name()));
  }

  bool check(PatchState& p, std::vector<Finding>& findings) {
    const int node = p.image.node_address;
    const auto claim = std::ranges::find_if(claims_, [&](const auto& c) { return c.node_address == node; });
    if (claim == claims_.end() || !claim->has_table || users_[node] > 1) {
      findings.push_back(missing(p.patch, node));
      return false;
    }
    Controller c = p.controller(bus_);
    c.require_versions(c.hello());
    const wire::ActiveTable active = c.active_table();
    if (active.design_id == design_.design_id && holds_image(active.crc, p.image)) return true;
    if (active.design_id == design_.design_id && runs_on_backup(p, active.crc, findings)) return true;
    if (differs_in_kinds(p, c, active, findings)) return false;
    findings.push_back(
        controller_finding(FindingKind::kWrongTable, p.patch,
                           fmt::format("patch {}: controller {} holds another table (design {:016x}, this is {:016x})",
                                       p.patch, node, active.design_id, design_.design_id),
                           "run triskin flash with this design, or verify with the design that was flashed"));
    return false;
  }

 private:
  // The table of a design with the same modules, places and wiring, but other kinds: a finding for each module.
  bool differs_in_kinds(const PatchState& p, Controller& c, const wire::ActiveTable& active,
                        std::vector<Finding>& findings) {
    if (!active.present() || active.modules != p.image.module_count) return false;
    const auto bytes = c.read_table(layout::kHeaderBytes + active.modules * layout::kRowBytes);
    const auto table = layout::decode(bytes);
    if (!table) return false;
    layout::PatchImage alike = *table;
    alike.design_id = p.image.design_id;
    alike.positive_input = p.image.positive_input;
    for (std::size_t k = 0; k < alike.module_count; ++k) alike.modules[k].module_id = p.image.modules[k].module_id;
    if (!(alike == p.image)) return false;
    std::size_t count = 0;
    for (std::size_t k = 0; k < table->module_count; ++k) {
      const unsigned is = table->modules[k].module_id, meant = p.image.modules[k].module_id;
      if (is % layout::kIdsBesideKinds != meant % layout::kIdsBesideKinds) return false;
      count += is == meant ? 0 : 1;
    }
    if (count == 0) return false;
    for (std::size_t k = 0; k < table->module_count; ++k) {
      const int is = table->modules[k].module_id >> layout::kKindShift,
                meant = kind_of_row(design_, p.image.modules[k]);
      if (is == meant) continue;
      Finding f = controller_finding(
          FindingKind::kWrongKind, p.patch,
          fmt::format("patch {}: module {} is {} in the table of controller {}, {} in the design", p.patch, p.module(k),
                      name_of_kind(is), p.image.node_address, name_of_kind(meant)),
          "look which kind is mounted; run triskin flash with the design that says so");
      f.module = p.module(k);
      findings.push_back(std::move(f));
    }
    return true;
  }

  // Kinds of the other design may be named otherwise: it is not at hand.
  [[nodiscard]] std::string name_of_kind(int kind) const {
    if (kind == 0) return "of the standard kind";
    if (kind > static_cast<int>(design_.kinds.kinds.size())) return fmt::format("of kind {}", kind);
    return fmt::format("of kind {} ({})", kind, design_.kinds.kinds[static_cast<std::size_t>(kind) - 1].name);
  }

  // A table that the design prepared for a failure is right as well; a finding says what it leaves out.
  bool runs_on_backup(PatchState& p, std::uint32_t crc, std::vector<Finding>& findings) {
    for (const design::FailureLoss& f : design_.patches[static_cast<std::size_t>(p.patch)].failures) {
      const RouteChoice choice{f.node, f.other_node};
      if (f.node == design_.patches[static_cast<std::size_t>(p.patch)].entry && f.other_node < 0) continue;
      const layout::PatchImage image = image_of(design_, p.patch, choice);
      if (crc32(bytes_of(image)) != crc) continue;
      const std::string what = choice.other < 0
                                   ? fmt::format("module {}", choice.module)
                                   : fmt::format("the joint of modules {} and {}", choice.other, choice.module);
      findings.push_back(controller_finding(
          FindingKind::kBackupRoute, p.patch,
          fmt::format("patch {}: runs on the route prepared for the failure of {}; {} of {} modules are read", p.patch,
                      what, image.module_count, p.image.module_count),
          "repair it, then run triskin flash without --route"));
      p.image = image;
      p.on_backup = true;
      return true;
    }
    return false;
  }

  Finding missing(int patch, int node) {
    if (users_[node] > 1 && without_table_ == 0) {
      return controller_finding(
          FindingKind::kDuplicateController, patch,
          fmt::format("patch {}: {} controllers share node address {}", patch, users_[node], node),
          "run triskin flash: it gives every controller its own address");
    }
    if (without_table_ > 0) {
      return controller_finding(
          FindingKind::kNotFlashed, patch,
          fmt::format("patch {}: no controller has its table; {} of {} controllers were never flashed", patch,
                      without_table_, claims_.size()),
          "run triskin flash with this design and link first");
    }
    return controller_finding(FindingKind::kAbsentController, patch,
                              fmt::format("patch {}: no controller answers at node address {}", patch, node),
                              "check its power and its cable to the bus");
  }

  Bus& bus_;
  const design::Design& design_;
  std::vector<wire::NodeClaim> claims_;
  std::map<int, int> users_;
  std::size_t without_table_ = 0;
};

// Waits until every module was found and checked, or is known to be absent.
void wait_until_checked(Bus& bus, const PatchState& p) {
  const std::uint64_t limit_us = bus.now_us() + kStartLimit_us;
  while (bus.now_us() < limit_us) {
    const wire::ModuleStates states = p.controller(bus).module_states();
    if (std::ranges::none_of(states.rows(), [](wire::ModuleState s) { return s == wire::ModuleState::kUnknown; }))
      return;
    bus.listen(bus.now_us() + kPoll_us);
  }
}

// Reads and deletes the earlier faults, so that the same fault shows when it occurs again.
void start_patch(Bus& bus, PatchState& p) {
  wait_until_checked(bus, p);
  Controller c = p.controller(bus);
  p.earlier = c.faults();
  if (p.earlier.count > 0) c.clear_faults();
}

// Modules that were taken in belong to another patch: what was found of this one is the rest.
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

// Switched modules are found anew before anything is asked of them.
void find_topology(Bus& bus, PatchState& p) {
  Controller c = p.controller(bus);
  c.reroute();
  p.note(c.adoption());
  p.topology = without_adopted(c.topology(), p.adoption);
  p.route = c.route();
}

void read_patch(Bus& bus, PatchState& p) {
  Controller c = p.controller(bus);
  p.states = c.module_states();
  p.faults = c.faults();
  p.line_states = c.line_states();
  p.note(c.adoption());
  p.now = c.taxels();
  if (p.states.count != p.image.module_count || p.now.count != p.image.module_count) {
    throw DeviceError(fmt::format("{}: controller {} changed its table while it was verified; run verify again",
                                  bus.link().name(), c.node()));
  }
}

// Patches on different wires side by side.
void ask_all(Bus& bus, std::vector<PatchState>& patches, const std::function<void(Bus&, PatchState&)>& ask) {
  std::vector<Task> tasks;
  for (PatchState& p : patches) {
    if (p.usable) tasks.push_back({p.image.node_address, [&](Bus& own) { ask(own, p); }});
  }
  for (const std::exception_ptr& e : run_tasks(bus.link(), tasks)) {
    if (e) std::rethrow_exception(e);
  }
}

std::vector<TouchOutcome> touch_all(Bus& bus, const design::Design& design, std::vector<PatchState>& patches,
                                    const VerifyOptions& options, const ProgressSink& progress) {
  std::vector<TouchOutcome> outcomes;
  TouchTest test(bus, options.actuator, design, patches);
  test.take_rest();
  std::size_t total = 0;
  for (const PatchState& p : patches) total += p.usable ? p.image.module_count : 0;
  std::size_t done = 0;
  for (const PatchState& p : patches) {
    for (std::size_t row = 0; p.usable && row < p.image.module_count; ++row) {
      report(progress, "touching", static_cast<double>(done++) / static_cast<double>(total),
             fmt::format("module {}", p.module(row)));
      if (const auto outcome = test.press(p.module(row), p, options)) outcomes.push_back(*outcome);
    }
  }
  test.finish();
  return outcomes;
}

// The stream for a while: what was due and did not come is a finding of its patch.
void watch_stream(Bus& bus, const design::Design& design, const VerifyOptions& options, std::uint64_t until_us,
                  VerifyResult& result) {
  constexpr std::uint64_t kLeast_us = 500'000;
  StreamOptions stream_options;
  stream_options.neighbours = options.neighbours;
  Stream stream(bus, design, {}, stream_options);
  stream.run_until(std::max(until_us, bus.now_us() + kLeast_us));
  stream.finish();
  result.stream = stream.report();
  std::map<int, SampleCounts> patches;
  for (const ModuleCounts& m : result.stream->modules) patches[m.patch] += m.counts;
  for (const auto& [patch, c] : patches) {
    const std::uint64_t lost = c.dropped + c.on_the_way + c.silent;  // Unread samples have their own findings.
    if (lost == 0) continue;
    result.findings.push_back(controller_finding(
        FindingKind::kLostSamples, patch,
        fmt::format(
            "patch {}: {} of {} samples did not arrive: {} found no room on the bus, {} were lost on the way, {} "
            "while the controller was silent",
            patch, lost, c.expected, c.dropped, c.on_the_way, c.silent),
        fmt::format("check cable and termination; {}", describe(result.stream->budget))));
  }
}

// Indexed by patch; a patch with its controller on another bus has no rows and is never usable.
std::vector<PatchState> patches_of(const design::Design& design) {
  std::vector<PatchState> patches(design.patches.size());
  for (std::size_t k = 0; k < patches.size(); ++k) {
    patches[k].patch = static_cast<int>(k);
    patches[k].with_kinds = !design.kinds.empty();
  }
  for (const int patch : design::patches_here(design))
    patches[static_cast<std::size_t>(patch)].image = image_of(design, patch);
  return patches;
}

int modules_here(const design::Design& design) {
  auto modules = design.layout.modules.size();
  for (std::size_t p = 0; p < design.patches.size(); ++p) {
    if (design::node_address_of(design, static_cast<int>(p)) == 0) modules -= design.patches[p].modules.size();
  }
  return static_cast<int>(modules);
}

}  // namespace

VerifyResult verify(Bus& bus, const design::Design& design, const VerifyOptions& options,
                    const ProgressSink& progress) {
  const std::uint64_t start_us = bus.now_us();
  report(progress, "finding controllers", -1.0);
  VerifyResult result;
  std::vector<PatchState> patches = patches_of(design);
  result.modules = modules_here(design);
  ControllerCheck controllers(bus, design);
  for (const int patch : design::patches_here(design)) {
    PatchState& p = patches[static_cast<std::size_t>(patch)];
    p.usable = controllers.check(p, result.findings);
  }
  ask_all(bus, patches, [&](Bus& own, PatchState& p) {
    report(progress, "asking the modules", 0.0, fmt::format("patch {}", p.patch), p.patch);
    find_topology(own, p);
    start_patch(own, p);
    p.lines = p.controller(own).discover();
    report(progress, "asked", 1.0, fmt::format("patch {}", p.patch), p.patch);
  });
  std::vector<TouchOutcome> touches;
  if (options.touch) touches = touch_all(bus, design, patches, options, progress);
  const auto watch_us = static_cast<std::uint64_t>(std::max(0.0, options.watch_s) * 1e6);
  const auto as_designed = [](const PatchState& p) { return p.image.module_count == 0 || (p.usable && !p.on_backup); };
  if (bus.link().fd() && std::ranges::all_of(patches, as_designed)) {
    watch_stream(bus, design, options, start_us + watch_us, result);
  } else if (std::ranges::any_of(patches, &PatchState::usable)) {
    bus.listen(start_us + watch_us);
  }
  ask_all(bus, patches, read_patch);
  result.touched = static_cast<int>(touches.size());
  Diagnosis(design, std::move(patches), std::move(touches)).run(result);
  return result;
}

}  // namespace triskin::device
