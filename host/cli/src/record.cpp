// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <optional>

#include "triskin/cli/link_options.hpp"
#include "triskin/cli/stream_options.hpp"
#include "triskin/host/files.hpp"
#include "triskin/host/interrupt.hpp"
#include "triskin/jobs/touch_map.hpp"
#include "triskin/recording/recorder.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::cli {
namespace {

using recording::Format;

struct Options {
  std::string design;
  std::string output;
  std::string to;
  device::LinkOptions link;
  device::StreamOptions stream;
  double seconds = 10.0;
  double cloud_hz = 0.0;
};

constexpr std::uint64_t kSlice_us = 100'000;

// What --to says, else the extension; one that says something else is refused.
Format format_of(const Options& options) {
  const std::string extension = std::filesystem::path(options.output).extension().string();
  const auto by_extension = recording::kFormatNames.value(extension.empty() ? "" : extension.substr(1));
  if (options.to.empty()) {
    if (by_extension) return *by_extension;
    if (options.output == "-") return Format::kMcap;
    throw InputError(fmt::format("{}: say the format by the extension .mcap or .csv, or with --to", options.output));
  }
  const Format format = recording::kFormatNames.value(options.to).value();
  if (by_extension && *by_extension != format) {
    throw InputError(
        fmt::format("{}: the extension says {}, --to says {}; choose one", options.output, extension, options.to));
  }
  return format;
}

std::uint64_t steady_us() {
  using namespace std::chrono;
  return static_cast<std::uint64_t>(duration_cast<microseconds>(steady_clock::now().time_since_epoch()).count());
}

std::uint64_t unix_ns() {
  using namespace std::chrono;
  return static_cast<std::uint64_t>(duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count());
}

std::string firmware_of(device::Bus& bus, std::uint8_t node) {
  const std::uint32_t v = device::Controller(bus, node).hello().firmware_version;
  return fmt::format("{}.{}.{}", v >> 24 & 0xFF, v >> 16 & 0xFF, v >> 8 & 0xFF);
}

recording::Origin origin_of(device::Bus& bus, const design::Design& design, const Options& options) {
  recording::Origin origin;
  origin.design_text = read_file(options.design);
  origin.facts["link"] = bus.name();
  origin.facts["program"] = fmt::format("triskin {}", TRISKIN_VERSION);
  for (std::size_t p = 0; p < design.patches.size(); ++p) {
    const auto node = static_cast<std::uint8_t>(p + 1);
    origin.facts[fmt::format("firmware_{}", node)] = firmware_of(bus, node);
  }
  if (options.cloud_hz > 0.0) origin.cloud_period_us = static_cast<std::uint64_t>(1e6 / options.cloud_hz);
  origin.link_start_us = bus.now_us();
  origin.unix_start_ns = unix_ns();
  return origin;
}

// One recording: the file, what is written into it, and how it ended.
class Session {
 public:
  Session(const Options& options, const design::Design& design, Format format)
      : options_(options), design_(design), format_(format), file_(options.output), touches_(design) {}

  int run(Output& output) {
    const auto link = device::open_link(options_.link, &design_);
    device::Bus bus(*link);
    origin_ = origin_of(bus, design_, options_);
    start_us_ = bus.now_us();
    std::optional<std::string> trouble;
    int status = 0;
    try {
      receive(bus, output);
    } catch (const DeviceError& e) {
      if (!recorder_) throw;  // the recording had not begun
      trouble = e.what();
      status = e.exit_status();
    }
    seconds_ = static_cast<double>(bus.now_us() - start_us_) * 1e-6;
    end(trouble);
    return report(output, trouble, status);
  }

 private:
  void receive(device::Bus& bus, Output& output) {
    device::Stream stream(bus, design_, [&](const device::ModuleFrame& f) { add(f); }, speaking(options_.stream));
    begin();
    const ProgressSink progress = output.progress();
    const std::uint64_t end_us = start_us_ + static_cast<std::uint64_t>(options_.seconds * 1e6);
    try {
      while (bus.now_us() < end_us && !interrupt_request()) {
        stream.run_until(std::min(end_us, bus.now_us() + kSlice_us));
        slice(bus.now_us());
        triskin::report(progress, "recording",
                        static_cast<double>(bus.now_us() - start_us_) / static_cast<double>(end_us - start_us_));
        lost_ = stream.lost();
      }
    } catch (const Cancelled&) {
      // A person ends it: what came until now is kept.
    }
    stream.finish();
    account_ = stream.report();
    lost_ = account_->total.lost();
  }

  void begin() {
    if (!recorder_) recorder_ = recording::make_recorder(format_, file_, design_, origin_);
  }

  void add(const device::ModuleFrame& f) {
    begin();
    recorder_->add({f.module, f.link_time_us, f.sample, unix_ns_of(f.sampled.link_us), f.sampled.error_us});
    touches_.add(f);
    ++samples_;
  }

  [[nodiscard]] std::uint64_t unix_ns_of(std::uint64_t link_us) const {
    return origin_.unix_start_ns + (link_us - origin_.link_start_us) * 1000;  // also of times before the start
  }

  void slice(std::uint64_t now_us) {
    std::vector<recording::Contact> contacts;
    for (const auto& t : touches_.pressed())
      contacts.push_back({t.module, t.taxel, t.change_counts, t.position_mm, t.normal});
    if (!contacts.empty() || had_contacts_) recorder_->add_contacts(now_us, contacts);
    had_contacts_ = !contacts.empty();
    recorder_->tick(steady_us());
  }

  void end(const std::optional<std::string>& trouble) {
    const int signal = interrupt_signal();
    recorder_->finish({{"status", trouble      ? *trouble
                                  : signal > 0 ? fmt::format("ended by signal {}", signal)
                                               : "complete"},
                       {"samples", fmt::format("{}", samples_)},
                       {"lost", fmt::format("{}", lost_)},
                       {"seconds", fmt::format("{:.6f}", seconds_)}});
    file_.close();
  }

  int report(Output& output, const std::optional<std::string>& trouble, int status) const {
    output.result = {{"samples", samples_}, {"lost", lost_}};
    if (account_) status = std::max(status, conclude(*account_, output));
    output.result["seconds"] = seconds_;
    output.result["file"] = file_.name();
    output.say(fmt::format("{} module samples in {:.2f} s -> {}", samples_, seconds_, file_.name()));
    if (trouble) {
      output.result["ended_by"] = *trouble;
      throw DeviceError(
          fmt::format("{}; the recording ends here, with {} samples in {}", *trouble, samples_, file_.name()));
    }
    if (interrupt_signal() > 0) output.say("ended before its time; what came until then is in the file");
    if (samples_ == 0) output.say("nothing was recorded: no module sent a sample; run triskin verify");
    return samples_ == 0 ? 1 : status;
  }

  const Options& options_;
  const design::Design& design_;
  Format format_;
  recording::OutputFile file_;
  device::TouchMap touches_;
  recording::Origin origin_;
  std::unique_ptr<recording::Recorder> recorder_;
  std::uint64_t start_us_ = 0, samples_ = 0, lost_ = 0;
  std::optional<device::StreamReport> account_;
  double seconds_ = 0.0;
  bool had_contacts_ = false;
};

int run(const Options& options, Output& output) {
  const Format format = format_of(options);
  const design::Design design = design::read_intact_design(options.design);
  if (design.layout.modules.empty())
    throw InputError(fmt::format("{}: the design has no modules: there is nothing to record", options.design));
  return Session(options, design, format).run(output);
}

const Registration kRecord{{
    "record",
    "write every sample with its time and validity to a file, as it comes",
    "triskin record forearm.json --link sim -o touch.mcap --seconds 5",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design, "design file")->required();
      app.add_option("-o,--output", options->output, "file.mcap (docs/recording.md) or file.csv")->required();
      app.add_option("--to", options->to, "format; default: by the extension of -o")
          ->check(CLI::IsMember({"mcap", "csv"}));
      add_link_options(app, options->link);
      add_stream_options(app, options->stream);
      app.add_option("--seconds", options->seconds, "of the link's time")
          ->check(CLI::Range(0.0, 1e6))
          ->capture_default_str();
      app.add_option("--cloud-hz", options->cloud_hz, "mcap: also sensor_msgs/PointCloud2, so often")
          ->check(CLI::Range(0.0, 100.0))
          ->capture_default_str();
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
