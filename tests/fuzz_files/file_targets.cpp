// SPDX-License-Identifier: GPL-3.0-or-later
// Readers of files as fuzz targets. A file is either read or refused by an Error; anything else, such as an exception
// of a library, ends the program.
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "../fuzz/targets.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/check/placement_proof.hpp"
#include "triskin/deploy/board_backup.hpp"
#include "triskin/design/calibration.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/design_text.hpp"
#include "triskin/design/kinds.hpp"
#include "triskin/design/region_file.hpp"
#include "triskin/hardware/scene.hpp"
#include "triskin/robot/frames.hpp"
#include "triskin/robot/registration.hpp"
#include "triskin/robot/robot.hpp"

namespace triskin::fuzz {
namespace {

/// Gives inputs a path, one after the other. They stay in memory, because a disk would decide how many a second are
/// tried. Beside the file lies strip.json, a design of four modules for scenes and robots that name one.
class InputFile {
 public:
  InputFile() : descriptor_(memfd_create("input", 0)) {
    std::string name = (std::filesystem::temp_directory_path() / "fuzz_files.XXXXXX").string();
    require(descriptor_ >= 0 && mkdtemp(name.data()) != nullptr);
    folder_ = name;
    std::filesystem::create_symlink("/proc/self/fd/" + std::to_string(descriptor_), path());
    design::write_design(folder_ / "strip.json", test::strip(4));
  }
  ~InputFile() {
    std::filesystem::remove_all(folder_);
    ::close(descriptor_);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  void write(Bytes content) const {
    require(::ftruncate(descriptor_, 0) == 0 &&
            ::pwrite(descriptor_, content.data(), content.size(), 0) == std::ssize(content));
  }
  [[nodiscard]] std::filesystem::path path() const { return folder_ / "input"; }

 private:
  int descriptor_;
  std::filesystem::path folder_;
};

template <auto kRead>
void file(Bytes input) {
  static const InputFile in;
  in.write(input);
  try {
    kRead(in.path());
  } catch (const Error&) {
    return;  // The file was refused.
  }
}

/// Runs a reader that takes the text of a file.
template <auto kParse>
void text(Bytes input) {
  try {
    kParse(std::string(input.begin(), input.end()));
  } catch (const Error&) {
    return;  // The text was refused.
  }
}

constexpr auto kDesign = [](const std::string& t) { (void)design::parse_design(t, "design.json"); };
constexpr auto kRobot = [](const std::string& t) { (void)robot::parse_robot(t, "robot.json"); };
constexpr auto kUrdf = [](const std::string& t) { (void)robot::Frames::parse_urdf(t, "robot.urdf"); };
constexpr auto kTouches = [](const std::string& t) { (void)robot::read_touches(t, "touches.csv"); };
constexpr auto kCalibration = [](const std::string& t) { (void)design::parse_calibration(t, "calibration.json"); };
constexpr auto kCheck = [](const auto& path) { (void)check::check_design(path); };
constexpr auto kScene = [](const auto& path) { (void)hardware::read_scene(path); };
constexpr auto kBackup = [](const auto& path) { (void)deploy::read_backup(path); };
constexpr auto kKinds = [](const auto& path) { (void)design::read_kind_plan(path); };
constexpr auto kRegions = [](const auto& path) { (void)design::read_region_file(path); };

/// Checks the input as a proof about the outline in the corpus of this target.
void proof(Bytes input) {
  static const std::string kOutline = R"({"type":"Polygon","coordinates":[[[0,0],[70,0],[70,60],[0,60],[0,0]]]})";
  try {
    (void)check::check_placement_proof_text(std::string(input.begin(), input.end()), kOutline);
  } catch (const Error&) {
    return;
  }
}

constexpr std::array kTargets{Target{"design", text<kDesign>, 1000},
                              Target{"check", file<kCheck>, 500},
                              Target{"scene", file<kScene>, 1000},
                              Target{"robot", text<kRobot>, 1000},
                              Target{"urdf", text<kUrdf>, 1000},
                              Target{"touches", text<kTouches>, 1000},
                              Target{"calibration", text<kCalibration>, 1000},
                              Target{"backup", file<kBackup>, 1000},
                              Target{"kinds", file<kKinds>, 1000},
                              Target{"regions", file<kRegions>, 1000},
                              Target{"proof", proof, 500}};

}  // namespace

std::span<const Target> targets() {
  return kTargets;
}

}  // namespace triskin::fuzz
