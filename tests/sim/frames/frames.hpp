// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "support/places.hpp"
#include "triskin/base/files.hpp"
#include "triskin/hardware/scene.hpp"
#include "triskin/scenario/running_skin.hpp"

namespace triskin::test {

/// A frame that a controller sent, with the virtual time of its arrival.
struct SentFrame {
  std::uint64_t at_us = 0;
  wire::CanFrame frame;
};

/// Runs a scene for `seconds` of virtual time with a reader of all samples and returns what its controllers sent.
inline std::vector<SentFrame> frames_of(hardware::Scene scene, double seconds) {
  std::vector<SentFrame> frames;
  scenario::RunningSkin skin(std::move(scene), {}, [&](const wire::CanFrame& frame, std::uint64_t at_us) {
    frames.push_back({at_us, frame});
  });
  skin.run_until(static_cast<std::uint64_t>(seconds * 1e6));
  return frames;
}

/// Hashes identifiers, contents and times of frames with FNV-1a, which is the same for every compiler.
inline std::uint64_t hash_of(const std::vector<SentFrame>& frames) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  const auto add = [&](std::uint64_t value, int bytes) {
    for (int k = 0; k < bytes; ++k) hash = (hash ^ (value >> (8 * k) & 0xFF)) * 0x100000001B3ULL;
  };
  for (const SentFrame& f : frames) {
    add(f.at_us, 8);
    add(f.frame.id, 4);
    add(f.frame.size, 1);
    for (std::size_t k = 0; k < f.frame.size; ++k) add(f.frame.data[k], 1);
  }
  return hash;
}

inline std::filesystem::path scene_folder() {
  return std::filesystem::path(source_folder()) / "docs/examples/scenes";
}

/// Returns the names of the scenes in docs/examples/scenes, sorted.
inline std::vector<std::string> ready_scenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(scene_folder())) {
    const auto document = nlohmann::json::parse(read_file(entry.path()));
    if (document["format"] == "triskin-scene" && document.contains("design"))
      names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

}  // namespace triskin::test
