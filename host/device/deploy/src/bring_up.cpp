// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/bring_up.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/diagnose/offset_report.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/link/link_kind.hpp"
#include "triskin/session/address_users.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/session/stream.hpp"

namespace triskin::deploy {
namespace {

constexpr int kLastToOpen = 8;  // More CAN interfaces or USB boards than this are not opened to look at them.
constexpr std::uint64_t kOffsets_us = 2'000'000;  // Every converter finds its offsets within this time.
constexpr double kMaxNoise = 10.0;                // The limit is in counts RMS; the data sheet gives 0.5 … 1.9.

StepAnswer passed(std::string found) {
  return {StepOutcome::kPassed, std::move(found)};
}
StepAnswer failed(std::string found) {
  return {StepOutcome::kFailed, std::move(found)};
}
StepAnswer skipped(std::string why) {
  return {StepOutcome::kSkipped, std::move(why)};
}

/// Computes mean and deviation of each taxel of a module while nothing touches it.
class Rest {
 public:
  void add(const session::ModuleSample& f) {
    ++samples_;
    for (std::size_t t = 0; t < sum_.size(); ++t) {
      if ((f.sample.valid >> t & 1) == 0) continue;
      const double x = f.sample.value[t] - 32768.0;
      ++count_[t];
      sum_[t] += x;
      square_[t] += x * x;
    }
  }
  [[nodiscard]] int samples() const { return samples_; }
  [[nodiscard]] bool in_middle_third(std::size_t t) const {
    const double rest = 32768.0 + mean(t);
    return count_[t] > 0 && rest >= wire::kRestLeast && rest <= wire::kRestMost;
  }
  [[nodiscard]] double noise(std::size_t t) const {
    if (count_[t] == 0) return 0.0;
    return std::sqrt(std::max(0.0, square_[t] / count_[t] - mean(t) * mean(t)));
  }

 private:
  [[nodiscard]] double mean(std::size_t t) const { return count_[t] == 0 ? 0.0 : sum_[t] / count_[t]; }
  int samples_ = 0;
  std::array<int, layout::kTaxelsPerModule> count_{};
  std::array<double, layout::kTaxelsPerModule> sum_{}, square_{};
};

class Session {
 public:
  Session(const design::Design& design, const BringUpOptions& options) : design_(design), options_(options) {}

  StepAnswer run(const BringUpStep& step) {
    if (step.number < 7) return ask(step);
    if (!open(step)) return step.number <= kLastToOpen ? failed(why_not_) : skipped("no link: " + why_not_);
    try {
      return over_link(step);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& e) {
      return failed(e.what());
    }
  }

 private:
  StepAnswer ask(const BringUpStep& step) const {
    return options_.ask ? options_.ask(step) : skipped("nobody was asked");
  }

  bool open(const BringUpStep& step) {
    if (link_ != nullptr) return true;
    if (step.number > kLastToOpen) return false;
    try {
      link_ = options_.open();
      bus_.emplace(*link_);
    } catch (const Cancelled&) {
      throw;
    } catch (const Error& e) {
      why_not_ = e.what();
    }
    return link_ != nullptr;
  }

  StepAnswer over_link(const BringUpStep& step) {
    const bool usb = link::is_usb(link_->name());
    switch (step.number) {
      case 7:
        return usb ? skipped("the link is USB") : find_controllers();
      case 8:
        return usb ? find_controllers() : skipped(options_.board->usb ? "the link is not USB" : "the board has no USB");
      case 9:
        return look_at_lines();
      case 10:
        return look_at_chips();
      case 11:
        return write_and_verify();
      default:
        return watch_samples();
    }
  }

  StepAnswer find_controllers() {
    const auto users = session::users_of_addresses(bus_->discover());
    if (users.empty()) return failed("no controller answers");
    std::string found;
    bool good = true;
    for (const auto& [node, count] : users) {
      found += found.empty() ? "" : "; ";
      if (count > 1) {
        good = good && static_cast<int>(users.size()) + count - 1 <= patches();
        found += fmt::format("{} at address {}", counted(count, "controller"), node);
      } else {
        const wire::Hello h = session::Controller(*bus_, static_cast<std::uint8_t>(node)).hello();
        good = good && h.wire_version == wire::kWireVersion;
        found += fmt::format("controller {}: serial {}, wire version {}, table layout {}", node,
                             session::to_text(h.unique_id), h.wire_version, h.layout_version);
      }
    }
    return good ? passed(found) : failed(found);
  }

  StepAnswer look_at_lines() {
    std::string found;
    for (const std::uint8_t node : nodes()) found += held_lines(node);
    const StepAnswer person = ask(bring_up_steps(*options_.board)[8]);
    const bool good = found.empty() && person.outcome != StepOutcome::kFailed;
    found += good ? "no used line is held low; " : "";
    found += "rise times: " + person.found;
    return good ? passed(found) : failed(found);
  }

  std::string held_lines(std::uint8_t node) {
    std::string held;
    const wire::LineStates states = session::Controller(*bus_, node).line_states();
    for (std::size_t l = 0; l < states.lines.size(); ++l) {
      if (states.lines[l].stuck && uses_line(node, static_cast<int>(l)))
        held += fmt::format("controller {}: line L{} is held low; ", node, l);
    }
    return held;
  }

  StepAnswer look_at_chips() {
    int right = 0, wrong = 0;
    for (const std::uint8_t node : nodes()) {
      const auto lines = session::Controller(*bus_, node).discover();
      for (const wire::LineReport& line : lines) {
        for (int a = 0; a < layout::kAddressesPerLine; ++a) {
          if ((line.answers >> a & 1) == 0) continue;
          ++((line.wrong_id >> a & 1) == 0 ? right : wrong);
        }
      }
    }
    const auto wanted = static_cast<int>(design_.layout.modules.size());
    std::string found = fmt::format("{} {}, {} more with another id; the design has {}", counted(right, "converter"),
                                    agreeing(right, "answers", "answer"), wrong, counted(wanted, "module"));
    return right == wanted && wrong == 0 ? passed(found) : failed(found);
  }

  StepAnswer write_and_verify() {
    const FlashResult written = flash(*bus_, design_, {}, options_.progress);
    const diagnose::VerifyResult r = diagnose::verify(*bus_, design_, {}, options_.progress);
    std::string found = fmt::format("{} written; {} of {} in order", counted(written.bytes, "byte"), r.modules_ok,
                                    counted(r.modules, "module"));
    for (const diagnose::Finding& f : r.findings)
      found += fmt::format("; {}: {} ({})", diagnose::kFindingKindNames.name(f.kind), f.text, f.remedy);
    return r.findings.empty() ? passed(found) : failed(found);
  }

  StepAnswer watch_samples() {
    if (!options_.board->can_fd)
      return skipped("the board sends no full stream, which needs CAN FD; look with triskin live --protocol icub");
    bus_->listen(bus_->now_us() + kOffsets_us);
    std::map<int, Rest> rest;
    {
      session::Stream stream(*bus_, design_, [&](const session::ModuleSample& f) { rest[f.module].add(f); });
      stream.run_until(bus_->now_us() + static_cast<std::uint64_t>(options_.stream_s * 1e6));
      lost_ = stream.lost();
    }
    return judge(rest);
  }

  StepAnswer judge(const std::map<int, Rest>& rest) {
    double worst_noise = 0.0, min_rate = rest.empty() ? 0.0 : 1e9;
    std::string outside;
    for (const auto& [module, r] : rest) {
      min_rate = std::min(min_rate, r.samples() / options_.stream_s);
      for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
        worst_noise = std::max(worst_noise, r.noise(t));
        if (!r.in_middle_third(t))
          outside +=
              fmt::format("; module {} taxel {} rests outside the middle third", design::number_of(design_, module), t);
      }
    }
    std::string found = fmt::format(
        "{} of {} stream, at least {:.1f} samples/s each, {} lost, noise at most {:.2f} counts RMS{}", rest.size(),
        counted(design_.layout.modules.size(), "module"), min_rate, lost_, worst_noise, outside);
    for (const session::PatchOffsets& p : session::read_offsets(*bus_, design_)) {
      for (const std::string& line : diagnose::describe(design_, p)) found += "; " + line;
    }
    const bool good = rest.size() == design_.layout.modules.size() && outside.empty() && worst_noise < kMaxNoise;
    return good ? passed(found) : failed(found);
  }

  // Returns the node addresses that belong to exactly one controller.
  [[nodiscard]] std::vector<std::uint8_t> nodes() {
    std::vector<std::uint8_t> out = session::lone_addresses(bus_->discover());
    if (out.empty()) throw DeviceError("no controller with an address of its own; step 11 gives them out");
    return out;
  }
  [[nodiscard]] int patches() const { return static_cast<int>(design::patches_of(design_).size()); }
  [[nodiscard]] bool uses_line(std::uint8_t node, int line) const {
    const layout::PatchIndex patch = design::patch_at(design_, layout::NodeAddress{node});
    if (patch < 0) return true;
    const auto& modules = design_.patches[static_cast<std::size_t>(patch)].modules;
    return std::ranges::any_of(modules, [&](const design::RoutedModule& m) { return m.line == line; });
  }

  const design::Design& design_;
  const BringUpOptions& options_;
  std::unique_ptr<link::Link> link_;
  std::optional<session::Bus> bus_;
  std::string why_not_;
  std::uint64_t lost_ = 0;
};

}  // namespace

std::vector<StepReport> bring_up(const design::Design& design, const BringUpOptions& options) {
  Session session(design, options);
  const std::array<BringUpStep, 12> steps = bring_up_steps(*options.board);
  std::vector<StepReport> reports;
  for (const BringUpStep& step : steps) {
    report(options.progress, "bring-up", static_cast<double>(reports.size()) / static_cast<double>(steps.size()),
           step.does);
    StepAnswer answer = session.run(step);
    reports.push_back({step.number, answer.outcome, std::move(answer.found)});
  }
  return reports;
}

}  // namespace triskin::deploy
