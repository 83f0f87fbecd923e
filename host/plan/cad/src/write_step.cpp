// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cad/write_step.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "reader_process.hpp"
#include "triskin/base/error.hpp"
#include "triskin/cad/part_stream.hpp"

namespace triskin::cad {
namespace {

using WriterJson = nlohmann::json;

// A face takes about a millisecond and 40 kB, of which the written file is 2 kB.
constexpr double kWriting_s = 20.0, kWritingPerFace_s = 0.02, kWritingWallTimes = 3.0;
constexpr std::uint64_t kWritingMemory_bytes = 1'000'000'000, kMemoryPerFace_bytes = 100'000;
constexpr std::uint64_t kWritingFile_bytes = 100'000'000, kFilePerFace_bytes = 10'000;

ProcessLimits writing_limits(const std::vector<StepBody>& bodies) {
  std::size_t faces = 0;
  for (const StepBody& body : bodies) faces += body.faces.size();
  ProcessLimits limits;
  limits.processor_s = kWriting_s + kWritingPerFace_s * static_cast<double>(faces);
  limits.wall_s = kWritingWallTimes * limits.processor_s;
  limits.memory_bytes = kWritingMemory_bytes + kMemoryPerFace_bytes * faces;
  limits.file_bytes = kWritingFile_bytes + kFilePerFace_bytes * faces;
  return limits;
}

WriterJson step_body_json(const StepBody& body) {
  WriterJson vertices = WriterJson::array();
  for (const design::Vec3& v : body.vertices) vertices.push_back({v.x(), v.y(), v.z()});
  return {{"name", body.name}, {"colour", body.colour}, {"vertices", vertices}, {"faces", body.faces}};
}

StepBody step_body_of(const WriterJson& fields) {
  StepBody body;
  body.name = fields.at("name");
  body.colour = fields.at("colour");
  for (const WriterJson& v : fields.at("vertices")) body.vertices.emplace_back(v.at(0), v.at(1), v.at(2));
  body.faces = fields.at("faces").get<std::vector<std::vector<int>>>();
  for (const auto& face : body.faces) {
    for (const int v : face) {
      if (v < 0 || static_cast<std::size_t>(v) >= body.vertices.size())
        throw std::runtime_error(fmt::format("body {} has no corner {}", body.name, v));
    }
  }
  return body;
}

}  // namespace

std::string encode_bodies(const std::string& assembly, const std::vector<StepBody>& bodies) {
  WriterJson list = WriterJson::array();
  for (const StepBody& body : bodies) list.push_back(step_body_json(body));
  return WriterJson{{"name", assembly}, {"bodies", list}}.dump();
}

StepAssembly bodies_of(std::string_view bytes) {
  const WriterJson fields = WriterJson::parse(bytes);
  StepAssembly assembly{fields.at("name"), {}};
  for (const WriterJson& body : fields.at("bodies")) assembly.bodies.push_back(step_body_of(body));
  return assembly;
}

std::string write_step(const std::string& assembly, const std::vector<StepBody>& bodies) {
  if (bodies.empty()) throw InputError("an assembly without bodies cannot be written");
  const auto program = find_reader();
  if (!program)
    throw InputError(
        "this triskin was built without the program for CAD files, so it cannot write STEP; install the package "
        "libocct-data-exchange-dev and build again, or leave STEP out");
  const ProcessResult result =
      run_limited(*program, {"write-step"}, encode_bodies(assembly, bodies), writing_limits(bodies));
  ReaderOutput said = parse_frames(result.output);
  if (said.part) return std::move(*said.part);
  throw InputError(fmt::format("the assembly cannot be written as STEP: {}",
                               said.error.value_or("the geometry kernel ended without an answer, " +
                                                   (said.stage.empty() ? "before it began" : "while " + said.stage))));
}

}  // namespace triskin::cad
