// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>

namespace triskin {

/// One step of long work. `fraction` is in [0, 1], or negative when it cannot be known.
struct Progress {
  std::string stage;
  double fraction = -1.0;
  std::string detail;
  int part = -1;  ///< The index among pieces of work that run side by side; −1 means that there is only one.
};

/// The thread that runs the work calls it; it must not throw. An empty function is allowed.
using ProgressSink = std::function<void(const Progress&)>;

/// Reports one step to `sink`: `fraction` in [0, 1] or negative when unknown, `part` 0.. of work side by side or -1.
/// Does nothing with an empty sink.
inline void report(const ProgressSink& sink, std::string stage, double fraction, std::string detail = {},
                   int part = -1) {
  if (sink) sink(Progress{std::move(stage), fraction, std::move(detail), part});
}

}  // namespace triskin
