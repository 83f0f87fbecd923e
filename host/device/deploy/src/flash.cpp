// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/deploy/flash.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <thread>

#include "cover_flash.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/patch_table.hpp"
#include "triskin/session/scheduler.hpp"

namespace triskin::deploy {
namespace {

using Failure = CoverFlash::Failure;

template <class Kind>
bool is_a(const Failure& f) {
  try {
    std::rethrow_exception(f.what);
  } catch (const Kind&) {
    return true;
  } catch (...) {
    return false;
  }
}

std::string sentence(const Failure& f) {
  return f.who + ": " + f.text();
}

// A request to end has priority, then a cable that may be plugged in again; the message names each patch without its
// table.
[[noreturn]] void throw_all(const std::vector<Failure>& failures, const std::string& done) {
  if (const auto ended = std::ranges::find_if(failures, is_a<Cancelled>); ended != failures.end())
    throw Cancelled(sentence(*ended) + "; " + done);
  std::string text = sentence(failures.front()) + "; " + done;
  for (std::size_t k = 1; k < failures.size(); ++k) text += "\n  " + sentence(failures[k]);
  if (std::ranges::any_of(failures, is_a<link::Unreachable>)) throw link::Unreachable(text);
  throw DeviceError(text);
}

std::vector<std::vector<std::uint8_t>> images_of(const design::Design& design, const session::RouteChoice& route,
                                                 bool positive_input) {
  if (route.module >= 0 &&
      std::ranges::none_of(design.patches, [&](const auto& p) { return session::concerns(p, route); })) {
    throw InputError(
        route.other < 0 ? fmt::format("the design has no module {} in a patch", design::number_of(design, route.module))
                        : fmt::format("modules {} and {} are not in one patch of the design",
                                      design::number_of(design, route.module), design::number_of(design, route.other)));
  }
  std::vector<std::vector<std::uint8_t>> images(design.patches.size());
  for (const layout::PatchIndex patch : design::patches_here(design)) {
    layout::PatchImage image = session::image_of(design, patch, route);
    image.positive_input = positive_input;
    images[static_cast<std::size_t>(patch)] = session::bytes_of(image);
  }
  return images;
}

// A session flashes all covers of a bus, until their tables are written or waiting for controllers has timed out.
class FlashSession {
 public:
  FlashSession(std::span<const FlashPart> parts, std::vector<FlashResult>& results) : parts_(parts), results_(results) {
    results_.assign(parts.size(), {});
    for (const FlashPart& p : parts_)
      images_.push_back(images_of(*p.design, p.options.route, p.options.positive_input));
  }

  void run() {
    const FlashOptions& options = parts_.front().options;
    for (bool completed = false; !completed;) {
      try {
        pass();
        completed = true;
      } catch (const link::Unreachable& e) {
        if (options.wait_s <= 0.0) throw;
        if (options.say)
          options.say(fmt::format("{}; waiting {:.0f} s for the cable (Ctrl-C ends)", e.what(), options.wait_s));
        if (!wait_for_controllers(options.wait_s)) throw;
        if (options.say) options.say("all controllers answer again, going on");
      }
    }
  }

 private:
  // First the boards are assigned to patches, then all tables are written together.
  void pass() {
    std::deque<CoverFlash> covers;
    std::vector<FlashOptions::Neighbour> settled;
    BusBoards known;
    std::vector<Failure> failures;
    for (std::size_t k = 0; k < parts_.size() && failures.empty(); ++k) {
      CoverFlash cover(parts_[k], images_[k], results_[k].patches);
      try {
        cover.plan(settled, known);
      } catch (const link::Unreachable&) {
        throw;
      } catch (const DeviceError&) {
        if (covers.empty()) throw;
        // Patches that were planned earlier still get their tables.
        failures.push_back({name_of(k), std::current_exception()});
        continue;
      }
      found_ = cover.found();
      for (auto& n : cover.settled()) settled.push_back(std::move(n));
      covers.push_back(std::move(cover));
    }
    CoverFlash::give_addresses(covers, known);
    write(covers, failures);
  }
  void write(std::deque<CoverFlash>& covers, std::vector<Failure>& failures) {
    std::vector<session::Task> tasks;
    for (CoverFlash& c : covers) c.add_tasks(tasks);
    const std::vector<std::exception_ptr> outcomes =
        session::run_tasks(parts_.front().bus->link(), tasks, parts_.front().options.per_wire);
    std::size_t at = 0;
    std::string done;
    for (std::size_t k = 0; k < covers.size(); ++k) {
      for (Failure& f : covers[k].failures(std::span(outcomes).subspan(at, covers[k].tasks())))
        failures.push_back({parts_.size() > 1 ? name_of(k) + ", " + f.who : f.who, f.what});
      at += covers[k].tasks();
      done += (k == 0 ? "" : "; ") + (parts_.size() > 1 ? name_of(k) + ": " : "") + covers[k].what_is_done();
    }
    if (!failures.empty()) throw_all(failures, done);
  }
  [[nodiscard]] std::string name_of(std::size_t part) const { return parts_[part].design->name; }

  // Waits until as many controllers answer as before.
  bool wait_for_controllers(double wait_s) {
    constexpr std::uint64_t kPause_us = 300'000;
    session::Bus& bus = *parts_.front().bus;
    const auto start = std::chrono::steady_clock::now();
    const std::uint64_t start_us = bus.now_us();
    // A dead link may have no clock, so the computer's clock counts.
    const auto over = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > wait_s ||
             static_cast<double>(bus.now_us() - start_us) > wait_s * 1e6;
    };
    while (!over()) {
      try {
        for (const FlashPart& p : parts_) p.bus->reconnect();
        if (bus.discover().size() >= expected()) return true;
        bus.listen(bus.now_us() + kPause_us);
      } catch (const DeviceError&) {
        if (interrupt_request()) throw Cancelled(bus.name() + ": ended on request while waiting for the cable");
        std::this_thread::sleep_for(std::chrono::microseconds(kPause_us));
      }
    }
    return false;
  }
  // Returns the number of controllers to wait for, which is the number of patches until one has answered.
  [[nodiscard]] std::size_t expected() const {
    if (found_ > 0) return found_;
    std::size_t n = 0;
    for (const FlashPart& p : parts_) n += p.options.patch >= 0 ? 1 : design::patches_here(*p.design).size();
    return n;
  }

  std::span<const FlashPart> parts_;
  std::vector<FlashResult>& results_;
  std::vector<std::vector<std::vector<std::uint8_t>>> images_;  // The first index is the part, the second the patch.
  std::size_t found_ = 0;
};

void sum_up(FlashResult& result, double link_s) {
  result.bytes = 0;
  result.skipped = 0;
  for (const FlashResult::Patch& p : result.patches) {
    if (p.written) result.bytes += p.bytes;
    if (p.equal && !p.written) ++result.skipped;
  }
  result.link_s = link_s;
}

}  // namespace

void flash_together(std::span<const FlashPart> parts, std::vector<FlashResult>& results) {
  if (parts.empty()) return results.clear();
  const session::Bus& bus = *parts.front().bus;
  const std::uint64_t start_us = bus.now_us();
  const auto sum_up_all = [&] {
    for (FlashResult& r : results) sum_up(r, static_cast<double>(bus.now_us() - start_us) * 1e-6);
  };
  try {
    FlashSession(parts, results).run();
  } catch (...) {
    sum_up_all();
    throw;
  }
  sum_up_all();
}

FlashResult flash(session::Bus& bus, const design::Design& design, const FlashOptions& options,
                  const ProgressSink& progress) {
  std::vector<FlashResult> results;
  flash_together(std::array{FlashPart{&bus, &design, options, progress}}, results);
  return std::move(results.front());
}

}  // namespace triskin::deploy
