// SPDX-License-Identifier: GPL-3.0-or-later
#include "file_unit.hpp"

#include <minizip/unzip.h>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <string_view>

namespace triskin::geometry {
namespace {

constexpr const char* kModelPart = "3D/3dmodel.model";  // of a 3MF package

struct UnitRow {
  std::string_view name;
  double mm;
};
constexpr std::array<UnitRow, 6> kUnits3mf{
    {{"micron", 1e-3}, {"millimeter", 1.0}, {"centimeter", 10.0}, {"inch", 25.4}, {"foot", 304.8}, {"meter", 1e3}}};

// Text between the quotes after ` name=` in the first tag of this kind; empty where either is missing.
std::string_view attribute_of(std::string_view text, std::string_view tag, std::string_view name) {
  std::size_t at = text.find(tag);
  if (at == std::string_view::npos) return {};
  const std::string_view inside = text.substr(at, std::min(text.find('>', at), text.size()) - at);
  for (at = inside.find(name); at != std::string_view::npos; at = inside.find(name, at + 1)) {
    const std::size_t sign = inside.find_first_not_of(" \t\r\n", at + name.size());
    if (sign == std::string_view::npos || inside[sign] != '=') continue;
    const std::size_t quote = inside.find_first_of("\"'", sign);
    if (quote == std::string_view::npos) return {};
    const std::size_t end = inside.find(inside[quote], quote + 1);
    return end == std::string_view::npos ? std::string_view() : inside.substr(quote + 1, end - quote - 1);
  }
  return {};
}

// The model of a 3MF package; empty where there is none.
std::string model_of_3mf(const std::filesystem::path& path) {
  constexpr int kAnyCase = 2;
  const std::unique_ptr<void, decltype(&unzClose)> zip(unzOpen(path.c_str()), &unzClose);
  if (!zip || unzLocateFile(zip.get(), kModelPart, kAnyCase) != UNZ_OK || unzOpenCurrentFile(zip.get()) != UNZ_OK)
    return {};
  std::string model;
  std::array<char, 65536> buffer{};
  for (;;) {
    const int got = unzReadCurrentFile(zip.get(), buffer.data(), static_cast<unsigned>(buffer.size()));
    if (got <= 0) break;
    model.append(buffer.data(), static_cast<std::size_t>(got));
  }
  unzCloseCurrentFile(zip.get());
  return model;
}

}  // namespace

double unit_of_dae_mm(const std::string& text) {
  const std::string_view metres = attribute_of(text, "<unit", "meter");
  double value = 0.0;
  const auto [rest, error] = std::from_chars(metres.data(), metres.data() + metres.size(), value);
  return error == std::errc{} && std::isfinite(value) && value > 0.0 ? 1000.0 * value : 0.0;
}

double unit_of_3mf_mm(const std::filesystem::path& path) {
  const std::string model = model_of_3mf(path);
  if (model.empty()) return 0.0;
  const std::string_view unit = attribute_of(model, "<model", "unit");
  if (unit.empty()) return 1.0;
  for (const UnitRow& row : kUnits3mf) {
    if (row.name == unit) return row.mm;
  }
  return 0.0;
}

std::map<std::string, std::string> names_in_3mf(const std::filesystem::path& path) {
  constexpr std::string_view kTag = "<object ";
  const std::string model = model_of_3mf(path);
  std::map<std::string, std::string> names;
  for (std::size_t at = model.find(kTag); at != std::string::npos; at = model.find(kTag, at + 1)) {
    const std::string_view rest = std::string_view(model).substr(at);
    const std::string_view id = attribute_of(rest, kTag, " id"), name = attribute_of(rest, kTag, " name");
    if (!id.empty() && !name.empty()) names.emplace(id, name);
  }
  return names;
}

}  // namespace triskin::geometry
