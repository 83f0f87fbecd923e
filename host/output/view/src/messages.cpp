// SPDX-License-Identifier: GPL-3.0-or-later
#include "messages.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <nlohmann/json.hpp>

#include "triskin/base/error.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::view {
namespace {

using nlohmann::json;

// Returns empty if the value is absent, not an integer, or outside low … high.
std::optional<int> integer(const json& object, const char* key, int low, int high) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_integer()) return std::nullopt;
  const auto value = found->get<std::int64_t>();
  if (value < low || value > high) return std::nullopt;
  return static_cast<int>(value);
}

}  // namespace

std::optional<Command> command_of(std::string_view text) {
  const json message = json::parse(text, nullptr, false);
  if (!message.is_object()) return std::nullopt;
  const auto kind = message.find("do");
  if (kind == message.end() || !kind->is_string()) return std::nullopt;
  if (*kind == "lift") return Command{Command::Kind::kLift};
  if (*kind == "rest") return Command{Command::Kind::kRest};
  const auto module = integer(message, "module", 0, 1'000'000);
  const auto taxel = integer(message, "taxel", -1, layout::kTaxelsPerModule - 1);
  if (*kind != "press" || !module || !taxel) return std::nullopt;
  return Command{Command::Kind::kPress, layout::SkinModule{*module}, layout::TaxelIndex{*taxel}};
}

std::string health_json(const LatestSamples::Health& health) {
  return json{{"link", health.link},
              {"live", health.live},
              {"trouble", health.trouble},
              {"frames", health.frames},
              {"lost", health.lost}}
      .dump(-1, ' ', true, json::error_handler_t::replace);
}

std::string contacts_json(const std::vector<LatestSamples::Contact>& contacts) {
  json list = json::array();
  for (const LatestSamples::Contact& c : contacts) {
    // JSON has no NaN: the library writes null for it.
    list.push_back({{"taxels", c.taxels},
                    {"position_mm", {c.position_mm.x(), c.position_mm.y(), c.position_mm.z()}},
                    {"position_sd_mm", c.position_sd_mm},
                    {"force_n", c.force_n},
                    {"force_sd_n", c.force_sd_n},
                    {"area_mm2", c.area_mm2},
                    {"change_counts", c.change_counts}});
  }
  return json{{"contacts", std::move(list)}}.dump();
}

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw DeviceError("the operating system gives no random numbers for the token of the page");
  std::string token;
  for (const unsigned char b : bytes) token += fmt::format("{:02x}", b);
  return token;
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t k = 0; k < a.size(); ++k) difference |= static_cast<unsigned char>(a[k] ^ b[k]);
  return difference == 0;
}

}  // namespace triskin::view
