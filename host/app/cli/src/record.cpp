// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "calibration_options.hpp"
#include "contacts.hpp"
#include "site_options.hpp"
#include "stream_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/lower_case.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/bridge/bridge.hpp"
#include "triskin/hdf5/recording.hpp"
#include "triskin/hdf5/taxel_table.hpp"
#include "triskin/recording/join.hpp"
#include "triskin/recording/recorder.hpp"
#include "triskin/recording/recording.hpp"
#include "triskin/recording/rosbag2.hpp"
#include "triskin/robot/assembly.hpp"
#include "triskin/session/controller.hpp"
#include "triskin/session/firmware_version.hpp"

namespace triskin::cli::record_command {
namespace {

enum class Format { kMcap, kCsv, kHdf5, kRosbag2 };
// The option --format uses these names, which are also the extensions.
constexpr NameTable kFormatNames{std::array<std::pair<Format, std::string_view>, 4>{
    {{Format::kMcap, "mcap"}, {Format::kCsv, "csv"}, {Format::kHdf5, "hdf5"}, {Format::kRosbag2, "rosbag2"}}}};

struct Options {
  SiteOptions site;
  std::string output;
  std::string to;
  session::StreamOptions stream;
  CalibrationOptions calibration;
  double seconds = 10.0;
  double cloud_hz = 5.0;
  std::string split;
  int rosbag2_version = recording::kMinRosbag2Version;
};

// When a file ends and the next one begins; 0: never.
struct Split {
  std::uint64_t bytes = 0, link_us = 0;
  [[nodiscard]] bool is_set() const { return bytes > 0 || link_us > 0; }
};

// "200MB" or "10min".
Split split_of(const std::string& text) {
  static const std::map<std::string, double> kBytes{{"kB", 1e3}, {"MB", 1e6}, {"GB", 1e9}};
  static const std::map<std::string, double> kMicroseconds{{"s", 1e6}, {"min", 60e6}, {"h", 3600e6}};
  Split split;
  if (text.empty()) return split;
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string unit(end, text.data() + text.size());
  if (error == std::errc{} && number > 0.0 && number < 1e9) {
    if (const auto found = kBytes.find(unit); found != kBytes.end())
      split.bytes = static_cast<std::uint64_t>(number * found->second);
    if (const auto found = kMicroseconds.find(unit); found != kMicroseconds.end())
      split.link_us = static_cast<std::uint64_t>(number * found->second);
  }
  constexpr std::uint64_t kMinBytes = 100'000, kMinTime_us = 1'000'000;
  if ((split.bytes < kMinBytes && split.link_us < kMinTime_us))
    throw InputError(fmt::format(
        "--split {}: give a size of at least 100kB or a time of at least 1s, as 200MB, 1GB, 90s, 10min or 2h", text));
  return split;
}

// Closing a recording takes its open chunk (1 MB) and its summary; a few times that is kept free on the disk.
constexpr std::uintmax_t kKeptFree_bytes = 4'000'000;

// Free space on the disk of a file in bytes; the largest number if that cannot be known, as for a pipe.
std::uintmax_t free_beside(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return ~std::uintmax_t{0};
  const std::filesystem::space_info space = std::filesystem::space(file, error);
  return error ? ~std::uintmax_t{0} : space.available;
}

constexpr std::uint64_t kSlice_us = 100'000;

// Returns the format given by --format, or else by the extension; an extension that contradicts --format is refused.
Format format_of(const Options& options, bool is_robot) {
  const std::string extension = extension_of(options.output);
  const auto by_extension =
      extension == ".h5" ? Format::kHdf5 : kFormatNames.value(extension.empty() ? "" : extension.substr(1));
  if (options.to.empty()) {
    if (by_extension && *by_extension != Format::kRosbag2) return *by_extension;
    if (options.output == "-" || is_robot) return Format::kMcap;
    throw InputError(
        fmt::format("{}: say the format by the extension .mcap, .csv or .h5, or with --format", options.output));
  }
  const Format format = kFormatNames.value(options.to).value();
  if (format == Format::kRosbag2) {
    if (by_extension || options.output == "-")
      throw InputError(fmt::format("{}: a bag of ROS 2 is a folder; give a name without an extension", options.output));
    return format;
  }
  if (by_extension && *by_extension != format) {
    throw InputError(
        fmt::format("{}: the extension says {}, --format says {}; choose one", options.output, extension, options.to));
  }
  return format;
}

std::uint64_t steady_us() {
  using namespace std::chrono;
  return static_cast<std::uint64_t>(duration_cast<microseconds>(steady_clock::now().time_since_epoch()).count());
}

std::string firmware_of(session::Bus& bus, std::uint8_t node) {
  return session::firmware_version_text(session::Controller(bus, node).hello().firmware_version);
}

// Viewers need the place of a cover on its robot.
struct CoverPlace {
  std::string part, parent_frame;
  recording::Pose pose;
};

// Returns for each cover its frame in the base of the robot, with all joints at 0.
std::vector<CoverPlace> places_of(const robot::Assembly& assembly) {
  constexpr double kMetre_mm = 1000.0;
  std::vector<CoverPlace> places;
  for (const robot::CoverEntry& cover : assembly.robot.covers) {
    const bool known = assembly.frames && assembly.frames->has(cover.frame);
    const Eigen::Isometry3d at = known ? assembly.frames->pose(cover.frame) * cover.pose : cover.pose;
    const Eigen::Quaterniond q(at.linear());
    CoverPlace place{bridge::part_name(cover.name), known ? assembly.frames->base() : "base_link", {}};
    for (int axis = 0; axis < 3; ++axis)
      place.pose.translation_m[static_cast<std::size_t>(axis)] = at.translation()[axis] / kMetre_mm;
    place.pose.rotation = {q.x(), q.y(), q.z(), q.w()};
    places.push_back(std::move(place));
  }
  return places;
}

class CoverFile {
 public:
  CoverFile(const robot::CoverConfig& cover, const std::string& path, Format format, const Options& options)
      : cover_(cover),
        format_(format),
        path_(path),
        split_(split_of(options.split)),
        rosbag2_version_(options.rosbag2_version) {
    file_ = std::make_unique<recording::OutputFile>(part_path());
  }

  void place(const CoverPlace& place) {
    origin_.part = place.part;
    origin_.parent_frame = place.parent_frame;
    origin_.pose = place.pose;
  }
  void describe_controllers(skin::LiveBus& bus) {
    for (const layout::PatchIndex patch : design::patches_here(cover_.design)) {
      const auto node = static_cast<std::uint8_t>(design::node_address_of(cover_.design, patch));
      origin_.facts[fmt::format("firmware_{}", node)] = firmware_of(bus.bus(), node);
      if (std::string serial = session::serial_at(bus.claims(), node); !serial.empty())
        origin_.facts[recording::serial_fact(layout::NodeAddress{node})] = std::move(serial);
    }
  }
  // `cover` is the index of the open cover of `bus` that this file records.
  void describe(skin::LiveBus& bus, std::size_t cover, const Options& options, const Output& output) {
    live_ = &bus.covers()[cover];
    bus_ = &bus;
    origin_.design_text = read_text(cover_.design_file);
    // In a bag, topics and frame are those of the bridge.
    if (format_ == Format::kRosbag2 && origin_.part.empty()) origin_.part = bridge::part_name(cover_.design.name);
    origin_.facts["link"] = bus.bus().name();
    if (link::is_simulated(bus.bus().name())) origin_.facts["simulated"] = "true";
    origin_.facts["program"] = fmt::format("triskin {}", TRISKIN_VERSION);
    if (!cover_.name.empty()) origin_.facts["cover"] = cover_.name;
    describe_controllers(bus);
    calibrate_cover(options.calibration, bus, *live_, output);
    if (live_->calibration().complete())
      origin_.calibration_text = design::calibration_text(live_->calibration().boards());
    if (!live_->kept_rest().empty()) origin_.rest_text = design::rest_text(live_->kept_rest());
    origin_.settled_text = design::settled_text(live_->settled());
    if (options.cloud_hz > 0.0) origin_.cloud_period_us = static_cast<std::uint64_t>(1e6 / options.cloud_hz);
    origin_.link_start_us = bus.now_us();
    origin_.unix_start_ns = bus.unix_ns(origin_.link_start_us);
  }
  void begin() {
    if (recorder_) return;
    if (format_ == Format::kHdf5)
      recorder_ = hdf5::make_recorder(*file_, cover_.design, origin_);
    else
      recorder_ = recording::make_recorder(format_ == Format::kCsv ? recording::Format::kCsv : recording::Format::kMcap,
                                           *file_, cover_.design, origin_);
  }
  [[nodiscard]] bool started() const { return recorder_ != nullptr; }

  void add(const skin::LiveSample& s) {
    begin();
    recorder_->add({s.module, s.raw.link_time_us, s.raw.sample, s.unix_ns, s.error_us});
    ++samples_;
  }

  void slice() {
    const auto contacts = contact_messages(live_->touches(), cover_.design, live_->calibration());
    if (!contacts.empty() || had_contacts_) recorder_->add_contacts(bus_->now_us(), contacts);
    had_contacts_ = !contacts.empty();
    recorder_->tick(steady_us());
    if (is_part_full()) begin_next_part();
  }
  void end(const std::optional<std::string>& trouble, std::uint64_t lost, double seconds) {
    const int signal = interrupt_signal();
    recorder_->finish({{"status", trouble      ? *trouble
                                  : signal > 0 ? fmt::format("ended by signal {}", signal)
                                               : "complete"},
                       {"samples", fmt::format("{}", samples_)},
                       {"lost", fmt::format("{}", lost)},
                       {"seconds", fmt::format("{:.6f}", seconds)}});
    recorder_.reset();
    close_file();
    if (format_ == Format::kRosbag2) write_bag();
  }

  [[nodiscard]] const robot::CoverConfig& cover() const { return cover_; }
  [[nodiscard]] std::uint64_t samples() const { return samples_; }
  [[nodiscard]] const std::string& name() const { return file_->name(); }
  [[nodiscard]] int parts() const { return part_ + 1; }

 private:
  // touch.mcap; with --split, and in a bag of ROS 2, touch_0.mcap, touch_1.mcap …, as rosbag2 names them.
  [[nodiscard]] std::string part_path() const {
    if (!split_.is_set() && format_ != Format::kRosbag2) return path_;
    const std::filesystem::path path(path_);
    return (path.parent_path() / fmt::format("{}_{}{}", path.stem().string(), part_, path.extension().string()))
        .string();
  }
  [[nodiscard]] bool is_part_full() const {
    std::error_code none;
    const bool is_large = split_.bytes > 0 && std::filesystem::file_size(file_->name(), none) >= split_.bytes && !none;
    return is_large || (split_.link_us > 0 && bus_->now_us() - origin_.link_start_us >= split_.link_us);
  }
  // Each part is a whole recording, with the design and everything else that is needed to read it alone.
  void begin_next_part() {
    ++part_;
    recorder_->finish(
        {{"status", fmt::format("goes on in {}", std::filesystem::path(part_path()).filename().string())}});
    recorder_.reset();
    close_file();
    file_ = std::make_unique<recording::OutputFile>(part_path());
    origin_.link_start_us = bus_->now_us();
    origin_.unix_start_ns = bus_->unix_ns(origin_.link_start_us);
    begin();
  }

  void close_file() {
    file_->close();
    closed_.emplace_back(file_->name());
  }
  void write_bag() const {
    const auto hash = [](std::string_view type) {
      for (const bridge::RosType* known : bridge::all_types())
        if (known->message.name == type) return std::string(known->hash);
      return std::string();
    };
    write_file_atomically(closed_.front().parent_path() / "metadata.yaml",
                          recording::rosbag2_metadata(closed_, rosbag2_version_, hash));
  }

  const robot::CoverConfig& cover_;
  Format format_;
  std::string path_;
  Split split_;
  int rosbag2_version_;
  std::vector<std::filesystem::path> closed_;
  int part_ = 0;
  std::unique_ptr<recording::OutputFile> file_;
  // describe() sets this pointer.
  skin::LiveBus* bus_ = nullptr;
  skin::LiveCover* live_ = nullptr;
  recording::Origin origin_;
  std::unique_ptr<recording::Recorder> recorder_;
  std::uint64_t samples_ = 0;
  bool had_contacts_ = false;
};

// A bag of ROS 2 is a folder that does not exist yet, as `ros2 bag record` wants it too.
void make_bag_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_empty(folder, error))
    throw InputError(fmt::format(
        "{}: a bag of ROS 2 is a folder of its own, and this is there already; give a new name", folder.string()));
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(fmt::format("{}: cannot make the folder ({})", folder.string(), error.message()));
}

// Returns FOLDER/COVER.mcap for a robot; a cover whose controllers are on several buses has a file for each bus. A bag
// of ROS 2 is a folder for each of them.
std::string file_of(const Options& options, Format format, const robot::CoverConfig& cover,
                    const robot::BusConfig& bus) {
  const std::filesystem::path output(options.output);
  const bool divided = design::patches_of(cover.design) != design::patches_here(cover.design);
  const std::string name = cover.name + (divided && !cover.name.empty() ? "_" + bus.name : "");
  if (format == Format::kRosbag2) {
    const std::filesystem::path folder = name.empty() ? output : output / name;
    make_bag_folder(folder);
    return (folder / (folder.filename().string() + ".mcap")).string();
  }
  if (name.empty()) return options.output;
  return (output / fmt::format("{}.{}", name, kFormatNames.name(format))).string();
}

// Each bus has its recordings and their results.
class BusRecording {
 public:
  // Files are opened before anything is asked of the controllers.
  // `places`: indexed by cover; empty for a design file.
  // All covers are joined into the file `joint` at the end; an empty path disables this.
  BusRecording(const Options& options, const robot::BusConfig& site, Format format,
               const std::vector<CoverPlace>& places, std::string joint)
      : options_(options), site_(site), joint_(std::move(joint)) {
    for (const robot::CoverConfig& cover : site.covers) {
      if (!cover.chosen) continue;
      files_.push_back(std::make_unique<CoverFile>(cover, file_of(options, format, cover, site), format, options));
      if (!places.empty()) files_.back()->place(places.at(static_cast<std::size_t>(cover.cover)));
    }
  }

  void run(skin::LiveBus& bus, const ProgressSink& progress, const Output& output) {
    bus.find_controllers();
    bus.require_flashed();
    for (std::size_t c = 0; c < files_.size(); ++c) files_[c]->describe(bus, c, options_, output);
    start_us_ = bus.now_us();
    try {
      receive(bus, progress);
    } catch (const DeviceError& e) {
      if (!files_.front()->started()) throw;  // The recording had not started.
      trouble_ = e.what();
    }
    seconds_ = static_cast<double>(bus.now_us() - start_us_) * 1e-6;
    for (std::size_t c = 0; c < files_.size(); ++c)
      files_[c]->end(trouble_, reports_.empty() ? lost_ : reports_[c].total.lost(), seconds_);
  }

  // Adds the report of each cover; returns the exit status.
  int print_report(nlohmann::json& rows, Output& output) const {
    int status = trouble_ ? 3 : disk_.empty() ? 0 : 2;
    if (!disk_.empty()) output.say(disk_);
    for (std::size_t c = 0; c < files_.size(); ++c) {
      const CoverFile& file = *files_[c];
      nlohmann::json row = keys_of(site_, file.cover());
      row.update({{"samples", file.samples()}, {"lost", lost_}});
      if (!reports_.empty()) {
        for (const std::string& line : sentences(reports_[c])) output.say(prefix_of(file.cover()) + line);
        add_stream_keys(reports_[c], row);
        if (!reports_[c].complete()) status = std::max(status, 1);
      }
      row["seconds"] = seconds_;
      row["file"] = name_of(file);
      if (!options_.split.empty()) row["parts"] = file.parts();
      if (trouble_) row["ended_by"] = *trouble_;
      output.say(
          fmt::format("{} in {:.2f} s -> {}{}", counted(file.samples(), "module sample"), seconds_, name_of(file),
                      file.parts() > 1 ? fmt::format(" and {} before it", counted(file.parts() - 1, "file")) : ""));
      if (file.samples() == 0) {
        output.say(prefix_of(file.cover()) + "nothing was recorded: no module sent a sample; run triskin verify");
        status = std::max(status, 1);
      }
      rows.push_back(std::move(row));
    }
    return status;
  }
  // Returns nothing if the link worked.
  [[nodiscard]] std::optional<std::string> trouble() const {
    if (!trouble_) return std::nullopt;
    std::uint64_t samples = 0;
    for (const auto& file : files_) samples += file->samples();
    return fmt::format("{}; the recording ends here, with {} in {}{}", *trouble_, counted(samples, "sample"),
                       name_of(*files_.front()), files_.size() > 1 && joint_.empty() ? " and the files beside it" : "");
  }
  // Adds the recordings of this bus's covers to the parts of the joint file.
  void add_parts(std::vector<recording::JoinPart>& parts) const {
    for (const auto& file : files_)
      parts.push_back({std::filesystem::path(file->name()).stem().string(), file->name()});
  }

 private:
  [[nodiscard]] const std::string& name_of(const CoverFile& file) const {
    return joint_.empty() ? file.name() : joint_;
  }
  void receive(skin::LiveBus& bus, const ProgressSink& progress) {
    bus.start(speaking(options_.stream),
              [&](const skin::LiveSample& s) { files_[static_cast<std::size_t>(s.cover)]->add(s); });
    for (const auto& file : files_) file->begin();
    skin::LiveRun run;
    run.until_us = start_us_ + static_cast<std::uint64_t>(options_.seconds * 1e6);
    run.slice_us = kSlice_us;
    run.after_slice = [&] {
      for (const auto& file : files_) file->slice();
      triskin::report(progress, "recording",
                      static_cast<double>(bus.now_us() - start_us_) / static_cast<double>(run.until_us - start_us_),
                      site_.name, site_.name.empty() ? -1 : site_.number);
      lost_ = bus.totals().lost;
      const std::uintmax_t free_bytes = free_beside(files_.front()->name());
      if (free_bytes >= kKeptFree_bytes) return true;
      disk_ = fmt::format(
          "{}: the disk has only {:.1f} MB left: the recording ends here, closed and whole; free some "
          "space",
          files_.front()->name(), static_cast<double>(free_bytes) * 1e-6);
      return false;
    };
    bus.run(run);
    bus.finish();
    for (std::size_t c = 0; c < files_.size(); ++c) reports_.push_back(bus.report(c));
    lost_ = bus.totals().lost;
  }

  const Options& options_;
  const robot::BusConfig& site_;
  std::string joint_;
  std::vector<std::unique_ptr<CoverFile>> files_;
  std::vector<session::StreamReport> reports_;
  std::uint64_t start_us_ = 0, lost_ = 0;
  std::optional<std::string> trouble_;
  std::string disk_;  // Why the recording ended before the disk was full.
  double seconds_ = 0.0;
};

void require_modules(const robot::Site& site) {
  for (const robot::BusConfig& bus : site.buses) {
    for (const robot::CoverConfig& cover : bus.covers) {
      if (cover.design.layout.modules.empty())
        throw InputError(
            fmt::format("{}: the design has no modules: there is nothing to record", cover.design_file.string()));
    }
  }
}

// Fails early, before the hardware is used.
void require_hdf5(const std::string& path) {
  if (!hdf5::can_write())
    throw InputError(
        "--format hdf5: this triskin was built without HDF5; install the package libhdf5-dev and build again, or "
        "record to "
        "mcap or csv");
  std::error_code none;
  if (path == "-" || (std::filesystem::exists(path, none) && std::filesystem::is_other(path, none)))
    throw InputError(
        fmt::format("{}: HDF5 writes at any place of a file, a pipe or device cannot; record to mcap or csv", path));
}

void require_split(const Options& options, bool is_robot) {
  if (!split_of(options.split).is_set()) return;
  std::error_code none;
  const bool is_special = options.output == "-" || (std::filesystem::exists(options.output, none) &&
                                                    std::filesystem::is_other(options.output, none));
  if (is_special) throw InputError("--split: standard output, a pipe or a device is one file; give -o FILE");
  if (is_robot && extension_of(options.output) == ".mcap")
    throw InputError("--split: of a robot the files of its covers are divided; give -o FOLDER");
}

void make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error || !std::filesystem::is_directory(path))
    throw InputError(fmt::format("{}: a robot is recorded into a folder, and this cannot be one{}; give another name",
                                 path, error ? ": " + error.message() : ""));
}

// Each cover is recorded into a file of its own beside the joint file, so that nothing is lost if the program is
// killed; the joint file is written from them at the end.
class JointFile {
 public:
  explicit JointFile(const std::string& path) : folder_(path + ".covers"), file_(path) { make_folder(folder_); }
  // The folder is empty if the recording never began.
  ~JointFile() {
    std::error_code ignored;
    std::filesystem::remove(folder_, ignored);
  }
  JointFile(const JointFile&) = delete;
  JointFile& operator=(const JointFile&) = delete;
  [[nodiscard]] const std::string& folder() const { return folder_; }
  [[nodiscard]] const std::string& name() const { return file_.name(); }
  void take(const std::vector<recording::JoinPart>& parts) {
    recording::join(parts, file_);
    file_.close();
    for (const recording::JoinPart& part : parts) std::filesystem::remove(part.path);
  }

 private:
  std::string folder_;
  recording::OutputFile file_;
};

void sum_up(nlohmann::json covers, Output& output) {
  std::uint64_t samples = 0, lost = 0;
  for (const auto& row : covers) {
    samples += row["samples"].get<std::uint64_t>();
    lost += row["lost"].get<std::uint64_t>();
  }
  output.result = {{"samples", samples}, {"lost", lost}, {"covers", std::move(covers)}};
  output.say(fmt::format("{} of {}, {} lost", counted(samples, "module sample"),
                         counted(output.result["covers"].size(), "cover"), lost));
}

int conclude_all(const std::vector<std::unique_ptr<BusRecording>>& buses, bool is_robot, Output& output) {
  nlohmann::json covers = nlohmann::json::array();
  int status = 0;
  std::string trouble;
  for (const auto& bus : buses) {
    status = std::max(status, bus->print_report(covers, output));
    if (const auto t = bus->trouble()) trouble += (trouble.empty() ? "" : "\n") + *t;
  }
  if (is_robot)
    sum_up(std::move(covers), output);
  else
    output.result = std::move(covers[0]);
  if (!trouble.empty()) throw DeviceError(trouble);
  if (interrupt_signal() > 0) output.say("stopped early; the file holds what arrived until then");
  return status;
}

int run(Options options, Output& output) {
  robot::Site site = read_site(options.site);
  const Format format = format_of(options, site.is_robot);
  require_modules(site);
  if (format == Format::kHdf5) require_hdf5(options.output);
  require_split(options, site.is_robot);
  // A shell completes the name of a folder with a slash, behind which there is no name.
  while (format == Format::kRosbag2 && options.output.size() > 1 && options.output.ends_with('/'))
    options.output.pop_back();
  std::optional<JointFile> joint;
  if (site.is_robot && extension_of(options.output) == ".mcap") {
    joint.emplace(options.output);
    options.output = joint->folder();
  } else if (site.is_robot) {
    make_folder(options.output);
  }
  if (!site.is_robot) connect::require_link(options.site.link);
  std::vector<CoverPlace> places;
  if (site.is_robot) places = places_of(robot::read_assembly(options.site.file));
  skin::LiveSkin skin(std::move(site), options.site.link);
  std::vector<std::unique_ptr<BusRecording>> buses;
  for (const robot::BusConfig& bus : skin.site().buses)
    buses.push_back(std::make_unique<BusRecording>(options, bus, format, places, joint ? joint->name() : ""));
  open_links(skin, output);
  const ProgressSink progress = output.progress();
  skin.on_each_bus([&](skin::LiveBus& bus) { buses[bus.index()]->run(bus, progress, output); });
  if (joint) {
    std::vector<recording::JoinPart> parts;
    for (const auto& bus : buses) bus->add_parts(parts);
    joint->take(parts);
  }
  return conclude_all(buses, skin.site().is_robot, output);
}

const Registration kRecord{{
    "record",
    "write every sample with its time and validity to a file, as it comes",
    "triskin record forearm.json --link sim -o touch.mcap --seconds 5",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("-o,--output", options->output,
                     "file.mcap (docs/recording.md), file.csv or file.h5; of a robot a folder, with a file for each "
                     "cover, or file.mcap, which holds all of them for viewers; for rosbag2 a new folder")
          ->required();
      app.add_option("--format", options->to, "format; default: by the extension of -o")
          ->check(CLI::IsMember({"mcap", "csv", "hdf5", "rosbag2"}));
      app.add_option("--rosbag2-version", options->rosbag2_version,
                     "version of metadata.yaml: 5 is read by ROS 2 from Humble on, 9 is that of Jazzy")
          ->check(CLI::Range(recording::kMinRosbag2Version, recording::kMaxRosbag2Version))
          ->capture_default_str();
      add_site_options(app, options->site);
      add_stream_options(app, options->stream);
      add_calibration_options(app, options->calibration);
      app.add_option("--seconds", options->seconds, "of the link's time")
          ->check(CLI::Range(0.0, 1e6))
          ->capture_default_str();
      app.add_option(
          "--split", options->split,
          "files NAME_0, NAME_1 … (as rosbag2 names them), a new one after this size or time (200MB, 10min); "
          "each can be read alone");
      app.add_option("--cloud-hz", options->cloud_hz, "mcap: points with their values, so often (0: none)")
          ->check(CLI::Range(0.0, 100.0))
          ->capture_default_str();
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kData,
}};

}  // namespace
}  // namespace triskin::cli::record_command
