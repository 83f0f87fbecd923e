// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/pipeline/time_budget.hpp"

#include <algorithm>
#include <chrono>

#include "triskin/base/error.hpp"

namespace triskin::pipeline {
namespace {

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

TimeBudget::TimeBudget(double limit_s) : TimeBudget(limit_s, steady_s) {}

TimeBudget::TimeBudget(double limit_s, Seconds now) : limit_s_(limit_s), now_(std::move(now)), start_s_(now_()) {
  if (!(limit_s > 0.0)) throw InputError("the time limit must be positive");
}

double TimeBudget::left_s() const {
  double reserved_s = 0.0;
  for (const auto& [step, seconds] : reserved_) reserved_s += seconds;
  return limit_s_ - used_s() - reserved_s;
}

void TimeBudget::reserve(std::string_view step, double seconds) {
  std::erase_if(reserved_, [&](const auto& r) { return r.first == step; });
  reserved_.emplace_back(step, seconds);
}

std::function<bool()> TimeBudget::is_over(double end_s) const {
  return [now = now_, end = start_s_ + end_s] { return now() > end; };
}

TimeBudget::Running::Running(TimeBudget& budget, std::string name, double share)
    : budget_(budget), name_(std::move(name)), begin_s_(budget.used_s()) {
  std::erase_if(budget_.reserved_, [&](const auto& r) { return r.first == name_; });
  granted_s_ = share * std::max(0.0, budget_.left_s());
}

TimeBudget::Running::~Running() {
  budget_.steps_.push_back({std::move(name_), granted_s_, budget_.used_s() - begin_s_});
}

}  // namespace triskin::pipeline
