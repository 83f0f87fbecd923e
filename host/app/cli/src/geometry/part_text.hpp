// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include "command.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::cli {

/// Reports how a CAD part was read and adds this to the result as `part`; does nothing for other files. Returns the
/// resulting exit status: 1 if something of the part is missing.
inline int report_part(const mesh::MeshReadReport& report, Output& output) {
  if (!report.part) return 0;
  const mesh::PartReport& part = *report.part;
  output.result["part"] = {{"faces", part.faces},
                           {"face_count", part.face_count},
                           {"deviation_mm", part.deviation_mm},
                           {"warnings", part.warnings},
                           {"faults", part.faults}};
  output.say(fmt::format("{} of {} of the part, meshed within {:.3f} mm", part.faces.size(),
                         counted(part.face_count, "face"), part.deviation_mm));
  for (const std::string& warning : part.warnings) output.say("warning: " + warning);
  for (const std::string& fault : part.faults) output.say("fault: " + fault);
  return part.faults.empty() ? 0 : 1;
}

}  // namespace triskin::cli
