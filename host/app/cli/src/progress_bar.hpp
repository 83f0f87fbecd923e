// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/base/progress.hpp"

namespace triskin::cli {

/// Returns a sink that shows progress on standard error: a terminal gets a bar, or a one-line bar for each active part
/// of the work; anything else gets one line for each stage. The first second stays quiet, so that short work leaves no
/// trace. Threads: any.
[[nodiscard]] ProgressSink progress_on_standard_error();

/// Clears the bar from the terminal, so that the caller can print a line; the next progress draws the bar again.
/// Threads: any.
void clear_progress_bar();

}  // namespace triskin::cli
