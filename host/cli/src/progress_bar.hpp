// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/base/progress.hpp"

namespace triskin::cli {

/// A sink that shows work on standard error: on a terminal a bar, or one for each part of the work that is under way,
/// each within one line; elsewhere one line for each stage. Quiet for the first second, so that short work leaves no
/// trace. Threads: any.
[[nodiscard]] ProgressSink progress_on_standard_error();

/// Takes the bar off the terminal, so that a line that is printed now stands alone; the next progress draws it again.
/// Threads: any.
void clear_progress_bar();

}  // namespace triskin::cli
