// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace triskin::pipeline {

/// Time that a step was granted and what it took of it.
struct StepTime {
  std::string name;
  double granted_s = 0.0;
  double used_s = 0.0;
};

/// Shares a time limit among the steps of a piece of work. A step is granted a share of what is left when it begins,
/// without the time that is reserved for later steps; what it does not use is there for those after it. Reserves are
/// meant to be measured while the work runs (the first item of a step, or a step that does the opposite, as reading a
/// file says what writing it will take), so that no speed of a machine is assumed. Not thread-safe, but deadlines that
/// it gave may be asked from any thread.
class TimeBudget {
 public:
  using Seconds = std::function<double()>;  ///< A clock that never goes back.

  /// Starts the time. Steady clock. Errors: InputError for a limit that is not positive.
  explicit TimeBudget(double limit_s);
  /// The same with a clock of the caller's, for tests.
  TimeBudget(double limit_s, Seconds now);

  [[nodiscard]] double limit_s() const { return limit_s_; }
  [[nodiscard]] double used_s() const { return now_() - start_s_; }
  /// What is not used and not reserved; negative when the steps took longer.
  [[nodiscard]] double left_s() const;

  /// Keeps `seconds` free until the step of that name begins; a second call for the same step replaces the first.
  void reserve(std::string_view step, double seconds);

  /// Runs a step that should end when used_s() reaches the argument of `work`: `share` (0 … 1) of left_s() from now.
  template <class Work>
  auto run(std::string name, double share, Work&& work) {
    const Running running(*this, std::move(name), share);
    return std::forward<Work>(work)(running.end_s());
  }

  /// True from `end_s` after the start on; holds a copy of the clock, so it may outlive the budget.
  [[nodiscard]] std::function<bool()> is_over(double end_s) const;

  /// Steps that have ended, in that order.
  [[nodiscard]] const std::vector<StepTime>& steps() const { return steps_; }

 private:
  // Keeps the books of a step, also when it throws.
  class Running {
   public:
    Running(TimeBudget& budget, std::string name, double share);
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;
    ~Running();
    [[nodiscard]] double end_s() const { return begin_s_ + granted_s_; }

   private:
    TimeBudget& budget_;
    std::string name_;
    double begin_s_, granted_s_;
  };

  double limit_s_;
  Seconds now_;
  double start_s_;
  std::vector<std::pair<std::string, double>> reserved_;
  std::vector<StepTime> steps_;
};

}  // namespace triskin::pipeline
