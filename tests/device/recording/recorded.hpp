// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/strip_design.hpp"
#include "triskin/recording/recorder.hpp"
#include "triskin/recording/recording.hpp"

namespace triskin::recording {

/// Gives each test its own folder.
class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / (name + "." + std::to_string(::getpid()))) {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

inline constexpr std::uint64_t kSamplePeriod_us = 36'900;

/// Makes sample k of a skin with `modules` modules in patches of 16, in the order of the stream: all modules of sample
/// 1, then those of sample 2 …
inline ModuleSample sample_of(std::uint64_t k, int modules) {
  const auto n = static_cast<std::uint64_t>(modules);
  const std::uint64_t round = k / n, module = k % n;
  ModuleSample s;
  s.module = layout::ModuleId{module};
  s.link_time_us = 1'000'000 + round * kSamplePeriod_us + module * 150;
  s.sample.node_address = static_cast<std::uint8_t>(module / 16 + 1);
  s.sample.module = static_cast<std::uint8_t>(module % 16);
  s.sample.sample = static_cast<std::uint32_t>(round + 1);
  // Lines are not read at the same time.
  s.sample.device_time_us = 500'000 + round * kSamplePeriod_us - module % 4 * 1'000;
  s.sample.valid = static_cast<std::uint16_t>(0xFFF & ~(k % 3));
  s.sample.state = wire::ModuleState::kOk;
  for (std::size_t t = 0; t < s.sample.value.size(); ++t)
    s.sample.value[t] = static_cast<std::uint16_t>(24'768 + k * 7 + t);
  return s;
}

inline Origin origin() {
  Origin o;
  o.design_text = "{\"format\":\"triskin-design\"}";
  o.link_start_us = 1'000'000;
  o.unix_start_ns = 1'700'000'000'000'000'000;
  return o;
}

/// Records `count` samples into `path` and closes the recording properly.
inline void record_samples(const std::filesystem::path& path, const design::Design& design, std::uint64_t count,
                           Origin from = origin()) {
  OutputFile file(path);
  const auto recorder = make_recorder(Format::kMcap, file, design, std::move(from));
  const int modules = static_cast<int>(design.layout.modules.size());
  for (std::uint64_t k = 0; k < count; ++k) recorder->add(sample_of(k, modules));
  recorder->finish({{"status", "complete"}});
  file.close();
}

/// Returns all samples of a recording.
inline std::vector<ModuleSample> samples_of(const std::filesystem::path& path, Summary* summary = nullptr) {
  std::vector<ModuleSample> samples;
  Summary s = read_recording(path, [&](const ModuleSample& m) { samples.push_back(m); });
  if (summary != nullptr) *summary = std::move(s);
  return samples;
}

}  // namespace triskin::recording
