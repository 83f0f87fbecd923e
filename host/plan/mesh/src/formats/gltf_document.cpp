// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf_document.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "percent.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/json_cause.hpp"

namespace triskin::mesh {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxElements = 100'000'000;

// The standard numbers component types as OpenGL does.
struct TypeRow {
  std::size_t number, bytes;
  double largest;  // A normalized integer is divided by this value; 0 marks a type that is no integer.
  bool is_signed;
};
constexpr std::array<TypeRow, 6> kTypes{{{5120, 1, 127.0, true},
                                         {5121, 1, 255.0, false},
                                         {5122, 2, 32767.0, true},
                                         {5123, 2, 65535.0, false},
                                         {5125, 4, 4294967295.0, false},
                                         {5126, 4, 0.0, true}}};

template <class T>
double value_as(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof(value));
  return static_cast<double>(value);
}

double component(const char* at, const TypeRow& type) {
  switch (type.number) {
    case 5120:
      return value_as<std::int8_t>(at);
    case 5121:
      return value_as<std::uint8_t>(at);
    case 5122:
      return value_as<std::int16_t>(at);
    case 5123:
      return value_as<std::uint16_t>(at);
    case 5125:
      return value_as<std::uint32_t>(at);
    default:
      return value_as<float>(at);
  }
}

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  if (at + sizeof(value) <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

// Decodes six bits per character; returns nothing at a character outside the alphabet.
std::string from_base64(std::string_view text) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t held = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::size_t value = kAlphabet.find(c);
    if (value == std::string_view::npos) return {};
    held = held << 6 | static_cast<std::uint32_t>(value);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(held >> bits & 0xFFU);
  }
  return bytes;
}

// These extensions change no surface (materials, textures, lights, cameras, variants, meta data) or are read (quantized
// positions, visibility, instances).
bool is_known(std::string_view extension) {
  constexpr std::array<std::string_view, 6> kBeginnings{"KHR_materials_", "KHR_texture_",  "KHR_lights_",
                                                        "EXT_texture_",   "MSFT_texture_", "KHR_xmp"};
  if (extension == "KHR_mesh_quantization" || extension == "KHR_node_visibility" ||
      extension == "EXT_mesh_gpu_instancing")
    return true;
  return std::ranges::any_of(kBeginnings, [&](std::string_view b) { return extension.starts_with(b); });
}

}  // namespace

GltfDocument::GltfDocument(const MeshSource& source) : source_(source) {
  if (source.bytes.starts_with("glTF"))
    read_glb();
  else
    read_json(source.bytes);
  const auto asset = json_.find("asset");
  if (!json_.is_object() || asset == json_.end() || !asset->is_object()) fail("it has no \"asset\"");
  const std::string version = asset->contains("version") && (*asset)["version"].is_string()
                                  ? (*asset)["version"].get<std::string>()
                                  : std::string("unknown");
  if (!version.starts_with("2.")) fail(fmt::format("it is glTF {}, not 2", version.substr(0, 20)));
  if (const auto least = asset->find("minVersion"); least != asset->end() && *least != "2.0")
    fail(fmt::format("it needs a reader of glTF {}, and this one reads 2.0",
                     least->is_string() ? least->get<std::string>().substr(0, 20) : std::string("unknown")));
  require_known_extensions();
  const std::size_t n = json_.contains("buffers") && json_["buffers"].is_array() ? json_["buffers"].size() : 0;
  buffers_.resize(n);
  is_loaded_.resize(n);
}

void GltfDocument::fail(const std::string& what) const {
  throw InputError(fmt::format("{}: not a mesh that can be read ({}); repair or export it again", source_.name, what));
}

void GltfDocument::read_json(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  int depth = 0;
  for (const char c : text) {  // The JSON parser recurses, so deep nesting could overflow the stack.
    depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
    if (depth > 1000) fail("its JSON is nested too deeply");
  }
  try {
    json_ = json::parse(text);
  } catch (const json::exception& e) {
    fail(fmt::format("its JSON: {}", json_cause(e.what())));
  }
}

void GltfDocument::read_glb() {
  constexpr std::size_t kHead = 12, kChunkHead = 8;
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  const std::string& bytes = source_.bytes;
  if (word_at(bytes, 4) != 2) fail(fmt::format("it is GLB {}, not 2", word_at(bytes, 4)));
  const std::size_t length = word_at(bytes, 8);
  if (length > bytes.size()) fail(fmt::format("it was cut: {} bytes of {}", bytes.size(), length));
  if (length < bytes.size())
    source_.notes.push_back(fmt::format("{} bytes behind its end were left out", bytes.size() - length));
  for (std::size_t at = kHead; at + kChunkHead <= length;) {
    const std::size_t size = word_at(bytes, at);
    const std::uint32_t type = word_at(bytes, at + 4);
    if (size > length - at - kChunkHead) fail("a chunk is longer than the file");
    const std::string_view chunk = std::string_view(bytes).substr(at + kChunkHead, size);
    if (at == kHead && type != kJson) fail("its first chunk is not JSON");
    if (type == kJson) read_json(chunk);
    if (type == kBinary && !has_binary_) {
      binary_ = chunk;
      has_binary_ = true;
    }
    at += kChunkHead + size;
  }
}

void GltfDocument::require_known_extensions() const {
  const auto required = json_.find("extensionsRequired");
  if (required == json_.end() || !required->is_array()) return;
  for (const json& name : *required) {
    if (!name.is_string()) continue;
    const std::string text = name.get<std::string>();
    if (!is_known(text))
      fail(fmt::format("it requires the extension {}, which is not read; export it without", text.substr(0, 60)));
  }
}

const json& GltfDocument::element(const char* list, std::size_t index) const {
  const auto found = json_.find(list);
  if (found == json_.end() || !found->is_array() || index >= found->size() || !(*found)[index].is_object())
    fail(fmt::format("it has no {}[{}]", list, index));
  return (*found)[index];
}

std::size_t GltfDocument::whole(const json& object, const char* key, std::size_t fallback) const {
  return object.contains(key) ? whole(object, key) : fallback;
}

std::size_t GltfDocument::whole(const json& object, const char* key) const {
  const auto found = object.find(key);
  if (found == object.end()) fail(fmt::format("\"{}\" is missing", key));
  const bool is_whole = found->is_number_unsigned() ||
                        (found->is_number_float() && found->get<double>() >= 0.0 && found->get<double>() < 9e15 &&
                         found->get<double>() == std::floor(found->get<double>()));
  if (!is_whole) fail(fmt::format("\"{}\" must be a whole number", key));
  return found->is_number_float() ? static_cast<std::size_t>(found->get<double>()) : found->get<std::size_t>();
}

std::vector<double> GltfDocument::numbers(const json& object, const char* key, std::size_t n) const {
  const auto found = object.find(key);
  if (found == object.end()) return {};
  std::vector<double> values;
  if (found->is_array()) {
    for (const json& v : *found) {
      if (v.is_number()) values.push_back(v.get<double>());
    }
  }
  if (values.size() != n || found->size() != n) fail(fmt::format("\"{}\" must be {} numbers", key, n));
  return values;
}

std::vector<double> GltfDocument::list(const json& object, const char* key) const {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array()) return {};
  return numbers(object, key, found->size());
}

std::string GltfDocument::load(const json& buffer, std::size_t index) const {
  if (!buffer.contains("uri")) {
    if (index == 0 && has_binary_) return binary_;
    fail(fmt::format("buffers[{}] has no data", index));
  }
  const std::string uri = buffer["uri"].is_string() ? buffer["uri"].get<std::string>() : std::string();
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos || !std::string_view(uri).substr(0, comma).ends_with(";base64"))
      fail(fmt::format("the data of buffers[{}] is not in base64", index));
    return from_base64(std::string_view(uri).substr(comma + 1));
  }
  if (uri.find("://") != std::string::npos)
    fail(fmt::format("buffers[{}] is on the network: {}", index, uri.substr(0, 80)));
  const std::string file = percent_decoded(uri);
  if (source_.folder.empty())
    fail(fmt::format("its buffer \"{}\" lies in a file beside it, and a pipe has none; give the file by its name",
                     file));
  // A file from elsewhere may name any file of this computer, or a device that never ends.
  const std::filesystem::path path = source_.folder / file;
  if (std::filesystem::path(file).is_absolute())
    fail(fmt::format("its buffer \"{}\" has a path from the root of a computer; put the file beside it and name it so",
                     file));
  std::error_code none;
  if (std::filesystem::exists(path, none) && !std::filesystem::is_regular_file(path, none))
    fail(fmt::format("its buffer \"{}\" is no file", file));
  try {
    return read_file(path);
  } catch (const InputError& e) {
    fail(fmt::format("its buffer: {}", e.what()));
  }
}

const std::string& GltfDocument::buffer(std::size_t index) {
  const json& j = element("buffers", index);
  if (!is_loaded_[index]) {
    buffers_[index] = load(j, index);
    is_loaded_[index] = true;
    const std::size_t length = whole(j, "byteLength");
    if (buffers_[index].size() < length)
      fail(fmt::format("buffers[{}] was cut: {} bytes of {}", index, buffers_[index].size(), length));
  }
  return buffers_[index];
}

GltfDocument::View GltfDocument::view(std::size_t index) {
  const json& j = element("bufferViews", index);
  const std::string& bytes = buffer(whole(j, "buffer"));
  const View v{&bytes, whole(j, "byteOffset", 0), whole(j, "byteLength"), whole(j, "byteStride", 0)};
  if (v.offset > bytes.size() || v.length > bytes.size() - v.offset)
    fail(fmt::format("bufferViews[{}] goes over the end of its buffer", index));
  return v;
}

void GltfDocument::read_elements(const View& view, std::size_t offset, std::size_t number, bool is_normalized,
                                 std::size_t width, std::vector<double>& values) const {
  const auto* type = std::ranges::find(kTypes, number, &TypeRow::number);
  if (type == kTypes.end()) fail(fmt::format("unknown componentType {}", number));
  const std::size_t size = type->bytes * width, stride = view.stride == 0 ? size : view.stride;
  const std::size_t count = values.size() / width;
  if (count == 0) return;
  const bool fits = offset <= view.length && size <= view.length - offset &&
                    (count - 1) <= (view.length - offset - size) / std::max<std::size_t>(stride, 1);
  if (!fits || stride < size) fail("an accessor goes over the end of its buffer view");
  for (std::size_t e = 0; e < count; ++e) {
    const char* at = view.bytes->data() + view.offset + offset + e * stride;
    for (std::size_t c = 0; c < width; ++c) {
      double value = component(at + c * type->bytes, *type);
      if (is_normalized && type->largest > 0.0) value = std::max(value / type->largest, -1.0);
      values[e * width + c] = value;
    }
  }
}

void GltfDocument::put_sparse(const json& sparse, std::size_t type, bool is_normalized, std::size_t width,
                              std::vector<double>& values) {
  const std::size_t count = whole(sparse, "count");
  if (count > values.size() / width || !sparse.contains("indices") || !sparse.contains("values"))
    fail("a sparse accessor is not whole");
  const json &at = sparse["indices"], &with = sparse["values"];
  std::vector<double> indices(count), replacing(count * width);
  read_elements(view(whole(at, "bufferView")), whole(at, "byteOffset", 0), whole(at, "componentType"), false, 1,
                indices);
  read_elements(view(whole(with, "bufferView")), whole(with, "byteOffset", 0), type, is_normalized, width, replacing);
  for (std::size_t k = 0; k < count; ++k) {
    const auto e = static_cast<std::size_t>(indices[k]);
    if (e >= values.size() / width) fail("a sparse accessor names an element that does not exist");
    std::copy_n(replacing.begin() + static_cast<std::ptrdiff_t>(k * width), width,
                values.begin() + static_cast<std::ptrdiff_t>(e * width));
  }
}

void GltfDocument::require_type(const json& accessor, std::size_t index, const char* type) const {
  if (!accessor.contains("type") || accessor["type"] != type)
    fail(fmt::format("accessors[{}] must have the type {}", index, type));
}

std::vector<double> GltfDocument::accessor(std::size_t index, std::size_t width) {
  const json& j = element("accessors", index);
  require_type(j, index, width == 1 ? "SCALAR" : width == 3 ? "VEC3" : width == 4 ? "VEC4" : "MAT4");
  const std::size_t count = whole(j, "count"), type = whole(j, "componentType");
  if (count > kMaxElements) fail(fmt::format("accessors[{}] has too many elements", index));
  const bool is_normalized = j.contains("normalized") && j["normalized"] == true;
  if (!j.contains("bufferView") && !j.contains("sparse"))
    fail(fmt::format("accessors[{}] has no data: it is compressed by an extension that is not read", index));
  if (count > 0 && j.contains("bufferView") && count > view(whole(j, "bufferView")).length)
    fail("an accessor goes over the end of its buffer view");
  std::vector<double> values(count * width);
  if (j.contains("bufferView"))
    read_elements(view(whole(j, "bufferView")), whole(j, "byteOffset", 0), type, is_normalized, width, values);
  if (j.contains("sparse") && j["sparse"].is_object()) put_sparse(j["sparse"], type, is_normalized, width, values);
  return values;
}

}  // namespace triskin::mesh
