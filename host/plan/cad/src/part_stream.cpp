// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/cad/part_stream.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>

#include "triskin/base/error.hpp"

namespace triskin::cad {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are copied as they lie in memory");
static_assert(sizeof(design::Vec3) == 3 * sizeof(double) && sizeof(std::array<int, 3>) == 12);

using nlohmann::json;

json vector_json(const design::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
design::Vec3 vector_of(const json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

json face_json(const Face& f) {
  return {{"name", f.name},
          {"colour", f.colour},
          {"entity", f.entity},
          {"kind", kSurfaceKindNames.name(f.kind)},
          {"side", kFaceSideNames.name(f.side)},
          {"body", f.body},
          {"area_mm2", f.area_mm2},
          {"radius_mm", f.radius_mm},
          {"hole_diameter_mm", f.hole_diameter_mm},
          {"place_mm", vector_json(f.place_mm)},
          {"normal", vector_json(f.normal)},
          {"deviation_mm", f.deviation_mm},
          {"is_hidden", f.is_hidden},
          {"fault", f.fault}};
}

Face face_of(const json& j) {
  Face f;
  j.at("name").get_to(f.name);
  j.at("colour").get_to(f.colour);
  j.at("entity").get_to(f.entity);
  f.kind = kSurfaceKindNames.value(j.at("kind").get<std::string>()).value_or(SurfaceKind::kOther);
  f.side = kFaceSideNames.value(j.at("side").get<std::string>()).value_or(FaceSide::kUndecided);
  j.at("body").get_to(f.body);
  j.at("area_mm2").get_to(f.area_mm2);
  j.at("radius_mm").get_to(f.radius_mm);
  j.at("hole_diameter_mm").get_to(f.hole_diameter_mm);
  f.place_mm = vector_of(j.at("place_mm"));
  f.normal = vector_of(j.at("normal"));
  j.at("deviation_mm").get_to(f.deviation_mm);
  j.at("is_hidden").get_to(f.is_hidden);
  j.at("fault").get_to(f.fault);
  return f;
}

json body_json(const Body& b) {
  return {{"name", b.name},
          {"path", b.path},
          {"colour", b.colour},
          {"is_solid", b.is_solid},
          {"first_face", b.first_face},
          {"face_count", b.face_count},
          {"free_edges", b.free_edges},
          {"open_edges", b.open_edges},
          {"area_mm2", b.area_mm2}};
}

Body body_of(const json& j) {
  Body b;
  j.at("name").get_to(b.name);
  j.at("path").get_to(b.path);
  j.at("colour").get_to(b.colour);
  j.at("is_solid").get_to(b.is_solid);
  b.first_face = design::BrepFaceIndex(j.at("first_face").get<int>());
  j.at("face_count").get_to(b.face_count);
  j.at("free_edges").get_to(b.free_edges);
  j.at("open_edges").get_to(b.open_edges);
  j.at("area_mm2").get_to(b.area_mm2);
  return b;
}

std::string size_bytes(std::uint64_t size) {
  std::string out(sizeof(size), '\0');
  std::memcpy(out.data(), &size, sizeof(size));
  return out;
}

std::uint64_t size_at(std::string_view bytes) {
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data(), sizeof(size));
  return size;
}

template <class Value>
void append(std::string& out, const std::vector<Value>& values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

[[noreturn]] void fail() {
  throw InputError("the reader's answer is damaged; build triskin and triskin-cad from one source");
}

template <class Value>
void take(std::string_view& bytes, std::vector<Value>& values, std::size_t count) {
  if (bytes.size() / sizeof(Value) < count) fail();
  values.resize(count);
  if (count > 0) std::memcpy(static_cast<void*>(values.data()), bytes.data(), count * sizeof(Value));
  bytes.remove_prefix(count * sizeof(Value));
}

void require_below(int end, const auto& indices) {
  if (!std::ranges::all_of(indices, [end](int k) { return k >= 0 && k < end; })) fail();
}

void require_in_range(const Part& part) {
  const auto vertices = static_cast<int>(part.mesh.vertices.size()), faces = static_cast<int>(part.faces.size());
  const auto bodies = static_cast<int>(part.bodies.size());
  for (const design::Vec3& v : part.mesh.vertices) {
    if (!v.allFinite()) fail();
  }
  for (const auto& f : part.mesh.faces) require_below(vertices, f);
  require_below(faces, part.face_of_triangle);
  for (const Face& f : part.faces) {
    if (f.body < 0 || f.body >= bodies) fail();
  }
}

}  // namespace

std::string frame(FrameKind kind, std::string_view payload) {
  return std::string(1, static_cast<char>(kind)) + size_bytes(payload.size()) + std::string(payload);
}

std::string encode_part(const Part& part) {
  json faces = json::array(), bodies = json::array();
  for (const Face& f : part.faces) faces.push_back(face_json(f));
  for (const Body& b : part.bodies) bodies.push_back(body_json(b));
  const json facts = {{"unit", part.unit},
                      {"unit_mm", part.unit_mm},
                      {"unit_given", part.unit_given},
                      {"bodies", std::move(bodies)},
                      {"faces", std::move(faces)},
                      {"vertex_count", part.mesh.vertices.size()},
                      {"triangle_count", part.mesh.faces.size()},
                      {"deviation_mm", part.deviation_mm},
                      {"warnings", part.warnings},
                      {"faults", part.faults}};
  // Names come from a file, so bytes that are no UTF-8 are replaced.
  const std::string text = facts.dump(-1, ' ', false, json::error_handler_t::replace);
  std::string out = size_bytes(text.size()) + text;
  append(out, part.mesh.vertices);
  append(out, part.mesh.faces);
  append(out, part.face_of_triangle);
  return out;
}

Part decode_part(std::string_view bytes) {
  if (bytes.size() < sizeof(std::uint64_t)) fail();
  const std::uint64_t length = size_at(bytes);
  bytes.remove_prefix(sizeof(length));
  if (length > bytes.size()) fail();
  Part part;
  try {
    const json facts = json::parse(bytes.substr(0, length));
    bytes.remove_prefix(length);
    facts.at("unit").get_to(part.unit);
    facts.at("unit_mm").get_to(part.unit_mm);
    facts.at("unit_given").get_to(part.unit_given);
    for (const json& b : facts.at("bodies")) part.bodies.push_back(body_of(b));
    for (const json& f : facts.at("faces")) part.faces.push_back(face_of(f));
    facts.at("deviation_mm").get_to(part.deviation_mm);
    facts.at("warnings").get_to(part.warnings);
    facts.at("faults").get_to(part.faults);
    const auto triangles = facts.at("triangle_count").get<std::size_t>();
    take(bytes, part.mesh.vertices, facts.at("vertex_count").get<std::size_t>());
    take(bytes, part.mesh.faces, triangles);
    take(bytes, part.face_of_triangle, triangles);
  } catch (const json::exception&) {
    fail();
  }
  require_in_range(part);
  return part;
}

ReaderOutput parse_frames(std::string_view bytes) {
  constexpr std::size_t kHead = 1 + sizeof(std::uint64_t);
  ReaderOutput out;
  while (bytes.size() >= kHead) {
    const auto kind = static_cast<FrameKind>(bytes.front());
    const std::uint64_t length = size_at(bytes.substr(1));
    bytes.remove_prefix(kHead);
    if (length > bytes.size()) break;
    const std::string payload(bytes.substr(0, length));
    bytes.remove_prefix(length);
    if (kind == FrameKind::kStage) out.stage = payload;
    if (kind == FrameKind::kError) out.error = payload;
    if (kind == FrameKind::kPart) out.part = payload;
  }
  return out;
}

}  // namespace triskin::cad
