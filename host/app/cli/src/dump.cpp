// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "link_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/pace.hpp"
#include "triskin/design/design.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/session/frame_text.hpp"
#include "triskin/wire/node_claim.hpp"

namespace triskin::cli::dump_command {
namespace {

constexpr std::uint64_t kLook_us = 100'000;

struct Options {
  std::string design;
  connect::LinkOptions link;
  double seconds = 0.0;
  std::uint64_t frames = 0;
  bool ask = false;
};

class Dump {
 public:
  Dump(link::Link& link, const Options& options, Output& output) : link_(link), options_(options), output_(output) {}

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
    output_.result = {{"frames", count_}, {"thrown_away", link_.thrown_away()}};
    output_.say(counted(count_, "frame"));
    if (link_.thrown_away() > 0)
      output_.say(fmt::format("{} came faster than they were read", counted(link_.thrown_away(), "frame")));
    if (const std::string trouble = link_.trouble(); !trouble.empty()) output_.say(trouble);
  }

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
  void print(const wire::CanFrame& frame) {
    ++count_;
    const std::string bytes = session::bytes_text(frame), meaning = reader_.text(frame);
    if (!output_.json()) output_.say(fmt::format("({:.6f})  {}  {:<36}  {}", seconds(), link_.name(), bytes, meaning));
    output_.each({{"time_s", seconds()}, {"frame", bytes}, {"meaning", meaning}});
  }

  link::Link& link_;
  const Options& options_;
  Output& output_;
  session::FrameReader reader_;
  std::uint64_t start_us_ = 0, count_ = 0;
};

int run(const Options& options, Output& output) {
  output.expect_interrupt();
  std::optional<design::Design> design;
  if (!options.design.empty()) design = design::read_intact_design(options.design);
  const auto link = connect::open_link(options.link, design ? &*design : nullptr);
  say_simulated(*link, output);
  link->receive_from_all();
  Dump(*link, options, output).run();
  return 0;
}

const Registration kDump{{
    "dump",
    "print every frame of a bus as candump does, and what it means",
    "triskin dump --link can:can0 --seconds 10",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design, "design file: what the link sim simulates");
      add_link_options(app, options->link);
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
