// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cstdlib>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "calibration_options.hpp"
#include "design_argument.hpp"
#include "link_options.hpp"
#include "recorded_track.hpp"
#include "shown_design.hpp"
#include "stream_options.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/skin/live_skin.hpp"
#include "triskin/view/browser.hpp"
#include "triskin/view/comparison.hpp"
#include "triskin/view/frame_track.hpp"
#include "view_feed.hpp"

namespace triskin::cli::view_command {
namespace {

struct Options {
  std::string design;
  connect::LinkOptions link;
  session::StreamOptions stream;
  CalibrationOptions calibration;
  std::string findings, compare;
  std::uint16_t port = 0;
  bool no_open = false;
};

// A missing browser is no error.
std::optional<view::BrowserStart> open_browser(const Options& options, const std::string& address) {
  if (options.no_open || (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr)) return {};
  return std::optional<view::BrowserStart>(std::in_place, address);
}

void wait_for_interrupt() {
  while (!interrupt_request()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

// Merges a design with an earlier one, so that the page can show them side by side.
ShownDesign compared(const Options& options, const std::string& file) {
  if (robot::is_robot_file(file))
    throw InputError(fmt::format("{}: --compare takes two designs, and this is a robot file", file));
  if (options.link.chosen && options.link.link != "none")
    throw InputError("--compare shows two designs without live samples; leave out --link");
  view::Comparison comparison = view::compare(design::read_design(options.compare), design::read_design(file));
  return {std::move(comparison.design), {{}}, std::move(comparison.notes)};
}

// Returns whether the page gets live samples. Throws InputError if no link is named.
bool reads_skin(const Options& options, const std::string& file) {
  if (!options.compare.empty() || options.link.link == "none") return false;
  if (robot::is_robot_file(file)) return true;
  if (options.link.link.empty()) (void)design::read_design(file);  // What is wrong with the file is said first.
  try {
    connect::require_link(options.link);
  } catch (const InputError& e) {
    throw InputError(std::string(e.what()) + "; --link none shows the design alone");
  }
  return true;
}

// Standard output is for the address alone.
void say_simulated_links(const connect::LinkOptions& link, const robot::Site& site, Output& output) {
  for (const robot::BusConfig& bus : site.buses) {
    const std::string& name = site.is_robot && !link.chosen ? bus.link : link.link;
    if (!link::is_simulated(name) || output.simulated()) continue;
    Output(output.json(), true).mark_simulated();
    output.mark_quietly_simulated();
  }
}

// Returns the place where the page starts: the entry of the controller that a code names.
std::string place_of(const DesignArgument& argument, const design::Design& design) {
  if (!argument.code || argument.code->patch < 0) return {};
  const auto patch = static_cast<std::size_t>(argument.code->patch);
  if (!design::has_patch(design, argument.code->patch))
    throw InputError(fmt::format("{}: there is no controller {}; this code is of another sheet", argument.path, patch));
  return fmt::format("#module-{}", design::number_of(design, design.patches[patch].entry));
}

// The page shows kPa and N if all controllers answer and have a calibration. Standard output is reserved for the
// address.
struct Calibrations {
  std::vector<std::vector<design::SkinCalibration>> of_buses;  // as ShownSkin has them
  std::vector<double> counts_per_kpa;                          // as view::Notes has them
};
Calibrations calibrations_now(const Options& options, std::optional<skin::LiveSkin>& skin, const ShownDesign& shown,
                              const Output& output) {
  if (!skin) return {};
  const Output aside(output.json(), true);
  Calibrations found;
  found.counts_per_kpa.resize(layout::kTaxelsPerModule * shown.design.layout.modules.size());
  bool is_complete = true;
  for (const auto& bus : skin->buses()) {
    std::vector<design::SkinCalibration> here;
    try {
      bus->open();
      bus->find_controllers(skin::RestSource::kNone);
      for (skin::LiveCover& cover : bus->covers()) {
        calibrate_cover(options.calibration, *bus, cover, aside);
        here.push_back(cover.calibration());
        const std::vector<double> counts = view::counts_per_kpa_of(here.back());
        is_complete = is_complete && !counts.empty();
        // A part of the cover may hang on another bus, whose calibration has the other modules.
        const auto first =
            static_cast<std::size_t>(shown.offsets[static_cast<std::size_t>(cover.config().cover)].module);
        for (std::size_t k = 0; k < counts.size(); ++k)
          if (counts[k] > 0.0) found.counts_per_kpa.at(layout::kTaxelsPerModule * first + k) = counts[k];
      }
    } catch (const DeviceError&) {
      is_complete = false;  // The page reports problems of the link.
    }
    bus->close();
    found.of_buses.push_back(std::move(here));
  }
  return is_complete ? found : Calibrations{};
}

// The page itself plays a recording, so the server has no live skin.
int play(const Options& options, Output& output) {
  RecordedTrack track = read_track(options.design, view::FrameTrack::kMax_bytes);
  if (!track.remark.empty()) output.say(track.remark);
  const std::size_t bytes = track.frames.size();
  const view::LatestSamples live(track.skin.design.layout.modules.size());
  catch_interrupts();
  view::Notes notes;
  notes.counts_per_kpa = view::counts_per_kpa_of(track.skin.calibration);
  const view::Server server(view::site_of(track.skin.design, std::move(track.frames), notes), live, options.port,
                            [](const view::Command&) {}, {});
  output.say(server.address());
  const auto browser = open_browser(options, server.address());
  wait_for_interrupt();
  output.result = {{"port", server.port()}, {"bytes", bytes}};
  return 0;
}

int run(const Options& options, Output& output) {
  output.expect_interrupt();
  if (is_recording(options.design)) return play(options, output);
  const DesignArgument argument = find_design(options.design);
  const bool has_link = reads_skin(options, argument.path);
  ShownDesign shown =
      options.compare.empty() ? read_shown_design(argument.path, has_link) : compared(options, argument.path);
  shown.notes.has_live_skin = has_link;
  if (!options.findings.empty())
    shown.notes.findings = view::findings_in(read_text(options.findings), options.findings, shown.design, shown.notes);
  std::optional<skin::LiveSkin> skin;
  if (has_link) skin.emplace(robot::read_site(argument.path), options.link);
  if (skin) say_simulated_links(options.link, skin->site(), output);
  view::LatestSamples live(shown.design.layout.modules.size());
  live.set_health({has_link ? options.link.link : "none", false, "", 0, 0});
  CommandQueue commands(skin ? skin->buses().size() : 1);
  catch_interrupts();
  Calibrations calibrations = calibrations_now(options, skin, shown, output);
  shown.notes.counts_per_kpa = std::move(calibrations.counts_per_kpa);
  shown.notes.has_switched_modules = options.link.switched;
  const view::Server server(view::site_of(shown.design, {}, shown.notes), live, options.port,
                            [&](const view::Command& c) { commands.push(c); }, {});
  const std::string address = server.address() + place_of(argument, shown.design);
  output.say(address);
  const auto browser = open_browser(options, address);
  skin::LiveTotals totals;
  if (skin) {
    // A scene begins when somebody can see it.
    if (!options.link.scene.empty()) {
      live.set_health({options.link.link, false, "the scene begins with the first page", 0, 0});
      while (!server.had_page() && !interrupt_request()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    const bool by_file = skin->site().is_robot && !options.link.chosen;
    totals = feed(*skin, by_file ? skin->site().name : options.link.link, options.stream,
                  {shown.design, shown.offsets, std::move(calibrations.of_buses)}, live, commands);
  } else {
    wait_for_interrupt();
  }
  output.result = {{"port", server.port()}, {"frames", totals.frames}, {"lost", totals.lost}};
  return 0;
}

const Registration kView{{
    "view",
    "a page in the browser: the cover in 3-D and flat, its wiring, and the live skin",
    "triskin view forearm.json --link sim",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("DESIGN", options->design,
                     "design file, robot file: all of its covers, the text of a QR code of an assembly sheet, or a "
                     "recording (.mcap)")
          ->required();
      add_link_options(app, options->link);
      app.get_option("--link")->description(app.get_option("--link")->get_description() +
                                            "; none: the design without live samples");
      add_decimation_option(app, options->stream);
      add_calibration_options(app, options->calibration);
      app.add_option("--findings", options->findings, "show the findings of this report (verify --report FILE.json)");
      app.add_option("--compare", options->compare, "show the changes since this earlier design, side by side");
      app.add_option("--port", options->port, "port of the page on 127.0.0.1 (0: a free one)")
          ->check(CLI::Range(0, 65'535))
          ->capture_default_str();
      app.add_flag("--no-open", options->no_open, "do not start a browser");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kData,
}};

}  // namespace
}  // namespace triskin::cli::view_command
