// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/expectation.hpp"

#include <fmt/format.h>

namespace triskin::hardware {
namespace {

using Kind = Expectation::Kind;

std::string seconds(std::uint64_t time_us) {
  return fmt::format("{:g}", static_cast<double>(time_us) * 1e-6);
}

std::string times_of(const Expectation& e) {
  if (!e.until_us) return fmt::format("at {} s", seconds(e.from_us));
  return fmt::format("{} {} … {} s", e.once ? "once in" : "in", seconds(e.from_us), seconds(*e.until_us));
}

std::string subject_of(const Expectation& e) {
  const std::string of_part = e.part.empty() ? "" : " of " + e.part;
  if (e.module < 0) return "the skin" + of_part;
  if (e.taxel < 0) return fmt::format("module {}{}", e.number, of_part);
  return fmt::format("taxel {} of module {}{}", e.taxel, e.number, of_part);
}

std::string claim_of(const Expectation& e) {
  switch (e.kind) {
    case Kind::kForceAbove:
      return fmt::format("reports more than {:g} N", e.bound);
    case Kind::kForceBelow:
      return fmt::format("reports less than {:g} N", e.bound);
    case Kind::kCountsAbove:
      return fmt::format("reports a change of more than {:g} counts", e.bound);
    case Kind::kCountsBelow:
      return fmt::format("reports a change of less than {:g} counts", e.bound);
    case Kind::kPressed:
      return "is pressed";
    case Kind::kNotPressed:
      return "is not pressed";
    case Kind::kState:
      return fmt::format("is in the state {}", kModuleStateNames.name(e.state));
    case Kind::kSilent:
      return "sends no sample";
  }
  return {};
}

}  // namespace

std::string text_of(const Expectation& expectation) {
  return fmt::format("{} {} {}", times_of(expectation), subject_of(expectation), claim_of(expectation));
}

}  // namespace triskin::hardware
