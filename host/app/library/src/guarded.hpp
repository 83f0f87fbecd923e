// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <cstddef>
#include <exception>
#include <new>
#include <string>

#include "argument_words.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/design.hpp"
#include "triskin/triskin.h"

/// All functions of triskin.h use this frame: no exception leaves them, and the error is kept for the thread.
namespace triskin::library {

/// Returns what the last failed call in this thread could not do.
[[nodiscard]] inline std::string& last_error() {
  thread_local std::string text;
  return text;
}

inline triskin_status failed(triskin_status status, const std::string& what) {
  last_error() = what;
  return status;
}

/// Runs work that may throw and converts exceptions to a status.
template <class Work>
triskin_status guarded(Work work) {
  try {
    return work();
  } catch (const InputError& e) {
    return failed(TRISKIN_BAD_INPUT, argument_words(e.what()));
  } catch (const Error& e) {
    return failed(TRISKIN_DEVICE_FAILED, argument_words(e.what()));
  } catch (const std::bad_alloc&) {
    return failed(TRISKIN_DEVICE_FAILED, "there is no memory left");
  } catch (const std::exception& e) {
    return failed(TRISKIN_DEVICE_FAILED, e.what());
  }
}

inline void require(bool ok, const char* text) {
  if (!ok) throw InputError(text);
}

inline void require_size(const char* what, std::size_t given, std::size_t wanted) {
  if (given != wanted) throw InputError(fmt::format("{}: n is {}, must be {}", what, given, wanted));
}

/// Writes positions or normals of all taxels; `part` selects one of them from a pose.
template <class Part>
void write_poses(const design::Design& design, double* out, Part part) {
  const auto wiring = design::wiring_of(design);
  for (std::size_t m = 0; m < wiring.size(); ++m) {
    for (const design::TaxelPose& pose : design::taxels_of(design.layout.modules[m], wiring[m].routed.rotation)) {
      for (int axis = 0; axis < 3; ++axis) *out++ = part(pose)[axis];
    }
  }
}

}  // namespace triskin::library
