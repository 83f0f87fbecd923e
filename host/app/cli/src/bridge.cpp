// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/bridge/bridge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bridge_services.hpp"
#include "calibration_options.hpp"
#include "contacts.hpp"
#include "ros_arguments.hpp"
#include "site_options.hpp"
#include "stream_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/pace.hpp"
#include "triskin/bridge/parameters.hpp"
#include "triskin/bridge/ros_discovery.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/robot/robot.hpp"

namespace triskin::cli::bridge_command {
namespace {

struct Options {
  SiteOptions site;
  session::StreamOptions stream;
  CalibrationOptions calibration;
  bridge::BridgeOptions bridge;
  std::vector<double> pose;  // The numbers are the position x, y, z in m, then a quaternion x, y, z, w.
  double contacts_hz = 10.0;
  double seconds = 0.0;
  double stop_counts = 0.0, stop_kpa = 0.0;  // 0: no topic that says stop
  bool services = true;
  bool use_sim_time = false;
  bool ros_args = false;
  std::optional<std::uint32_t> domain;
};

// Takes -p NAME:=VALUE of the ROS arguments as the option of that name.
void take_parameters(const std::map<std::string, bridge::ParameterValue>& parameters, Options& options) {
  for (const auto& [name, value] : parameters) {
    const auto refuse = [&, &key = name](const char* wanted) {
      throw InputError(fmt::format("--ros-args -p {}: its value must be {}", key, wanted));
    };
    const auto as_bool = [&] {
      if (!std::holds_alternative<bool>(value)) refuse("true or false");
      return std::get<bool>(value);
    };
    const auto as_rate = [&] {
      const auto* whole = std::get_if<std::int64_t>(&value);
      if (whole == nullptr && !std::holds_alternative<double>(value)) refuse("a number");
      const double hz = whole != nullptr ? static_cast<double>(*whole) : std::get<double>(value);
      if (!(hz >= 0.0 && hz <= 100.0)) refuse("0 to 100");
      return hz;
    };
    const auto as_text = [&] {
      if (!std::holds_alternative<std::string>(value)) refuse("text");
      return std::get<std::string>(value);
    };
    if (name == "use_sim_time") {
      options.use_sim_time = as_bool();
    } else if (name == "raw") {
      options.bridge.raw = as_bool();
    } else if (name == "markers") {
      options.bridge.markers = as_bool();
    } else if (name == "points_hz") {
      options.bridge.points_hz = as_rate();
    } else if (name == "contacts_hz") {
      options.contacts_hz = as_rate();
      if (options.contacts_hz < 0.5) refuse("0.5 to 100");
    } else if (name == "frame_prefix") {
      options.bridge.frame_prefix = as_text();
    } else if (name == "parent") {
      options.bridge.parent_frame = as_text();
    } else {
      throw InputError(
          fmt::format("--ros-args -p {}: there is no such parameter; there are use_sim_time, raw, markers, points_hz, "
                      "contacts_hz, frame_prefix and parent",
                      name));
    }
  }
}

std::vector<bridge::Parameter> parameters_of(const Options& options) {
  return {{"use_sim_time", options.use_sim_time, "times are those of /clock"},
          {"raw", options.bridge.raw, "every sample is published"},
          {"markers", options.bridge.markers, "triangles and arrows for viewers are published"},
          {"points_hz", options.bridge.points_hz, "point clouds a second"},
          {"contacts_hz", options.contacts_hz, "lists of contacts, wrenches and markers a second"},
          {"frame_prefix", options.bridge.frame_prefix, "stands before the names of frames"},
          {"parent", options.bridge.parent_frame, "frame of the link that carries the cover"}};
}

// The clock of a simulator, for use_sim_time.
class RosClock {
 public:
  explicit RosClock(bridge::Domain& domain) : clock_(domain.subscribe("/clock", "rosgraph_msgs/msg/Clock")) {}
  /// Reads what came; returns whether the clock was ever heard.
  bool step(std::uint64_t now_ns) {
    if (const auto message = clock_->take()) {
      recording::CdrReader r(*message);
      const auto seconds = static_cast<std::int32_t>(r.u32());
      const std::uint32_t nanoseconds = r.u32();
      if (r.ok()) {
        offset_ns_ = std::int64_t{seconds} * 1'000'000'000 + nanoseconds - static_cast<std::int64_t>(now_ns);
        heard_ = true;
      }
    }
    return heard_;
  }
  [[nodiscard]] std::int64_t offset_ns() const { return offset_ns_; }

 private:
  std::unique_ptr<bridge::Subscriber> clock_;
  std::int64_t offset_ns_ = 0;
  bool heard_ = false;
};

// Says on a topic of its own whether somebody presses hard, at the sample that shows it and not at the next list of
// contacts.
class StopWatch {
 public:
  explicit StopWatch(const Options& options) : counts_(options.stop_counts), kpa_(options.stop_kpa) {}
  [[nodiscard]] bool is_set() const { return counts_ > 0.0 || kpa_ > 0.0; }
  // Returns whether the state is another than before.
  bool add(const skin::LiveSample& s, std::uint64_t now_ns) {
    if (!is_pressed(s)) return false;
    until_ns_ = now_ns + kHold_ns;
    if (stop_) return false;
    max_latency_us_ = std::max(max_latency_us_, now_ns > s.unix_ns ? (now_ns - s.unix_ns) / 1000 : 0);
    return stop_ = true;
  }
  void step(std::uint64_t now_ns) { stop_ = stop_ && now_ns < until_ns_; }
  [[nodiscard]] bool stop() const { return stop_; }
  // The longest time between a sample that said stop and its message.
  [[nodiscard]] std::uint64_t max_latency_us() const { return max_latency_us_; }

 private:
  static constexpr std::uint64_t kHold_ns = 500'000'000;
  [[nodiscard]] bool is_pressed(const skin::LiveSample& s) const {
    for (std::size_t t = 0; t < s.change_counts.size(); ++t) {
      if ((s.valid >> t & 1U) == 0 || !layout::measures_pressure(t)) continue;
      if (counts_ > 0.0 && s.change_counts[t] >= counts_) return true;
      if (kpa_ > 0.0 && s.pressure_kpa && (*s.pressure_kpa)[t] >= kpa_) return true;
    }
    return false;
  }
  double counts_, kpa_;
  bool stop_ = false;
  std::uint64_t until_ns_ = 0, max_latency_us_ = 0;
};

// Returns the value of --domain, or else that of the environment. If CLI11 read the variable, it would refuse every
// command for a bad value.
std::uint32_t domain_of(const Options& options) {
  if (options.domain) return *options.domain;
  const char* text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == '\0') return 0;
  constexpr unsigned long kMaxDomain = 232;
  char* end = nullptr;
  const unsigned long id = std::strtoul(text, &end, 10);
  if (*end != '\0' || id > kMaxDomain)
    throw InputError(fmt::format("ROS_DOMAIN_ID is {}, not 0 to {}; run: triskin doctor", text, kMaxDomain));
  return static_cast<std::uint32_t>(id);
}

bridge::Pose pose_of(const std::vector<double>& numbers) {
  bridge::Pose pose;
  if (numbers.empty()) return pose;
  std::copy_n(numbers.begin(), 3, pose.translation_m.begin());
  std::copy_n(numbers.begin() + 3, 4, pose.rotation.begin());
  double square = 0.0;
  for (const double v : pose.rotation) square += v * v;
  if (!(std::abs(square - 1.0) <= 1e-3))
    throw InputError("--pose: the last four numbers are not a unit quaternion x y z w");
  if (!std::ranges::all_of(pose.translation_m, [](double v) { return std::isfinite(v); }))
    throw InputError("--pose: x y z must be finite numbers (m)");
  constexpr double kMetre_mm = 1000.0;
  robot::require_reach(kMetre_mm * Eigen::Vector3d(pose.translation_m[0], pose.translation_m[1], pose.translation_m[2]),
                       "--pose", "x y z are metres: are they millimetres? Then divide them by 1000");
  return pose;
}

// Makes one part of the diagnostics for each controller; the first sentence names the problem.
bridge::Diagnosis diagnosis_of(const session::ClockState& c, const session::SampleCounts& n, bool silent,
                               const std::string& part) {
  using Level = bridge::Diagnosis::Level;
  bridge::Diagnosis d;
  d.name = fmt::format("skin {}: patch {}", part, c.patch);
  d.hardware_id = fmt::format("controller {}", c.node);
  d.level = silent ? Level::kError : n.lost() > 0 ? Level::kWarn : Level::kOk;
  d.message = silent         ? "its controller is silent; check power and cable"
              : n.lost() > 0 ? fmt::format("{} of {} {} lost", n.lost(), counted(n.expected, "sample"),
                                           agreeing(n.lost(), "was", "were"))
                             : "ok";
  d.values = {{"expected", std::to_string(n.expected)},
              {"received", std::to_string(n.received)},
              {"lost", std::to_string(n.lost())},
              {"clock_drift_ppm", fmt::format("{:.1f}", c.drift_ppm)},
              {"clock_error_us", c.error_us == session::LinkTime::kUnbounded ? "" : std::to_string(c.error_us)}};
  return d;
}

std::vector<bridge::Diagnosis> diagnose(const session::StreamReport& report, const std::string& part) {
  std::map<layout::PatchIndex, session::SampleCounts> counts;
  for (const session::ModuleCounts& m : report.modules) counts[m.patch] += m.counts;
  std::vector<bridge::Diagnosis> parts;
  for (const session::ClockState& c : report.clocks) {
    const bool silent = std::ranges::find(report.silent, c.patch) != report.silent.end();
    parts.push_back(diagnosis_of(c, counts[c.patch], silent, part));
  }
  return parts;
}

// The option --newton-per-count takes precedence over a calibration.
bridge::BridgeOptions with_unit(bridge::BridgeOptions options, const design::SkinCalibration& calibration) {
  options.calibration.by_taxel = calibration.complete() && options.calibration.newton_per_count <= 0.0;
  return options;
}

// Each cover has its own topics and contacts.
class CoverFeed {
 public:
  CoverFeed(skin::LiveCover& cover, bridge::Domain& domain, const bridge::BridgeOptions& cover_options,
            const Options& options, std::uint64_t now_ns)
      : cover_(cover),
        part_(cover_options.part),
        bridge_(domain, cover.design(), with_unit(cover_options, cover.calibration()), now_ns),
        stop_(options) {
    if (options.stop_kpa > 0.0 && !cover.calibration().complete())
      throw InputError("--stop-kpa needs a calibration of the cover; run triskin calibrate, or give --stop-counts");
    if (options.services) services_.emplace(domain, "skin/" + part_, cover);
  }

  void set_clock_offset(std::int64_t offset_ns) { bridge_.set_clock_offset(offset_ns); }
  void add(const skin::LiveSample& s, std::uint64_t now_ns) {
    if (stop_.is_set() && stop_.add(s, now_ns)) bridge_.add_stop(true);
    bridge_.add({s.module, s.raw.link_time_us, s.raw.sample, s.unix_ns, s.error_us});
  }
  void slice(skin::LiveBus& bus, std::uint64_t now_ns) {
    if (stop_.is_set()) {
      stop_.step(now_ns);
      bridge_.add_stop(stop_.stop());
    }
    bridge_.add_contacts(contact_messages(cover_.touches(), cover_.design(), cover_.calibration()), now_ns);
    if (services_) services_->step(bus.bus());
  }
  void diagnose(const session::StreamReport& report, std::uint64_t now_ns, const Output& output) {
    auto parts = bridge_command::diagnose(report, part_);
    const int others = bridge_.other_publishers();
    if (others > 0)
      parts.push_back({bridge::Diagnosis::Level::kError, fmt::format("skin {}", part_), in_words(), "", {}});
    if (others > 0 && others_ == 0) output.say(in_words());
    others_ = std::max(others_, others);
    bridge_.add_diagnostics(parts, now_ns);
  }
  void end(const session::StreamReport& report, std::uint64_t now_ns, const Output& output) {
    bridge_.flush();
    diagnose(report, now_ns, output);
    report_ = report;
  }
  // Adds the report of the cover; returns the exit status.
  int print_report(const robot::BusConfig& bus, nlohmann::json& rows, Output& output) const {
    const robot::CoverConfig& cover = cover_.config();
    nlohmann::json row = keys_of(bus, cover);
    const bridge::Published& p = bridge_.published();
    for (const std::string& line : sentences(report_)) output.say(prefix_of(cover) + line);
    add_stream_keys(report_, row);
    row["part"] = part_;
    row["other_publishers"] = others_;
    row["calibration"] = calibration_keys(cover_.calibration());
    row["published"] = {{"raw", p.raw},           {"samples", p.samples},   {"points", p.points},
                        {"contacts", p.contacts}, {"wrenches", p.wrenches}, {"diagnostics", p.diagnostics}};
    if (stop_.is_set()) {
      row["stop"] = {{"messages", p.stops}, {"max_latency_us", stop_.max_latency_us()}};
      output.say(fmt::format("{}stop: {}, said at most {:.1f} ms after the sample", prefix_of(cover),
                             counted(p.stops, "message"), 1e-3 * static_cast<double>(stop_.max_latency_us())));
    }
    output.say(fmt::format("/skin/{}: {} with {}, {}, {} of contacts", part_, counted(p.raw, "raw message"),
                           counted(p.samples, "sample"), counted(p.points, "point cloud"),
                           counted(p.contacts, "list")));
    rows.push_back(std::move(row));
    return report_.complete() ? 0 : 1;
  }

 private:
  [[nodiscard]] std::string in_words() const {
    return fmt::format(
        "another program publishes /skin/{} in this domain too, and readers get both mixed; end one of them, or give "
        "it "
        "another --part or --domain",
        part_);
  }

  skin::LiveCover& cover_;
  std::string part_;
  int others_ = 0;  // At most this many other programs published the part at the same time.
  bridge::Bridge bridge_;
  StopWatch stop_;
  std::optional<CoverServices> services_;
  session::StreamReport report_;
};

// Feeds the stream of one bus into the topics of its covers.
class BusFeed {
 public:
  // The bus that has `parameters` answers questions for them; the others have a null pointer.
  BusFeed(const Options& options, skin::LiveBus& bus, bridge::ParameterServices* parameters)
      : options_(options), bus_(bus), parameters_(parameters) {}

  void run(bridge::Domain& domain, const std::vector<bridge::BridgeOptions>& by_cover, const Output& output) {
    bus_.find_controllers();
    if (options_.use_sim_time) wait_for_clock(domain);
    const std::uint64_t start_us = bus_.now_us();
    const auto offset_ns = static_cast<std::uint64_t>(clock_ ? clock_->offset_ns() : 0);
    for (skin::LiveCover& cover : bus_.covers()) {
      calibrate_cover(options_.calibration, bus_, cover, output);
      covers_.push_back(std::make_unique<CoverFeed>(cover, domain,
                                                    by_cover[static_cast<std::size_t>(cover.config().cover)], options_,
                                                    bus_.unix_ns(start_us) + offset_ns));
    }
    step_clock();
    bus_.start(speaking(options_.stream),
               [this](const skin::LiveSample& s) { covers_[static_cast<std::size_t>(s.cover)]->add(s, now_ns()); });
    feed(start_us, output);
    bus_.finish();
    for (std::size_t c = 0; c < covers_.size(); ++c) covers_[c]->end(bus_.report(c), now_ns(), output);
  }
  int print_report(nlohmann::json& rows, Output& output) const {
    int status = 0;
    for (const auto& cover : covers_) status = std::max(status, cover->print_report(bus_.config(), rows, output));
    return status;
  }

 private:
  static constexpr std::uint64_t kDiagnostics_us = 1'000'000;

  [[nodiscard]] std::uint64_t now_ns() const { return bus_.unix_ns(bus_.now_us()); }

  void wait_for_clock(bridge::Domain& domain) {
    clock_.emplace(domain);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!clock_->step(now_ns())) {
      if (interrupt_signal() > 0) return;
      if (std::chrono::steady_clock::now() > end)
        throw DeviceError("use_sim_time is true, but nobody published /clock within 10 s; start the simulator first");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  void step_clock() {
    if (!clock_) return;
    (void)clock_->step(now_ns());
    for (const auto& cover : covers_) cover->set_clock_offset(clock_->offset_ns());
  }

  // Subscribers get the samples at the pace of the skin, even from a simulation that could be faster.
  void feed(std::uint64_t start_us, const Output& output) {
    constexpr std::uint64_t kPaced_us = 10'000;
    const auto contacts_us = static_cast<std::uint64_t>(1e6 / options_.contacts_hz);
    std::uint64_t next_us = bus_.now_us() + contacts_us;
    Pace pace(bus_.now_us());
    skin::LiveRun run;
    if (options_.seconds > 0.0) run.until_us = start_us + static_cast<std::uint64_t>(options_.seconds * 1e6);
    run.before_slice = [&] { run.slice_us = std::min(kPaced_us, next_us - bus_.now_us()); };
    run.after_slice = [&] {
      pace.hold(bus_.now_us());
      step_clock();
      if (bus_.now_us() < next_us) return true;
      slice(output);
      next_us = bus_.now_us() + contacts_us;
      return true;
    };
    bus_.run(run);
  }

  void slice(const Output& output) {
    for (const auto& cover : covers_) cover->slice(bus_, now_ns());
    if (parameters_ != nullptr) parameters_->step();
    if (bus_.now_us() < diagnostics_us_) return;
    for (std::size_t c = 0; c < covers_.size(); ++c) covers_[c]->diagnose(bus_.report(c), now_ns(), output);
    diagnostics_us_ = bus_.now_us() + kDiagnostics_us;
  }

  const Options& options_;
  skin::LiveBus& bus_;
  bridge::ParameterServices* parameters_;
  std::optional<RosClock> clock_;
  std::vector<std::unique_ptr<CoverFeed>> covers_;
  std::uint64_t diagnostics_us_ = 0;  // The next diagnostics are due at this time.
};

bridge::BridgeOptions options_of_cover(bridge::BridgeOptions options, const robot::CoverEntry& cover) {
  constexpr double kMetre_mm = 1000.0;
  options.part = bridge::part_name(cover.name);
  if (!cover.frame.empty()) options.parent_frame = cover.frame;
  const Eigen::Quaterniond q(cover.pose.linear());
  for (int axis = 0; axis < 3; ++axis)
    options.pose.translation_m[static_cast<std::size_t>(axis)] = cover.pose.translation()[axis] / kMetre_mm;
  options.pose.rotation = {q.x(), q.y(), q.z(), q.w()};
  return options;
}

// The result is indexed by cover of the robot file; a design file has one.
std::vector<bridge::BridgeOptions> options_of(const Options& options, const robot::Site& site) {
  bridge::BridgeOptions common = options.bridge;
  common.pose = pose_of(options.pose);
  if (!site.is_robot) {
    if (common.part.empty()) common.part = bridge::part_name(site.buses.front().covers.front().design.name);
    return {common};
  }
  if (!common.part.empty() || !options.pose.empty())
    throw InputError("--part and --pose are for a design file; the covers of a robot have theirs in the robot file");
  std::vector<bridge::BridgeOptions> by_cover;
  for (const robot::CoverEntry& cover : robot::read_robot(site.file).covers)
    by_cover.push_back(options_of_cover(common, cover));
  return by_cover;
}

void require_frame(const std::string& option, const std::string& frame) {
  if (!robot::is_frame_name(frame))
    throw InputError(fmt::format("{} \"{}\": a frame of tf2 has a name without a leading slash or blanks, such as {}",
                                 option, frame,
                                 frame.size() > 1 && frame.front() == '/' ? frame.substr(1) : "base_link"));
}

int run(Options options, Output& output) {
  const char* distribution = std::getenv("ROS_DISTRO");
  const bridge::RosNode node = bridge::ros_node(ros_arguments(), distribution == nullptr ? "" : distribution);
  take_parameters(node.parameters, options);
  require_frame("--parent", options.bridge.parent_frame);
  if (!options.bridge.frame_prefix.empty()) require_frame("--frame-prefix", options.bridge.frame_prefix);
  options.bridge.stop = options.stop_counts > 0.0 || options.stop_kpa > 0.0;
  output.expect_interrupt();
  robot::Site site = read_site(options.site);
  const std::vector<bridge::BridgeOptions> by_cover = options_of(options, site);
  const std::uint32_t domain_id = domain_of(options);
  const bridge::RosDiscovery discovery = bridge::ros_discovery(&std::getenv);
  const auto domain = bridge::join_domain(domain_id, discovery, node);
  std::optional<bridge::ParameterServices> parameters;
  if (options.services) parameters.emplace(*domain, parameters_of(options));
  skin::LiveSkin skin(std::move(site), options.site.link);
  open_links(skin, output);
  std::deque<BusFeed> feeds;
  for (const auto& bus : skin.buses())
    feeds.emplace_back(options, *bus, feeds.empty() && parameters ? &*parameters : nullptr);
  output.say(fmt::format("publishing {} in domain {}{}{}; end with Ctrl-C", node.resolve("skin/…"), domain_id,
                         discovery.words.empty() ? "" : " ", discovery.words));
  skin.on_each_bus([&](skin::LiveBus& bus) { feeds[bus.index()].run(*domain, by_cover, output); });
  nlohmann::json rows = nlohmann::json::array();
  int status = 0;
  for (const BusFeed& feed : feeds) status = std::max(status, feed.print_report(rows, output));
  if (skin.site().is_robot)
    output.result = {{"covers", std::move(rows)}};
  else
    output.result = std::move(rows[0]);
  return status;
}

const Registration kBridge{{
    "bridge",
    "publish the skin on DDS as ROS 2 has it: points, raw samples, contacts, wrench, layout, diagnostics, tf",
    "triskin bridge forearm.json --link can:can0 --points-hz 20",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      add_site_options(app, options->site);
      add_stream_options(app, options->stream);
      add_calibration_options(app, options->calibration);
      app.add_option(
          "--part", options->bridge.part,
          "name in the topics /skin/PART/…; default: that of the design. Of a robot: the names of its covers");
      app.add_option("--domain", options->domain, "DDS domain; default: ROS_DOMAIN_ID of the environment, else 0")
          ->check(CLI::Range(0, 232));
      app.add_option("--points-hz", options->bridge.points_hz, "point clouds a second; 0: none")
          ->check(CLI::Range(0.0, 100.0))
          ->capture_default_str();
      app.add_option("--contacts-hz", options->contacts_hz, "lists of contacts a second")
          ->check(CLI::Range(0.5, 100.0))
          ->capture_default_str();
      app.add_option("--newton-per-count", options->bridge.calibration.newton_per_count,
                     "force of a contact by the sum of its counts, in place of a calibration of each taxel")
          ->check(CLI::PositiveNumber);
      app.add_flag("!--no-raw", options->bridge.raw, "without every sample of every module");
      app.add_flag("!--no-markers", options->bridge.markers, "without triangles and arrows for viewers");
      app.add_option("--stop-counts", options->stop_counts,
                     "/skin/PART/stop is true while a taxel is this many counts below rest, and 0.5 s longer")
          ->check(CLI::PositiveNumber);
      app.add_option("--stop-kpa", options->stop_kpa, "the same by the pressure on a taxel; needs a calibration")
          ->check(CLI::PositiveNumber);
      app.add_flag("!--no-services", options->services, "without the services to tare, reroute and identify");
      app.add_option("--parent", options->bridge.parent_frame, "frame of the link that carries the cover")
          ->capture_default_str();
      app.add_option("--frame-prefix", options->bridge.frame_prefix,
                     "stands before the frames, as that of robot_state_publisher (left/)");
      app.add_option("--pose", options->pose, "of the cover's mesh in it: x,y,z (m) and quaternion x,y,z,w")
          ->delimiter(',')
          ->expected(7);
      app.add_option("--seconds", options->seconds, "of the link's time; default: until Ctrl-C")
          ->check(CLI::Range(0.0, 1e7));
      app.add_flag("--ros-args", options->ros_args,
                   "what follows is for ROS 2: -r FROM:=TO, -r __ns:=/robot1, -p NAME:=VALUE");
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kData,
}};

}  // namespace
}  // namespace triskin::cli::bridge_command
