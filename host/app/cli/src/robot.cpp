// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/robot/robot.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <set>

#include "command.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/short_list.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/base/writer_lock.hpp"
#include "triskin/connect/open_link.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/robot/assembly.hpp"
#include "triskin/robot/edit.hpp"
#include "triskin/robot/registration.hpp"

namespace triskin::cli::robot_command {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string action, robot, file;
  std::string name, urdf, frame;
  std::vector<std::string> buses, serials;
  std::vector<double> xyz_mm, rpy_deg, matrix;
  int first_node = 0;
  double rate_hz = -1.0, limit_mm = 5.0;
  bool replace = false, dry_run = false;
};

// Lists the options that each action uses besides --json. An option without effect is refused.
const std::map<std::string, std::set<std::string>> kActions{
    {"new", {"--name", "--bus", "--urdf"}},
    {"add",
     {"--name", "--bus", "--frame", "--xyz-mm", "--rpy-deg", "--matrix", "--first-node", "--serial", "--rate-hz",
      "--replace"}},
    {"remove", {"--name", "--bus"}},
    {"show", {}},
    {"register", {"--name", "--limit-mm", "--dry-run"}}};

void require_known(const CLI::App& app, const std::string& action) {
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name();
    if (option->empty() || option->get_positional() || name == "--json" || name == "--help") continue;
    if (!kActions.at(action).contains(name))
      throw InputError(fmt::format("robot {}: {} is for another action; see triskin robot --help", action, name));
  }
}

void require(const std::string& value, const Options& options, const char* what) {
  if (value.empty()) throw InputError(fmt::format("robot {}: give {}", options.action, what));
}

// Returns the path of a file relative to the folder of the robot file.
std::string seen_from(const std::string& robot, const std::string& file) {
  const fs::path from = fs::absolute(robot).parent_path();
  const fs::path relative = fs::absolute(file).lexically_normal().lexically_relative(from.lexically_normal());
  return relative.empty() ? fs::absolute(file).string() : relative.generic_string();
}

void define_bus(robot::Robot& robot, const std::string& text) {
  robot::BusEntry bus = robot::parse_bus(text);
  connect::require_known_link(bus.link);
  if (std::ranges::find(robot.buses, bus.name, &robot::BusEntry::name) != robot.buses.end())
    throw InputError(fmt::format("--bus {}: the robot has a bus {} already; change it in the file", text, bus.name));
  robot.buses.push_back(std::move(bus));
}

void require_name(const Options& options, const char* what) {
  require(options.name, options, what);
  if (!robot::is_name(options.name))
    throw InputError(
        fmt::format("--name {}: must be a letter of any script, then letters, digits, _ or -", options.name));
}

int run_new(const Options& options, Output& output) {
  require_name(options, "the robot's name with --name");
  if (fs::exists(options.robot))
    throw InputError(fmt::format("{}: exists already; choose another name or remove it", options.robot));
  robot::Robot made;
  made.name = options.name;
  if (!options.urdf.empty()) {
    (void)robot::Frames::read_urdf(options.urdf);
    made.urdf = seen_from(options.robot, options.urdf);
  }
  for (const std::string& bus : options.buses) define_bus(made, bus);
  write_file_atomically(options.robot, robot::robot_text(made));
  output.result = {{"name", made.name}, {"buses", made.buses.size()}, {"covers", 0}};
  output.say(fmt::format("{}: robot {} with {}", options.robot, made.name, counted(made.buses.size(), "bus")));
  return 0;
}

// Writes only what can be read again.
void write_robot(const Options& options, const robot::Robot& robot) {
  const std::string text = robot::robot_text(robot);
  (void)robot::parse_robot(text, options.robot);
  write_file_atomically(options.robot, text);
}

void require_turns(const std::vector<double>& rpy_deg) {
  constexpr double kTurn_deg = 360.0;
  for (const double v_deg : rpy_deg) {
    if (!(std::abs(v_deg) <= kTurn_deg))
      throw InputError(fmt::format("--rpy-deg: {:g} must be an angle in -360 … 360 degrees", v_deg));
  }
}

// The values are parsed like a file, so that the same rules apply.
Eigen::Isometry3d pose_of_matrix(std::span<const double> matrix) {
  if (!std::ranges::all_of(matrix, [](double v) { return std::isfinite(v); }))
    throw InputError("--matrix: its 16 numbers must be finite");
  std::vector<std::string> rows;
  for (std::size_t row = 0; row < 4; ++row)
    rows.push_back(fmt::format("[{}]", fmt::join(matrix.subspan(4 * row, 4), ",")));
  return robot::parse_pose(fmt::format("{{\"matrix\":[{}]}}", fmt::join(rows, ",")), "--matrix");
}

void set_pose(robot::CoverEntry& cover, const Options& options) {
  if (!options.matrix.empty() && !(options.xyz_mm.empty() && options.rpy_deg.empty()))
    throw InputError("--matrix: gives the whole pose; leave out --xyz-mm and --rpy-deg");
  if (!options.matrix.empty()) {
    cover.pose = pose_of_matrix(options.matrix);
    cover.xyz_rpy.reset();
  } else if (!options.xyz_mm.empty() || !options.rpy_deg.empty()) {
    require_turns(options.rpy_deg);
    std::array<double, 6> numbers{};
    for (std::size_t k = 0; k < options.xyz_mm.size(); ++k) numbers[k] = options.xyz_mm[k];
    for (std::size_t k = 0; k < options.rpy_deg.size(); ++k)
      numbers[3 + k] = options.rpy_deg[k] * std::numbers::pi / 180.0;
    cover.xyz_rpy = numbers;
    cover.pose = robot::pose_of(numbers);
  } else {
    return;
  }
  robot::require_reach(cover.pose.translation(), options.matrix.empty() ? "--xyz-mm" : "--matrix",
                       "places are millimetres: are they micrometres? Then divide them by 1000");
  cover.has_pose = true;
  cover.measured.reset();
}

void set_serials(robot::CoverEntry& cover, const Options& options) {
  for (const std::string& text : options.serials) {
    const auto [patch, serial] = robot::parse_serial(text);
    const auto entry = std::ranges::find(cover.controllers, patch, &robot::ControllerEntry::patch);
    if (entry == cover.controllers.end()) {
      std::vector<int> patches;
      for (const robot::ControllerEntry& e : cover.controllers) patches.push_back(e.patch);
      throw InputError(
          fmt::format("--serial {}: cover {} has patches {}", text, cover.name, design::ranges_text(patches)));
    }
    entry->serial = serial;
  }
}

// A change must leave a usable file, so one that no command would accept is not written.
void write_checked(const Options& options, const robot::Robot& robot, Output& output) {
  robot::Assembly changed = robot::assemble(robot, options.robot);
  const auto problems = robot::check(changed);
  if (!problems.empty())
    throw InputError(
        fmt::format("{}: {}; {}; nothing was written", problems[0].place, problems[0].text, problems[0].remedy));
  write_robot(options, robot);
  output.result["covers"] = robot.covers.size();
  output.result["buses"] = robot.buses.size();
}

// Returns a new cover, or with --replace the existing one. Each bus has its own addresses, so on another bus they are
// assigned again.
// Addresses belong to a bus, so those of controllers on other buses are removed.
void move_to_bus(robot::CoverEntry& cover, const std::string& bus) {
  for (robot::ControllerEntry& e : cover.controllers) {
    if (e.bus.empty()) e.bus = cover.bus;
  }
  cover.bus = bus;
  std::erase_if(cover.controllers, [&](const robot::ControllerEntry& e) { return e.bus != bus; });
}

robot::CoverEntry& cover_to_add(robot::Robot& robot, const std::string& bus, const Options& options) {
  robot::CoverEntry* cover = robot::find_cover(robot, options.name);
  if (cover != nullptr && !options.replace)
    throw InputError(
        fmt::format("{}: has a cover {} already; --replace gives it another design", options.robot, options.name));
  if (cover == nullptr) {
    if (options.replace)
      throw InputError(fmt::format("{}: has no cover {} to replace; leave out --replace", options.robot, options.name));
    require(bus, options, "the bus of the cover with --bus");
    cover = &robot.covers.emplace_back();
    cover->name = options.name;
  }
  if (!bus.empty() && bus != cover->bus) move_to_bus(*cover, bus);
  return *cover;
}

int run_add(const Options& options, Output& output) {
  robot::Robot robot = robot::read_robot(options.robot);
  std::string bus;
  for (const std::string& text : options.buses) {
    if (text.find('=') != std::string::npos) define_bus(robot, text);
    bus = text.substr(0, text.find('='));
  }
  if (options.file.empty() && options.name.empty()) {
    require(bus, options, "a design file with --name and --bus, or a bus as --bus NAME=LINK");
    write_checked(options, robot, output);
    output.say(fmt::format("{}: {}", options.robot, counted(robot.buses.size(), "bus")));
    return 0;
  }
  require_name(options, "the cover's name with --name");
  require(options.file, options, "the design file of the cover");
  robot::CoverEntry& cover = cover_to_add(robot, bus, options);
  cover.design = seen_from(options.robot, options.file);
  if (!options.frame.empty()) cover.frame = options.frame;
  if (options.rate_hz >= 0.0) cover.rate_hz = options.rate_hz;
  set_pose(cover, options);
  robot::seat(robot, cover, design::read_intact_design(options.file), options.first_node);
  set_serials(cover, options);
  const robot::CoverEntry added = cover;
  write_checked(options, robot, output);
  std::vector<int> nodes;
  for (const auto& e : added.controllers) nodes.push_back(e.node);
  output.result["cover"] = added.name;
  output.result["nodes"] = nodes;
  output.say(fmt::format("cover {}: {} on bus {}, node addresses {}", added.name, counted(nodes.size(), "controller"),
                         added.bus, short_list(nodes)));
  return 0;
}

int run_remove(const Options& options, Output& output) {
  robot::Robot robot = robot::read_robot(options.robot);
  const std::string bus = options.buses.size() == 1 ? options.buses.front() : "";
  if (options.name.empty() == bus.empty())
    throw InputError("robot remove: give the cover's name with --name, or the bus with --bus");
  if (!options.name.empty()) {
    if (std::erase_if(robot.covers, [&](const auto& c) { return c.name == options.name; }) == 0)
      throw InputError(fmt::format("{}: has no cover {}", options.robot, options.name));
    write_checked(options, robot, output);
    output.say(fmt::format("{}: cover {} removed; {} left", options.robot, options.name,
                           counted(robot.covers.size(), "cover")));
    return 0;
  }
  if (std::erase_if(robot.buses, [&](const auto& b) { return b.name == bus; }) == 0)
    throw InputError(fmt::format("{}: has no bus {}", options.robot, bus));
  for (const robot::CoverEntry& cover : robot.covers) {
    if (cover.bus == bus || std::ranges::count(cover.controllers, bus, &robot::ControllerEntry::bus) > 0)
      throw InputError(
          fmt::format("{}: cover {} is on bus {}; remove the cover, or move it to another bus (robot "
                      "add --replace --bus)",
                      options.robot, cover.name, bus));
  }
  write_checked(options, robot, output);
  output.say(fmt::format("{}: bus {} removed; {} left", options.robot, bus, counted(robot.buses.size(), "bus")));
  return 0;
}

// Returns turns about the fixed axes x, y, z for --rpy-deg, each within ±180°.
Eigen::Vector3d rpy_deg_of(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d r = pose.linear();
  const Eigen::Vector3d turns(std::atan2(r(2, 1), r(2, 2)), std::asin(std::clamp(-r(2, 0), -1.0, 1.0)),
                              std::atan2(r(1, 0), r(0, 0)));
  return turns * (180.0 / std::numbers::pi);
}

std::string place_text(const robot::CoverEntry& cover) {
  const std::string link = cover.frame.empty() ? "the base" : cover.frame;
  if (!cover.has_pose) return fmt::format("its pose in {} is not set", link);
  const Eigen::Vector3d at = cover.pose.translation(), turns = rpy_deg_of(cover.pose);
  return fmt::format("at ({:.1f}, {:.1f}, {:.1f}) mm in {}, turned by ({:.1f}, {:.1f}, {:.1f})°{}", at.x(), at.y(),
                     at.z(), link, turns.x(), turns.y(), turns.z(),
                     cover.measured ? fmt::format(", measured by {} touches, residual {:.2f} mm",
                                                  cover.measured->points, cover.measured->rms_mm)
                                    : "");
}

void add_pose_keys(const robot::CoverEntry& cover, nlohmann::json& keys) {
  if (!cover.has_pose) return;
  const Eigen::Vector3d at = cover.pose.translation(), turns = rpy_deg_of(cover.pose);
  keys["xyz_mm"] = {at.x(), at.y(), at.z()};
  keys["rpy_deg"] = {turns.x(), turns.y(), turns.z()};
}

// Lists what the file does not contain, and the option that adds it. No command needs all of it, so this is no mistake.
std::vector<std::string> missing_of(const robot::Robot& robot, const std::string& file) {
  std::vector<std::string> missing;
  if (robot.urdf.empty() && !robot.covers.empty())
    missing.emplace_back(
        "the robot's links: name its URDF by the key \"urdf\"; until then frames are not checked, and "
        "covers of several links cannot be shown together");
  for (const robot::CoverEntry& c : robot.covers) {
    if (!c.has_pose)
      missing.push_back(
          fmt::format("the place of cover {}: triskin robot register {} TOUCHES.csv --name {}, or "
                      "robot add with --xyz-mm and --rpy-deg; until then it is drawn at the origin",
                      c.name, file, c.name));
    const auto unnamed = std::ranges::count_if(c.controllers, [](const auto& e) { return e.serial.empty(); });
    if (unnamed > 0)
      missing.push_back(fmt::format("serial numbers of {} of {} of cover {}: triskin discover {} --note", unnamed,
                                    counted(c.controllers.size(), "controller"), c.name, file));
  }
  return missing;
}

nlohmann::json show_controllers(const robot::CoverEntry& cover, const Output& output) {
  nlohmann::json controllers = nlohmann::json::array();
  for (const auto& e : cover.controllers) {
    const std::string& bus = e.bus.empty() ? cover.bus : e.bus;
    output.say(fmt::format("  patch {:3}  bus {}  node address {:3}  {}", e.patch, bus, e.node,
                           e.serial.empty() ? "serial number unknown" : e.serial));
    controllers.push_back({{"patch", e.patch}, {"bus", bus}, {"node_address", e.node}});
    if (!e.serial.empty()) controllers.back()["serial"] = e.serial;
  }
  return controllers;
}

void show_cover(const robot::CoverEntry& cover, const design::Design& design, Output& output) {
  output.say(fmt::format("cover {}: {} on {}; {}, design {:016x}{}; {}", cover.name,
                         counted(design.layout.modules.size(), "module"),
                         counted(cover.controllers.size(), "controller"), cover.design, cover.design_id,
                         cover.rate_hz > 0.0 ? fmt::format("; wants {} Hz", cover.rate_hz) : "", place_text(cover)));
  nlohmann::json controllers = show_controllers(cover, output);
  output.result["covers"].push_back({{"name", cover.name},
                                     {"design", cover.design},
                                     {"design_id", fmt::format("{:016x}", cover.design_id)},
                                     {"modules", design.layout.modules.size()},
                                     {"frame", cover.frame},
                                     {"controllers", std::move(controllers)}});
  add_pose_keys(cover, output.result["covers"].back());
}

void show_bus(const robot::BusEntry& bus, const robot::BusLoad& load, Output& output) {
  output.say(fmt::format("bus {}: {}, {}, {}; every sample is {:.0f} % of it, so {} ({:.1f} Hz)", bus.name, bus.link,
                         counted(load.controllers, "controller"), counted(load.modules, "module"), 100.0 * load.full,
                         load.every == 1 ? std::string("all fit") : fmt::format("one in {} fits", load.every),
                         load.rate_hz));
  output.result["buses"].push_back({{"name", bus.name},
                                    {"link", bus.link},
                                    {"controllers", load.controllers},
                                    {"modules", load.modules},
                                    {"load", load.full},
                                    {"every", load.every},
                                    {"rate_hz", load.rate_hz}});
}

int run_show(const Options& options, Output& output) {
  const robot::Assembly a = robot::read_assembly(options.robot);
  output.result = {{"name", a.robot.name},
                   {"buses", nlohmann::json::array()},
                   {"covers", nlohmann::json::array()},
                   {"missing", missing_of(a.robot, options.robot)},
                   {"problems", nlohmann::json::array()}};
  output.say(fmt::format("robot {}: {} on {}", a.robot.name, counted(a.robot.covers.size(), "cover"),
                         counted(a.robot.buses.size(), "bus")));
  const auto loads = robot::bus_loads(a);
  for (std::size_t b = 0; b < a.robot.buses.size(); ++b) show_bus(a.robot.buses[b], loads[b], output);
  for (std::size_t c = 0; c < a.robot.covers.size(); ++c) show_cover(a.robot.covers[c], a.designs[c], output);
  const auto problems = robot::check(a);
  for (const robot::Problem& p : problems) {
    output.say(fmt::format("{}: {}\n    {}", p.place, p.text, p.remedy));
    output.result["problems"].push_back({{"place", p.place}, {"text", p.text}, {"remedy", p.remedy}});
  }
  for (const std::string& what : missing_of(a.robot, options.robot)) output.say("missing: " + what);
  output.say(counted(problems.size(), "problem"));
  return problems.empty() ? 0 : 1;
}

// Returns the doubt that the touches raise about the cover; empty if there is none.
std::string doubt(const robot::Registration& r, const Options& options) {
  const double rms_mm = r.fit.rms_mm;
  if (!r.exchanged_with.empty())
    return fmt::format(
        "the touches fit cover {} with {:.2f} mm and {} with {:.2f} mm: the two covers are exchanged, or "
        "their controllers hold each other's tables",
        r.exchanged_with, r.exchanged_rms_mm, options.name, rms_mm);
  if (r.mirrored)
    return fmt::format(
        "the mirror image of cover {} fits with {:.2f} mm, the cover itself with {:.2f} mm: it is the one "
        "of the other side, or an axis of the points has the wrong sign",
        options.name, r.mirror_rms_mm, rms_mm);
  if (rms_mm > options.limit_mm)
    return fmt::format(
        "the residual of {:.2f} mm is above {} mm, largest at touch {} ({:.2f} mm): touch it again, or "
        "raise --limit-mm",
        rms_mm, options.limit_mm, r.fit.worst + 1, r.fit.max_mm);
  return "";
}

void print_report(const robot::Registration& r, std::size_t touches, double moved_mm, const Options& options,
                  Output& output) {
  output.result = {{"cover", options.name},  {"touches", touches},
                   {"rms_mm", r.fit.rms_mm}, {"max_mm", r.fit.max_mm},
                   {"worst", r.fit.worst},   {"mirror_rms_mm", r.mirror_rms_mm},
                   {"mirrored", r.mirrored}, {"mirror_unknown", r.mirror_unknown},
                   {"moved_mm", moved_mm}};
  if (!r.exchanged_with.empty()) output.result["exchanged_with"] = r.exchanged_with;
  output.say(
      fmt::format("cover {}: {} touches, residual {:.2f} mm (mirror image {:.2f} mm), largest {:.2f} mm at touch {}",
                  options.name, touches, r.fit.rms_mm, r.mirror_rms_mm, r.fit.max_mm, r.fit.worst + 1));
  if (r.mirror_unknown)
    output.say(
        fmt::format("the touches lie in a plane within {:.1f} mm: a mirrored cover would look the same; touch places "
                    "off it",
                    r.thickness_mm));
}

robot::Registration register_cover_of(const robot::Assembly& a, const std::string& name,
                                      const std::vector<robot::Touch>& touches) {
  robot::NamedDesign own;
  std::vector<robot::NamedDesign> others;
  for (std::size_t c = 0; c < a.designs.size(); ++c) {
    const robot::NamedDesign named{a.robot.covers[c].name, &a.designs[c]};
    if (named.name == name)
      own = named;
    else
      others.push_back(named);
  }
  return robot::register_cover(own, others, touches);
}

int run_register(const Options& options, Output& output) {
  require(options.name, options, "the cover's name with --name");
  require(options.file, options, "the file with the touches");
  robot::Assembly a = robot::read_assembly(options.robot);
  robot::CoverEntry* cover = robot::find_cover(a.robot, options.name);
  if (cover == nullptr) throw InputError(fmt::format("{}: has no cover {}", options.robot, options.name));
  const std::string text = read_text(options.file);
  if (const std::string note = note_of_open_line(text, options.file); !note.empty()) output.say(note);
  const auto touches = robot::read_touches(text, options.file);
  const robot::Registration r = register_cover_of(a, options.name, touches);
  const std::string against = doubt(r, options);
  const double moved_mm = (r.fit.pose.translation() - cover->pose.translation()).norm();
  print_report(r, touches.size(), moved_mm, options, output);
  output.result["written"] = against.empty() && !options.dry_run;
  if (!against.empty()) {
    output.say(against + "; the robot file stays as it is");
    return 1;
  }
  if (options.dry_run) return 0;
  cover->pose = r.fit.pose;
  cover->has_pose = true;
  cover->xyz_rpy.reset();
  cover->measured = robot::Measured{static_cast<int>(touches.size()), r.fit.rms_mm};
  write_robot(options, a.robot);
  output.say(
      fmt::format("{}: pose of cover {} written, {:.1f} mm from where it was", options.robot, options.name, moved_mm));
  return 0;
}

void add_pose_options(CLI::App& app, Options& o) {
  app.add_option("--frame", o.frame, "add: link of the robot that the cover is fixed to; default: its base");
  app.add_option("--xyz-mm", o.xyz_mm, "add: place of the mesh frame in the link, x,y,z")->delimiter(',')->expected(3);
  app.add_option("--rpy-deg", o.rpy_deg, "add: its turns about the fixed axes x, y, z")->delimiter(',')->expected(3);
  app.add_option("--matrix", o.matrix, "add: the pose as 16 numbers, row by row, mm")->delimiter(',')->expected(16);
}

const cli::Registration kRobot{{
    "robot",
    "robot file: the covers of a robot, their places, and their buses",
    "triskin robot new icub.json --name icub --bus left=can:can0 --bus right=can:can1\n"
    "  triskin robot add icub.json forearm.json --name forearm --bus left --frame l_forearm --xyz-mm 0,12,80\n"
    "  triskin robot show icub.json\n"
    "  triskin robot register icub.json touches.csv --name forearm",
    [](CLI::App& app) -> Run {
      auto o = std::make_shared<Options>();
      app.add_option("ACTION", o->action,
                     "new, add or remove (a cover or a bus), show, or register (a cover by touches)")
          ->required()
          ->check(CLI::IsMember({"new", "add", "remove", "show", "register"}));
      app.add_option("ROBOT", o->robot, "robot file (docs/robot.md)")->required();
      app.add_option("FILE", o->file, "add: design file; register: touches, module,taxel,x_mm,y_mm,z_mm a line");
      app.add_option("--name", o->name, "of the robot (new) or of the cover (add, remove, register)");
      app.add_option("--bus", o->buses, "NAME=LINK[@RATE[/DATA_RATE]] defines a bus; add, remove: NAME");
      app.add_option("--urdf", o->urdf, "new: file with the robot's links")->check(CLI::ExistingFile);
      add_pose_options(app, *o);
      app.add_option("--first-node", o->first_node, "add: node addresses from here on")->check(CLI::Range(1, 126));
      app.add_option("--serial", o->serials, "add: PATCH=SERIAL, the controller of a patch; several times");
      app.add_option("--rate-hz", o->rate_hz, "add: samples a second wanted from each module (0: as many as fit)")
          ->check(CLI::Range(0.0, 1000.0));
      app.add_flag("--replace", o->replace, "add: replace the design of an existing cover, which keeps its addresses");
      app.add_option("--limit-mm", o->limit_mm, "register: largest residual that is accepted")
          ->check(CLI::Range(0.0, 1000.0))
          ->capture_default_str();
      app.add_flag("--dry-run", o->dry_run, "register: show the result; write nothing");
      return [o, &app](Output& output) {
        require_known(app, o->action);
        if (o->action == "show") return run_show(*o, output);
        const WriterLock lock(o->robot);  // Without the lock, a simultaneous change by another program would be lost.
        if (o->action == "new") return run_new(*o, output);
        if (o->action == "add") return run_add(*o, output);
        if (o->action == "remove") return run_remove(*o, output);
        return run_register(*o, output);
      };
    },
    cli::Group::kHardware,
}};

}  // namespace
}  // namespace triskin::cli::robot_command
