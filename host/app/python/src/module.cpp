// SPDX-License-Identifier: GPL-3.0-or-later
// The Python module triskin wraps triskin.h as a class, with numpy arrays. It uses only the C interface.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/triskin.h"

namespace py = pybind11;

namespace {

struct BadInput : std::runtime_error {
  using std::runtime_error::runtime_error;
};
struct DeviceFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// An error may quote bytes of a file that are not valid text; Python would then discard the whole message.
std::string text_of_error() {
  const char* const bytes = triskin_error();
  const auto text = py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(bytes, static_cast<Py_ssize_t>(std::strlen(bytes)), "backslashreplace"));
  return text ? text.cast<std::string>() : "an error without text";
}

void check(triskin_status status) {
  if (status == TRISKIN_OK) return;
  if (status == TRISKIN_BAD_INPUT) throw BadInput(text_of_error());
  throw DeviceFailed(text_of_error());
}

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Each taxel has its counts for 1 kPa, and each module the area of skin that a taxel represents.
struct Calibration {
  py::array_t<double> counts_per_kpa, taxel_area_mm2;
  bool known = false;
};

// Computes the pressure of the last two axes (modules, 12); NaN where a taxel has no calibration.
py::array_t<double> pressure_of(const Doubles& change, const Calibration& calibration) {
  if (!calibration.known)
    throw BadInput(
        "there is no calibration, so counts cannot be told in kPa; run triskin calibrate, or read change_counts()");
  py::array_t<double> kpa(std::vector<py::ssize_t>(change.shape(), change.shape() + change.ndim()));
  const double* const counts = calibration.counts_per_kpa.data();
  double* const out = kpa.mutable_data();
  for (py::ssize_t n = 0; n < change.size(); ++n)
    out[n] = counts[n] > 0.0 ? change.data()[n] / counts[n] : std::numeric_limits<double>::quiet_NaN();
  return kpa;
}

py::list contacts_of(const py::array_t<double>& places, const py::array_t<double>& normals, const Doubles& change,
                     const Calibration& calibration) {
  const auto modules = static_cast<std::size_t>(places.size()) / (3 * TRISKIN_TAXELS);
  if (static_cast<std::size_t>(change.size()) != modules * TRISKIN_TAXELS)
    throw BadInput("contacts: change has to have the shape (modules, 12)");
  std::vector<triskin_contact> found(modules * TRISKIN_TAXELS);
  std::size_t count = 0;
  check(triskin_contacts(
      places.data(), normals.data(), change.data(), calibration.known ? calibration.counts_per_kpa.data() : nullptr,
      calibration.known ? calibration.taxel_area_mm2.data() : nullptr, modules, found.data(), found.size(), &count));
  py::list list;
  for (std::size_t k = 0; k < count; ++k) {
    const triskin_contact& c = found[k];
    list.append(py::dict(py::arg("position_mm") = py::array_t<double>(3, c.position_mm),
                         py::arg("normal") = py::array_t<double>(3, c.normal),
                         py::arg("change_counts") = c.change_counts, py::arg("force_n") = c.force_n,
                         py::arg("area_mm2") = c.area_mm2, py::arg("module") = c.module, py::arg("taxel") = c.taxel,
                         py::arg("taxels") = c.taxels, py::arg("position_sd_mm") = c.position_sd_mm,
                         py::arg("force_sd_n") = c.force_sd_n));
  }
  return list;
}

class Skin {
 public:
  Skin(const std::string& file, const std::string& link, const std::string& scene, int every, bool overload,
       double queue_s) {
    triskin_options options = TRISKIN_OPTIONS_INIT;
    options.link = link.empty() ? nullptr : link.c_str();
    options.scene = scene.empty() ? nullptr : scene.c_str();
    options.every = every;
    options.overload = overload ? 1 : 0;
    options.queue_s = queue_s;
    check(without_python([&] { return triskin_open(file.c_str(), &options, &skin_); }));
    modules_ = triskin_module_count(skin_);
  }
  ~Skin() { close(); }
  Skin(const Skin&) = delete;
  Skin& operator=(const Skin&) = delete;

  void close() {
    const Turn turn(*this);
    if (skin_ == nullptr) return;
    triskin_skin* skin = std::exchange(skin_, nullptr);
    const py::gil_scoped_release released;
    triskin_close(skin);
  }

  [[nodiscard]] std::size_t modules() const { return modules_; }
  [[nodiscard]] py::array_t<double> positions_mm() const {
    const Turn turn(*this);
    py::array_t<double> out({modules_, std::size_t{TRISKIN_TAXELS}, std::size_t{3}});
    check(triskin_positions_mm(open(), out.mutable_data(), static_cast<std::size_t>(out.size())));
    return out;
  }
  [[nodiscard]] py::array_t<double> normals() const {
    const Turn turn(*this);
    py::array_t<double> out({modules_, std::size_t{TRISKIN_TAXELS}, std::size_t{3}});
    check(triskin_normals(open(), out.mutable_data(), static_cast<std::size_t>(out.size())));
    return out;
  }
  [[nodiscard]] py::array_t<std::int32_t> numbers() const {
    const Turn turn(*this);
    py::array_t<std::int32_t> out(static_cast<py::ssize_t>(modules_));
    check(triskin_module_numbers(open(), out.mutable_data(), modules_));
    return out;
  }
  [[nodiscard]] py::array_t<std::int32_t> patches() const {
    const Turn turn(*this);
    py::array_t<std::int32_t> out(static_cast<py::ssize_t>(modules_));
    check(triskin_patches(open(), out.mutable_data(), modules_));
    return out;
  }
  [[nodiscard]] py::array_t<std::int32_t> cover() const {
    const Turn turn(*this);
    py::array_t<std::int32_t> out(static_cast<py::ssize_t>(modules_));
    check(triskin_covers(open(), out.mutable_data(), modules_));
    return out;
  }
  [[nodiscard]] std::vector<std::string> covers() const {
    const Turn turn(*this);
    std::vector<std::string> names;
    for (std::size_t c = 0; c < triskin_cover_count(open()); ++c) names.emplace_back(triskin_cover_name(open(), c));
    return names;
  }
  void start() {
    const Turn turn(*this);
    check(without_python([this] { return triskin_start(open()); }));
    runs_ = true;
    fresh_ = false;
  }
  void stop() {
    const Turn turn(*this);
    check(without_python([this] { return triskin_stop(open()); }));
    runs_ = false;
  }

  py::array_t<triskin_sample> read(double seconds) {
    if (!(seconds >= 0.0) || !std::isfinite(seconds)) throw BadInput("read: seconds must be 0 or more, and finite");
    const Turn turn(*this);
    constexpr double kSlice_s = 0.05;
    constexpr double kMinRest_s = 1e-5;  // Seconds since 1970 have a resolution of 0.24 µs, and links count whole µs.
    std::vector<triskin_sample> all = std::exchange(kept_, {});
    start_if_fresh();
    const double end_s = triskin_now_s(open()) + seconds;
    double rest_s = seconds;
    do {
      take(std::clamp(rest_s, 0.0, kSlice_s), all);
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      rest_s = end_s - triskin_now_s(open());
    } while (rest_s > kMinRest_s);
    py::array_t<triskin_sample> out(static_cast<py::ssize_t>(all.size()));
    std::ranges::copy(all, out.mutable_data());
    return out;
  }

  [[nodiscard]] py::dict counts() {
    const Turn turn(*this);
    triskin_counts c{};
    check(triskin_get_counts(open(), &c));
    return py::dict(py::arg("expected") = c.expected, py::arg("received") = c.received, py::arg("lost") = c.lost,
                    py::arg("lost_here") = c.lost_here);
  }
  void tare() {
    const Turn turn(*this);
    check(without_python([this] { return triskin_tare(open()); }));
    runs_ = true;
    fresh_ = false;
  }
  [[nodiscard]] py::array_t<double> change_counts() {
    const Turn turn(*this);
    py::array_t<double> out({modules_, std::size_t{TRISKIN_TAXELS}});
    check(triskin_change_counts(open(), out.mutable_data(), static_cast<std::size_t>(out.size())));
    return out;
  }
  // Returns None if a module has no calibration.
  [[nodiscard]] py::object calibration() {
    const Turn turn(*this);
    const Calibration& known = asked();
    if (!known.known) return py::none();
    return py::make_tuple(known.counts_per_kpa, known.taxel_area_mm2);
  }
  [[nodiscard]] py::array_t<double> pressure_kpa() {
    const Turn turn(*this);
    return pressure_of(change_counts(), asked());
  }
  [[nodiscard]] py::list contacts() {
    const Turn turn(*this);
    return contacts_of(positions_mm(), normals(), change_counts(), asked());
  }
  [[nodiscard]] std::pair<bool, std::string> verify() {
    const Turn turn(*this);
    const Pause pause(*this);
    const char* report = "";
    const triskin_status status = without_python([&] { return triskin_verify(open(), &report); });
    if (status != TRISKIN_BAD_ANSWER) check(status);
    return {status == TRISKIN_OK, report};
  }

 private:
  // The C interface takes one thread at a time, so each call waits until those of other threads are done. It waits
  // without the lock of Python, which those need to end, and in steps, so that Ctrl-C ends it.
  class Turn {
   public:
    explicit Turn(const Skin& skin) : mutex_(skin.mutex_) {
      while (!locked_in_time()) {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      }
    }
    ~Turn() { mutex_.unlock(); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    [[nodiscard]] bool locked_in_time() {
      const py::gil_scoped_release released;
      return mutex_.try_lock_for(std::chrono::milliseconds(50));
    }
    std::recursive_timed_mutex& mutex_;
  };

  // A question to the controllers needs a stopped stream. The stream continues afterwards, and waiting samples are
  // kept.
  class Pause {
   public:
    explicit Pause(Skin& skin) : skin_(skin), ran_(skin.runs_) {
      if (!ran_) return;
      skin_.stop();
      skin_.take(0.0, skin_.kept_);
    }
    ~Pause() {
      if (ran_ && triskin_start(skin_.skin_) == TRISKIN_OK) skin_.runs_ = true;
    }
    Pause(const Pause&) = delete;
    Pause& operator=(const Pause&) = delete;

   private:
    Skin& skin_;
    bool ran_;
  };

  // The controllers are asked only once.
  [[nodiscard]] const Calibration& asked() {
    if (calibration_) return *calibration_;
    const Pause pause(*this);
    Calibration c{py::array_t<double>({modules_, std::size_t{TRISKIN_TAXELS}}),
                  py::array_t<double>(static_cast<py::ssize_t>(modules_)), false};
    double *const counts = c.counts_per_kpa.mutable_data(), *const area = c.taxel_area_mm2.mutable_data();
    const auto size = static_cast<std::size_t>(c.counts_per_kpa.size());
    const triskin_status status = without_python([&] { return triskin_calibration(open(), counts, area, size); });
    if (status != TRISKIN_BAD_ANSWER) check(status);
    c.known = status == TRISKIN_OK;
    return calibration_.emplace(std::move(c));
  }
  // The first read() starts the stream; after stop() it returns waiting samples.
  void start_if_fresh() {
    if (fresh_) start();
  }
  template <class Work>
  static triskin_status without_python(Work work) {
    const py::gil_scoped_release released;
    return work();
  }
  [[nodiscard]] triskin_skin* open() const {
    if (skin_ == nullptr) throw BadInput("the skin is closed");
    return skin_;
  }
  void take(double wait_s, std::vector<triskin_sample>& all) {
    constexpr std::size_t kAtOnce = 8192;
    std::size_t count = kAtOnce;
    for (double wait = wait_s; count == kAtOnce; wait = 0.0) {
      const std::size_t at = all.size();
      all.resize(at + kAtOnce);
      const triskin_status status =
          without_python([&] { return triskin_read(open(), wait, all.data() + at, kAtOnce, &count); });
      all.resize(at + (status == TRISKIN_OK ? count : 0));
      check(status);
    }
  }
  mutable std::recursive_timed_mutex mutex_;  // Calls use each other.
  triskin_skin* skin_ = nullptr;
  std::size_t modules_ = 0;
  std::vector<triskin_sample> kept_;  // These samples were waiting when a question stopped the stream.
  std::optional<Calibration> calibration_;
  bool runs_ = false;
  bool fresh_ = true;  // True means that the stream was never started.
};

// A recording has all of its samples in memory.
class Recording {
 public:
  explicit Recording(const std::string& file) {
    triskin_recording* recording = nullptr;
    triskin_status status = TRISKIN_OK;
    {
      const py::gil_scoped_release released;
      status = triskin_recording_open(file.c_str(), &recording);
    }
    check(status);
    const std::unique_ptr<triskin_recording, void (*)(triskin_recording*)> open(recording, triskin_recording_close);
    name = triskin_recording_name(recording);
    simulated = triskin_recording_is_simulated(recording) != 0;
    modules = triskin_recording_module_count(recording);
    const std::size_t taxels = TRISKIN_TAXELS, count = triskin_recording_sample_count(recording);
    positions_mm = py::array_t<double>({modules, taxels, std::size_t{3}});
    normals = py::array_t<double>({modules, taxels, std::size_t{3}});
    patches = py::array_t<std::int32_t>(static_cast<py::ssize_t>(modules));
    check(triskin_recording_geometry(recording, positions_mm.mutable_data(), normals.mutable_data(),
                                     patches.mutable_data(), static_cast<std::size_t>(positions_mm.size())));
    numbers = py::array_t<std::int32_t>(static_cast<py::ssize_t>(modules));
    check(triskin_recording_module_numbers(recording, numbers.mutable_data(), modules));
    samples = py::array_t<triskin_sample>(static_cast<py::ssize_t>(count));
    change = py::array_t<double>({count, taxels});
    check(triskin_recording_samples(recording, samples.mutable_data(), change.mutable_data(), count));
    calibration_ = {py::array_t<double>({modules, taxels}), py::array_t<double>(static_cast<py::ssize_t>(modules)),
                    false};
    const triskin_status known =
        triskin_recording_calibration(recording, calibration_.counts_per_kpa.mutable_data(),
                                      calibration_.taxel_area_mm2.mutable_data(), modules * taxels);
    if (known != TRISKIN_BAD_ANSWER) check(known);
    calibration_.known = known == TRISKIN_OK;
  }

  // Returns the latest sample of each module at a time in s since the first sample; without a time, at the end.
  [[nodiscard]] py::array_t<double> change_counts(const std::optional<double>& seconds) const {
    py::array_t<double> now({modules, std::size_t{TRISKIN_TAXELS}});
    std::fill_n(now.mutable_data(), now.size(), 0.0);
    if (seconds && !(*seconds >= 0.0)) throw BadInput("seconds must be 0 or more, or None for the end");
    if (samples.size() == 0) return now;
    const double end_s = seconds ? samples.data()[0].time_s + *seconds : std::numeric_limits<double>::infinity();
    for (py::ssize_t k = 0; k < samples.size(); ++k) {
      const triskin_sample& s = samples.data()[k];
      if (s.time_s <= end_s) std::copy_n(change.data() + TRISKIN_TAXELS * k, TRISKIN_TAXELS, row(now, s.module));
    }
    return now;
  }
  [[nodiscard]] py::array_t<double> pressure_kpa(const std::optional<double>& seconds) const {
    return pressure_of(change_counts(seconds), calibration_);
  }
  [[nodiscard]] py::list contacts(const std::optional<double>& seconds) const {
    return contacts_of(positions_mm, normals, change_counts(seconds), calibration_);
  }
  [[nodiscard]] py::object calibration() const {
    if (!calibration_.known) return py::none();
    return py::make_tuple(calibration_.counts_per_kpa, calibration_.taxel_area_mm2);
  }

  std::string name;
  bool simulated = false;
  std::size_t modules = 0;
  py::array_t<double> positions_mm, normals, change;
  py::array_t<std::int32_t> patches, numbers;
  py::array_t<triskin_sample> samples;

 private:
  static double* row(py::array_t<double>& table, std::int32_t module) {
    return table.mutable_data() + static_cast<std::ptrdiff_t>(TRISKIN_TAXELS) * module;
  }
  Calibration calibration_;
};

// The first bytes decide, whatever the name of the file is.
bool is_recording(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 5> magic{};
  in.read(magic.data(), magic.size());
  return in && std::string_view(magic.data(), magic.size()) == "\x89MCAP";
}

// The name of a file as Python gives it: text, bytes or os.PathLike.
std::string path_of(const py::object& path) {
  std::string file = py::cast<std::string>(py::module_::import("os").attr("fsencode")(path));
  if (file.empty()) throw BadInput("the name of the file is empty");
  if (file.find('\0') != std::string::npos) throw BadInput("the name of the file contains a null character");
  return file;
}
// The same of what is read: a pipe or a device may never end.
std::string file_of(const py::object& path) {
  std::string file = path_of(path);
  std::error_code none;
  if (std::filesystem::exists(file, none) && !std::filesystem::is_regular_file(file, none))
    throw BadInput(file + ": is a folder, a pipe or a device; give a recording, a design or a robot file");
  return file;
}
std::string path_or_none(const py::object& path) {
  return path.is_none() ? std::string() : path_of(path);
}

py::object open_file(const py::object& path, const std::optional<std::string>& link_or_none,
                     const py::object& scene_path, int every, bool overload, double queue_s) {
  const std::string file = file_of(path), link = link_or_none.value_or(""), scene = path_or_none(scene_path);
  if (!is_recording(file)) return py::cast(std::make_unique<Skin>(file, link, scene, every, overload, queue_s));
  if (!link.empty() || !scene.empty())
    throw BadInput(file +
                   ": is a recording, which has no link and no scene; open it by its name alone, or play it into "
                   "a link with triskin replay --listen");
  return py::cast(std::make_unique<Recording>(file));
}

std::unique_ptr<Recording> read_recording(const py::object& path) {
  return std::make_unique<Recording>(file_of(path));
}

std::unique_ptr<Skin> simulate(const py::object& path, const py::object& scene, int every) {
  const std::string file = file_of(path);
  triskin_status status = TRISKIN_OK;
  {
    const py::gil_scoped_release released;
    status = triskin_flash_simulation(file.c_str());
  }
  check(status);
  return std::make_unique<Skin>(file, "sim", path_or_none(scene), every, false, 10.0);
}

void add_skin(py::module_& m) {
  py::class_<Skin>(
      m, "Skin",
      "The skin of a design or of a robot. Use triskin.open. Threads may share it: their calls are taken one after "
      "the other, so each waits for those before it, a read for all of its seconds.")
      .def("close", &Skin::close, "Ends the stream and the link.")
      .def(
          "__enter__", [](Skin& s) -> Skin& { return s; }, py::return_value_policy::reference)
      .def("__exit__", [](Skin& s, const py::args&) { s.close(); })
      .def_property_readonly("modules", &Skin::modules, "Number of modules.")
      .def_property_readonly("positions_mm", &Skin::positions_mm,
                             "Place of each taxel, (modules, 12, 3), mm, frame of the mesh or of the robot's base.")
      .def_property_readonly("normals", &Skin::normals, "Outward unit normal of each taxel, (modules, 12, 3).")
      .def_property_readonly("numbers", &Skin::numbers,
                             "Number of each module, (modules,): what its label, files and reports say.")
      .def_property_readonly("patches", &Skin::patches, "Patch of each module, (modules,); -1: none.")
      .def_property_readonly("covers", &Skin::covers, "Names of the covers; of a design one.")
      .def_property_readonly("cover", &Skin::cover, "Which of the covers each module is on, (modules,).")
      .def("start", &Skin::start, "Begins to receive: samples wait for read().")
      .def("stop", &Skin::stop, "Ends the stream; what waits can still be read.")
      .def("read", &Skin::read, py::arg("seconds") = 0.0,
           "All samples that come within `seconds`, oldest first: a structured array with the fields time_s, error_s, "
           "device_time_us, number, module (index, as of all arrays), node, valid (bits) and value (12 counts). Starts "
           "the stream if need be.")
      .def("counts", &Skin::counts, "Samples since start(): expected, received, lost, lost_here.")
      .def("tare", &Skin::tare, "Takes the present values for those of a skin that nobody touches.")
      .def("change_counts", &Skin::change_counts, "Counts below rest, (modules, 12): more is more pressure.")
      .def("calibration", &Skin::calibration,
           "Counts for 1 kPa of each taxel, (modules, 12), and the skin that a taxel of each module stands for, mm2, "
           "(modules,); None where a module has no calibration. The controllers are asked once; a stream that runs "
           "pauses for that.")
      .def("pressure_kpa", &Skin::pressure_kpa,
           "Pressure of each taxel, (modules, 12), kPa; NaN where a taxel has no calibration. Raises BadInput without "
           "one.")
      .def("contacts", &Skin::contacts,
           "Regions under pressure, the strongest first: dicts with position_mm, normal, change_counts, force_n (NaN "
           "without calibration), area_mm2, module (index), taxel (the strongest) and taxels (how many).")
      .def("verify", &Skin::verify,
           "Whether the hardware is the design, and the report as text. A stream that runs pauses for that.")
      .def("__repr__", [](const Skin& s) { return "<triskin.Skin of " + std::to_string(s.modules()) + " modules>"; });
}

void add_recording(py::module_& m) {
  py::class_<Recording>(m, "Recording", "A recording (.mcap), whole in memory. Use triskin.open.")
      .def_readonly("modules", &Recording::modules, "Number of modules.")
      .def_readonly("name", &Recording::name, "Name of the cover, or of the design.")
      .def_readonly("simulated", &Recording::simulated, "Whether the samples are of a simulation.")
      .def_readonly("positions_mm", &Recording::positions_mm, "Place of each taxel, (modules, 12, 3), mm.")
      .def_readonly("normals", &Recording::normals, "Outward unit normal of each taxel, (modules, 12, 3).")
      .def_readonly("numbers", &Recording::numbers, "Number of each module, (modules,), as of Skin.")
      .def_readonly("patches", &Recording::patches, "Patch of each module, (modules,); -1: none.")
      .def_readonly("samples", &Recording::samples, "All samples, as Skin.read gives them.")
      .def_readonly("change", &Recording::change, "Counts below rest of each sample, (samples, 12).")
      .def("change_counts", &Recording::change_counts, py::arg("seconds") = py::none(),
           "Counts below rest, (modules, 12), so many seconds after the first sample; None: at the end.")
      .def("pressure_kpa", &Recording::pressure_kpa, py::arg("seconds") = py::none(), "The same in kPa.")
      .def("contacts", &Recording::contacts, py::arg("seconds") = py::none(), "Regions under pressure at that time.")
      .def("calibration", &Recording::calibration, "As Skin.calibration, of the calibration in the file.")
      .def(
          "__enter__", [](Recording& r) -> Recording& { return r; }, py::return_value_policy::reference)
      .def("__exit__", [](Recording&, const py::args&) {})
      .def("__repr__", [](const Recording& r) {
        return "<triskin.Recording of " + r.name + ": " + std::to_string(r.modules) + " modules, " +
               std::to_string(py::len(r.samples)) + (r.simulated ? " samples of a simulation>" : " samples>");
      });
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  m.doc() = "Samples of robot skin as numpy arrays (docs/library.md).";
  m.attr("__version__") = triskin_version();
  PYBIND11_NUMPY_DTYPE(triskin_sample, time_s, error_s, device_time_us, number, module, node, valid, value);
  py::register_exception<BadInput>(m, "BadInput", PyExc_ValueError);
  py::register_exception<DeviceFailed>(m, "DeviceFailed", PyExc_OSError);
  add_skin(m);
  add_recording(m);
  m.def("open", &open_file, py::arg("file"), py::kw_only(), py::arg("link") = py::none(), py::arg("scene") = py::none(),
        py::arg("every") = 0, py::arg("overload") = false, py::arg("queue_s") = 10.0,
        "Opens the skin of a design file or of a robot file, or a recording (.mcap). link: as --link of the program; "
        "None: of a robot what its file names, and refused for a design. Raises BadInput, DeviceFailed.");
  m.def("read", &read_recording, py::arg("file"),
        "Reads a recording (.mcap) whole into memory: arrays, and to_dataframe(). Raises BadInput for a file that is "
        "none.");
  m.def("simulate", &simulate, py::arg("file"), py::kw_only(), py::arg("scene") = py::none(), py::arg("every") = 0,
        "Opens the skin of a design on simulated boards, which get its tables first. scene: file of what touches it. "
        "Raises BadInput, DeviceFailed.");
}
