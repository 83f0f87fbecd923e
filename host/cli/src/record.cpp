// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "triskin/cli/link_options.hpp"
#include "triskin/cli/stream_options.hpp"
#include "triskin/host/files.hpp"
#include "triskin/host/interrupt.hpp"

namespace triskin::cli {
namespace {

struct Options {
  std::string design;
  std::string output;
  device::LinkOptions link;
  device::StreamOptions stream;
  double seconds = 10.0;
};

constexpr std::uint64_t kSlice_us = 100'000;

void add_row(std::string& csv, const device::ModuleFrame& f) {
  csv +=
      fmt::format("{},{},{},{},{}", f.link_time_us, f.sample.device_time_us, f.sample.sample, f.module, f.sample.valid);
  for (const std::uint16_t v : f.sample.value) csv += fmt::format(",{}", v);
  csv += '\n';
}

int run(const Options& options, Output& output) {
  const design::Design design = design::read_intact_design(options.design);
  if (!options.output.ends_with(".csv"))
    throw InputError(fmt::format("{}: give a file that ends in .csv", options.output));
  const auto link = device::open_link(options.link, &design);
  device::Bus bus(*link);
  std::string csv = "link_time_us,device_time_us,sample,module,valid";
  for (int t = 0; t < layout::kTaxelsPerModule; ++t) csv += fmt::format(",taxel_{}", t);
  csv += '\n';
  int status = 0;
  double seconds = 0.0;
  {
    device::Stream stream(
        bus, design, [&](const device::ModuleFrame& f) { add_row(csv, f); }, speaking(options.stream));
    const std::uint64_t start_us = bus.now_us();
    const ProgressSink progress = output.progress();
    const std::uint64_t end_us = start_us + static_cast<std::uint64_t>(options.seconds * 1e6);
    while (bus.now_us() < end_us && !interrupt_request()) {
      try {
        stream.run_until(std::min(end_us, bus.now_us() + kSlice_us));
      } catch (const Cancelled&) {
        break;  // Ctrl-C: what came until now is written
      }
      report(progress, "recording",
             static_cast<double>(bus.now_us() - start_us) / static_cast<double>(end_us - start_us));
    }
    seconds = static_cast<double>(bus.now_us() - start_us) * 1e-6;
    status = conclude(stream, output);
  }
  write_output(options.output, csv);
  output.result["seconds"] = seconds;
  output.say(fmt::format("{:.2f} s -> {}", seconds, options.output));
  return status;
}

const Registration kRecord{{
    "record",
    "write every sample with its time and validity to a file",
    "triskin record forearm.json --link sim -o touch.csv --seconds 5",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design, "design file")->required();
      app.add_option("-o,--output", options->output, "CSV file")->required();
      add_link_options(app, options->link);
      add_stream_options(app, options->stream);
      app.add_option("--seconds", options->seconds, "of the link's time")
          ->check(CLI::Range(0.0, 1e6))
          ->capture_default_str();
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
