// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace triskin::pipeline {

/// Records the time that a step was granted and the time that it took.
struct StepTime {
  std::string name;
  double granted_s = 0.0;
  double used_s = 0.0;
};

/// Shares a time limit among the steps of a job. A step is granted a share of the time that is left when it begins,
/// minus the time reserved for later steps; what it does not use remains for the steps after it. Measure a reserve
/// while the job runs (on the first item of a step, or on the opposite step: writing a file takes about as long as
/// reading it did), so that no speed of a machine is assumed. Not thread-safe, but any thread may ask a deadline from
/// is_over().
class TimeBudget {
 public:
  using Seconds = std::function<double()>;  ///< The clock must never go back.

  /// Starts the steady clock. Errors: InputError for a limit that is not positive.
  explicit TimeBudget(double limit_s);
  /// Starts with a clock of the caller, so that tests need not wait. Errors: as above.
  TimeBudget(double limit_s, Seconds now);

  [[nodiscard]] double limit_s() const { return limit_s_; }
  [[nodiscard]] double used_s() const { return now_() - start_s_; }
  /// Returns the time that is neither used nor reserved; negative if the steps took longer than the limit.
  [[nodiscard]] double left_s() const;

  /// Keeps `seconds` free until the step with this name begins; a second call for the same step replaces the first.
  void reserve(std::string_view step, double seconds);

  /// Runs a step that should end when used_s() reaches the argument of `work`: `share` (0 … 1) of left_s() from now.
  template <class Work>
  auto run(std::string name, double share, Work&& work) {
    const Running running(*this, std::move(name), share);
    return std::forward<Work>(work)(running.end_s());
  }

  /// Returns a deadline: a function that is true from `end_s` after the start on. It holds a copy of the clock, so it
  /// may outlive the budget.
  [[nodiscard]] std::function<bool()> is_over(double end_s) const;

  /// Returns the steps that have ended, in the order of their ends.
  [[nodiscard]] const std::vector<StepTime>& steps() const { return steps_; }

 private:
  // The destructor records the step, so that one that throws is recorded too.
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
