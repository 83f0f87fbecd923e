// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "site_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/pace.hpp"
#include "triskin/base/short_list.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/frame_text.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::cli::dump_command {
namespace {

constexpr std::uint64_t kLook_us = 100'000;

struct Options {
  SiteOptions site;
  double seconds = 0.0;
  std::uint64_t frames = 0;
  bool ask = false;
};

class Dump {
 public:
  Dump(link::Link& link, std::string name, const Options& options, const Output& output)
      : link_(link), name_(std::move(name)), options_(options), output_(output) {}

  void run() {
    start_us_ = link_.now_us();
    if (options_.ask) ask();
    // A simulation in this process jumps ahead whenever the command waits, so the output needs a pace.
    std::optional<Pace> pace;
    if (options_.seconds == 0.0) pace.emplace(start_us_);
    while (!done()) {
      if (pace) pace->hold(link_.now_us());
      if (const auto frame = link_.receive(link_.now_us() + kLook_us)) print(*frame);
    }
    output_.say(name_ + ": " + counted(count_, "frame"));
    if (count_ == 0)
      output_.say(name_ +
                  ": no frame came; --ask asks every controller for an answer. A skin that is not flashed yet sends "
                  "nothing by itself");
    if (!fresh_.empty())
      output_.say(fmt::format("{}: {} {} no table, so nothing of the skin comes; run triskin flash first", name_,
                              short_list(std::vector(fresh_.begin(), fresh_.end()), 5),
                              agreeing(fresh_.size(), "has", "have")));
    if (link_.thrown_away() > 0)
      output_.say(fmt::format("{}: {} came faster than they were read", name_, counted(link_.thrown_away(), "frame")));
    if (const std::string trouble = link_.trouble(); !trouble.empty()) output_.say(trouble);
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Something of a skin came, or of other programs.
  [[nodiscard]] bool is_good() const { return count_ > 0 && fresh_.empty(); }

 private:
  [[nodiscard]] double seconds() const { return 1e-6 * static_cast<double>(link_.now_us() - start_us_); }
  [[nodiscard]] bool done() const {
    return interrupt_request() || (options_.seconds > 0.0 && seconds() >= options_.seconds) ||
           (options_.frames > 0 && count_ >= options_.frames);
  }
  void ask() {
    const wire::CanFrame question = wire::who_is_there();
    link_.send(question);
    print(question);
  }
  // Who says that it has no table.
  void note_claim(const wire::CanFrame& frame) {
    if (!wire::is_claim(frame)) return;
    const auto joined = claims_[frame.id].add(frame);
    const auto claim =
        joined ? wire::decode_claim(*joined) : Result<wire::NodeClaim>(std::unexpected(Status::kTooShort));
    if (claim && !claim->has_table) fresh_.insert(fmt::format("controller {}", session::to_text(claim->unique_id)));
  }
  void print(const wire::CanFrame& frame) {
    ++count_;
    note_claim(frame);
    const std::string bytes = session::bytes_text(frame), meaning = reader_.text(frame);
    if (!output_.json()) output_.say(fmt::format("({:.6f})  {}  {:<36}  {}", seconds(), name_, bytes, meaning));
    nlohmann::json row = {{"time_s", seconds()}, {"frame", bytes}, {"meaning", meaning}};
    if (name_ != link_.name()) row["bus"] = name_;
    output_.each(row);
  }

  link::Link& link_;
  std::string name_;  // of the bus of a robot, else of the link
  const Options& options_;
  const Output& output_;
  session::FrameReader reader_;
  std::map<std::uint32_t, wire::IdFrames> claims_;
  std::set<std::string> fresh_;
  std::uint64_t start_us_ = 0, count_ = 0;
};

int run(const Options& options, Output& output) {
  output.expect_interrupt();
  std::atomic<std::uint64_t> frames = 0, thrown_away = 0;
  std::atomic<bool> is_good = true;
  on_each_bus(options.site, output, [&](const OpenBus& at) {
    at.link.receive_from_all();
    Dump dump(at.link, at.config == nullptr || at.config->name.empty() ? at.link.name() : at.config->name, options,
              output);
    dump.run();
    frames += dump.count();
    if (!dump.is_good()) is_good = false;
    thrown_away += at.link.thrown_away();
  });
  output.result = {{"frames", frames.load()}, {"thrown_away", thrown_away.load()}};
  return is_good ? 0 : 1;
}

const Registration kDump{{
    "dump",
    "print every frame of a bus as candump does, and what it means",
    "triskin dump --link can:can0 --seconds 10",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->site.file, "design file, or robot file: all of its buses; or only --link");
      add_link_options(app, options->site.link);
      app.add_option("--seconds", options->seconds, "ends after this time; 0: with Ctrl-C")
          ->check(CLI::Range(0.0, 1e6))
          ->capture_default_str();
      app.add_option("--frames", options->frames, "ends after so many frames; 0: with Ctrl-C")->capture_default_str();
      app.add_flag("--ask", options->ask, "first ask who is there: every controller answers");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::dump_command
