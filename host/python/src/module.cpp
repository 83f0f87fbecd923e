// SPDX-License-Identifier: GPL-3.0-or-later
// The Python module triskin: triskin.h as a class, with numpy arrays. It uses nothing but the C interface.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
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

void check(triskin_status status) {
  if (status == TRISKIN_OK) return;
  if (status == TRISKIN_BAD_INPUT) throw BadInput(triskin_error());
  throw DeviceFailed(triskin_error());
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
    if (skin_ == nullptr) return;
    triskin_skin* skin = std::exchange(skin_, nullptr);
    const py::gil_scoped_release released;
    triskin_close(skin);
  }

  [[nodiscard]] std::size_t modules() const { return modules_; }
  [[nodiscard]] py::array_t<double> positions_mm() const {
    py::array_t<double> out({modules_, std::size_t{TRISKIN_TAXELS}, std::size_t{3}});
    check(triskin_positions_mm(open(), out.mutable_data(), static_cast<std::size_t>(out.size())));
    return out;
  }
  [[nodiscard]] py::array_t<double> normals() const {
    py::array_t<double> out({modules_, std::size_t{TRISKIN_TAXELS}, std::size_t{3}});
    check(triskin_normals(open(), out.mutable_data(), static_cast<std::size_t>(out.size())));
    return out;
  }
  [[nodiscard]] py::array_t<std::int32_t> patches() const {
    py::array_t<std::int32_t> out(static_cast<py::ssize_t>(modules_));
    check(triskin_patches(open(), out.mutable_data(), modules_));
    return out;
  }
  [[nodiscard]] py::array_t<std::int32_t> cover() const {
    py::array_t<std::int32_t> out(static_cast<py::ssize_t>(modules_));
    check(triskin_covers(open(), out.mutable_data(), modules_));
    return out;
  }
  [[nodiscard]] std::vector<std::string> covers() const {
    std::vector<std::string> names;
    for (std::size_t c = 0; c < triskin_cover_count(open()); ++c) names.emplace_back(triskin_cover_name(open(), c));
    return names;
  }
  void start() {
    check(without_python([this] { return triskin_start(open()); }));
  }
  void stop() {
    check(without_python([this] { return triskin_stop(open()); }));
  }

  py::array_t<triskin_sample> read(double seconds) {
    constexpr double kSlice_s = 0.05;
    constexpr double kLeast_s = 1e-5;  // Seconds since 1970 are no finer than 0.24 µs, and links count whole µs.
    std::vector<triskin_sample> all;
    const double end_s = triskin_now_s(open()) + seconds;
    double rest_s = seconds;
    do {
      take(std::clamp(rest_s, 0.0, kSlice_s), all);
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      rest_s = end_s - triskin_now_s(open());
    } while (rest_s > kLeast_s);
    py::array_t<triskin_sample> out(static_cast<py::ssize_t>(all.size()));
    std::ranges::copy(all, out.mutable_data());
    return out;
  }

  [[nodiscard]] py::dict counts() {
    triskin_counts c{};
    check(triskin_get_counts(open(), &c));
    return py::dict(py::arg("expected") = c.expected, py::arg("received") = c.received, py::arg("lost") = c.lost,
                    py::arg("lost_here") = c.lost_here);
  }
  void tare() {
    check(without_python([this] { return triskin_tare(open()); }));
  }
  [[nodiscard]] py::array_t<double> change_counts() {
    py::array_t<double> out({modules_, std::size_t{TRISKIN_TAXELS}});
    check(triskin_change_counts(open(), out.mutable_data(), static_cast<std::size_t>(out.size())));
    return out;
  }
  // None: a module has no calibration.
  [[nodiscard]] py::object calibration() {
    py::array_t<double> counts({modules_, std::size_t{TRISKIN_TAXELS}});
    py::array_t<double> area(static_cast<py::ssize_t>(modules_));
    double *const counts_data = counts.mutable_data(), *const area_data = area.mutable_data();
    const auto size = static_cast<std::size_t>(counts.size());
    const triskin_status status =
        without_python([&] { return triskin_calibration(open(), counts_data, area_data, size); });
    if (status == TRISKIN_BAD_ANSWER) return py::none();
    check(status);
    return py::make_tuple(counts, area);
  }
  [[nodiscard]] std::pair<bool, std::string> verify() {
    const char* report = "";
    const triskin_status status = without_python([&] { return triskin_verify(open(), &report); });
    if (status != TRISKIN_BAD_ANSWER) check(status);
    return {status == TRISKIN_OK, report};
  }

 private:
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
  triskin_skin* skin_ = nullptr;
  std::size_t modules_ = 0;
};

}  // namespace

PYBIND11_MODULE(triskin, m) {
  m.doc() = "Samples of robot skin as numpy arrays (docs/library.md).";
  m.attr("__version__") = triskin_version();
  PYBIND11_NUMPY_DTYPE(triskin_sample, time_s, error_s, device_time_us, number, module, node, valid, value);
  py::register_exception<BadInput>(m, "BadInput", PyExc_ValueError);
  py::register_exception<DeviceFailed>(m, "DeviceFailed", PyExc_OSError);
  py::class_<Skin>(m, "Skin", "The skin of a design or of a robot. Use triskin.open.")
      .def("close", &Skin::close, "Ends the stream and the link.")
      .def(
          "__enter__", [](Skin& s) -> Skin& { return s; }, py::return_value_policy::reference)
      .def("__exit__", [](Skin& s, const py::args&) { s.close(); })
      .def_property_readonly("modules", &Skin::modules, "Number of modules.")
      .def_property_readonly("positions_mm", &Skin::positions_mm,
                             "Place of each taxel, (modules, 12, 3), mm, frame of the mesh or of the robot's base.")
      .def_property_readonly("normals", &Skin::normals, "Outward unit normal of each taxel, (modules, 12, 3).")
      .def_property_readonly("patches", &Skin::patches, "Patch of each module, (modules,); -1: none.")
      .def_property_readonly("covers", &Skin::covers, "Names of the covers; of a design one.")
      .def_property_readonly("cover", &Skin::cover, "Which of the covers each module is on, (modules,).")
      .def("start", &Skin::start, "Begins to receive: samples wait for read().")
      .def("stop", &Skin::stop, "Ends the stream; what waits can still be read.")
      .def("read", &Skin::read, py::arg("seconds") = 0.0,
           "All samples that come within `seconds`, oldest first: a structured array with the fields time_s, error_s, "
           "device_time_us, number, module, node, valid (bits) and value (12 counts). Starts the stream if need be.")
      .def("counts", &Skin::counts, "Samples since start(): expected, received, lost, lost_here.")
      .def("tare", &Skin::tare, "Takes the present values for those of a skin that nobody touches.")
      .def("change_counts", &Skin::change_counts, "Counts below rest, (modules, 12): more is more pressure.")
      .def("calibration", &Skin::calibration,
           "Counts for 1 kPa of each taxel, (modules, 12), and the skin that a taxel of each module stands for, mm2, "
           "(modules,); None where a module has no calibration. Stop the stream first.")
      .def("verify", &Skin::verify,
           "Whether the hardware is the design, and the report as text. Stop the stream first.");
  m.def(
      "open",
      [](const std::string& file, const std::string& link, const std::string& scene, int every, bool overload,
         double queue_s) { return std::make_unique<Skin>(file, link, scene, every, overload, queue_s); },
      py::arg("file"), py::kw_only(), py::arg("link") = "", py::arg("scene") = "", py::arg("every") = 0,
      py::arg("overload") = false, py::arg("queue_s") = 10.0,
      "Opens the skin of a design file or of a robot file. link: as --link of the program; empty: of a "
      "robot what its file names, and refused for a design. Raises BadInput, DeviceFailed.");
}
