// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "document.hpp"
#include "triskin/cad/write_step.hpp"

namespace triskin::cad_reader {

/// Writes the assembly as a STEP file (AP214). Errors: std::runtime_error with a sentence.
[[nodiscard]] std::string step_of(const cad::StepAssembly& assembly, const StageSink& stage);

}  // namespace triskin::cad_reader
