// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/stream_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "triskin/base/counted.hpp"

namespace triskin::session {
namespace {

// Formats numbers as "0–12, 15"; consecutive ones become a range.
template <class Number>
std::string ranges(std::vector<Number> numbers) {
  std::ranges::sort(numbers);
  std::string text;
  for (std::size_t k = 0; k < numbers.size();) {
    std::size_t last = k;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    if (!text.empty()) text += ", ";
    text += last == k ? fmt::format("{}", numbers[k])
                      : fmt::format("{}{}{}", numbers[k], last == k + 1 ? ", " : "–", numbers[last]);
    k = last + 1;
  }
  return text;
}

// Returns "module 3" or "modules 0–2, 7".
template <class Number>
std::string named(std::string_view noun, const std::vector<Number>& numbers) {
  return fmt::format("{} {}", noun_after(numbers.size() == 1, noun), ranges(numbers));
}

std::string named_modules(const std::vector<design::ModuleNumber>& modules) {
  std::vector<int> numbers;
  for (const design::ModuleNumber m : modules) numbers.push_back(m.value);
  return named("module", numbers);
}

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

// Returns the modules that controllers of other patches read, by that patch.
std::map<layout::PatchIndex, std::vector<design::ModuleNumber>> adopters(const StreamReport& r) {
  std::map<layout::PatchIndex, std::vector<design::ModuleNumber>> list;
  for (const AdoptedCounts& a : r.adopted) {
    std::vector<design::ModuleNumber>& modules = list[a.patch];
    if (a.counts.with_data > 0 && std::ranges::count(modules, a.number) == 0) modules.push_back(a.number);
  }
  std::erase_if(list, [](const auto& entry) { return entry.second.empty(); });
  return list;
}

// Returns true if the controller of another patch of its cover read a module with data.
bool is_adopted(const StreamReport& r, const ModuleCounts& module) {
  return std::ranges::any_of(r.adopted, [&](const AdoptedCounts& a) {
    return a.cover == module.cover && a.module == module.module && a.counts.with_data > 0;
  });
}

std::string places(const StreamReport& r) {
  std::string text;
  const auto add = [&](std::uint64_t n, const char* where) {
    if (n > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, where);
  };
  add(r.total.unread, "not read by the controller");
  add(r.total.dropped, "without room on the bus");
  add(r.lost_bus, "between controller and computer");
  add(r.lost_host, "in this computer");
  add(r.total.silent, "while a controller was away");
  return text;
}

}  // namespace

void sum_up(StreamReport& r, std::uint64_t thrown_away) {
  // Covers number their modules and patches alike, so neither number names one without its cover.
  std::map<std::pair<layout::CoverIndex, layout::PatchIndex>, SampleCounts> patches;
  for (const ModuleCounts& m : r.modules) {
    r.total += m.counts;
    patches[{m.cover, m.patch}] += m.counts;
    if (m.never_heard() && !is_adopted(r, m)) r.never_heard.push_back(m.number);
    if (m.slow) r.slow.push_back(m.number);
  }
  for (const AdoptedCounts& a : r.adopted) {
    r.total += a.counts;
    patches[{a.cover, a.patch}] += a.counts;
  }
  for (const auto& [key, counts] : patches) {
    if (percent(counts.dropped, counts.expected) > 1.0) r.starved.push_back(key.second);
  }
  // After a lapse, controllers without another reader stop streaming, so those samples were never on the bus.
  r.lost_host = r.lapses > 0 ? r.total.on_the_way : std::min(r.total.on_the_way, thrown_away);
  r.lost_bus = r.total.on_the_way - r.lost_host;
}

std::vector<std::string> sentences(const StreamReport& r, std::string_view diagnosis) {
  std::vector<std::string> lines;
  std::string first = fmt::format("{} of {} of {}", r.total.received, counted(r.total.expected, "sample"),
                                  counted(r.modules.size(), "module"));
  if (r.total.lost() == 0)
    first += ", 0 lost";
  else
    first +=
        fmt::format("; {} lost ({:.1f} %): {}", r.total.lost(), percent(r.total.lost(), r.total.expected), places(r));
  lines.push_back(std::move(first));
  if (!r.starved.empty())
    lines.push_back(fmt::format("the bus is too slow for the {} of {}: {}",
                                noun_after(r.starved.size() == 1, "controller"), named("patch", r.starved),
                                describe(r.budget)));
  if (!r.silent.empty())
    lines.push_back(fmt::format("silent: the {} of {}; check power and cable",
                                noun_after(r.silent.size() == 1, "controller"), named("patch", r.silent)));
  if (!r.never_heard.empty())
    lines.push_back(fmt::format("never heard: {}; {}", named_modules(r.never_heard), diagnosis));
  for (const auto& [patch, modules] : adopters(r))
    lines.push_back(fmt::format("read by the controller of patch {}, because their own does not reach them: {}", patch,
                                named_modules(modules)));
  if (!r.slow.empty())
    lines.push_back(fmt::format("fewer samples than the rate says: {}; {}", named_modules(r.slow), diagnosis));
  if (r.lapses > 0)
    lines.push_back(fmt::format("this computer was too busy to renew its lease, {}; close other programs",
                                counted(r.lapses, "time")));
  return lines;
}

}  // namespace triskin::session
