// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/session/scheduler.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "fiber.hpp"
#include "triskin/link/forwarding_link.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::session {
namespace {

class Scheduler;

// The link as one task sees it: receive() hands control to the scheduler instead of blocking.
class TaskLink final : public link::ForwardingLink {
 public:
  TaskLink(Scheduler& scheduler, link::Link& link, const Task& task)
      : link::ForwardingLink(link), scheduler_(scheduler), task_(task), wire_(link.wire_of(task.node)), fiber_([this] {
          run();
        }) {}

  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override;
  // Frames of the other tasks on the wire may be sent before the answer.
  [[nodiscard]] std::uint64_t answer_us() const override;

  // The scheduler calls the following functions while the task is suspended.
  [[nodiscard]] int wire() const { return wire_; }
  [[nodiscard]] bool fresh() const { return state_ == State::kFresh; }
  [[nodiscard]] bool waiting() const { return state_ == State::kWaiting; }
  [[nodiscard]] bool ended() const { return state_ == State::kEnded; }
  [[nodiscard]] std::uint64_t wait_until_us() const { return wait_until_us_; }
  [[nodiscard]] std::exception_ptr outcome() const { return outcome_; }
  [[nodiscard]] bool wait_is_over() const {
    return woken_ || !inbox_.empty() || link_failure_ || now_us() >= wait_until_us_;
  }
  void wake() { woken_ = true; }
  void fail(std::exception_ptr failure) { link_failure_ = std::move(failure); }
  void deliver(const wire::CanFrame& frame) {
    if (!ended() && frame.extended && frame.id == wire::physical_id(wire::kTesterAddress, task_.node))
      inbox_.push_back(frame);
  }
  void resume();

 private:
  enum class State { kFresh, kWaiting, kEnded };
  void run();

  Scheduler& scheduler_;
  const Task& task_;
  const int wire_;
  State state_ = State::kFresh;
  std::uint64_t wait_until_us_ = 0;
  bool woken_ = false;
  std::deque<wire::CanFrame> inbox_;
  std::exception_ptr link_failure_, outcome_;
  Fiber fiber_;
};

// Runs in the caller's thread whenever no task runs.
class Scheduler {
 public:
  Scheduler(link::Link& link, std::span<const Task> tasks, int per_wire) : link_(link), per_wire_(per_wire) {
    for (const Task& task : tasks) tasks_.push_back(std::make_unique<TaskLink>(*this, link, task));
  }

  std::vector<std::exception_ptr> run() {
    std::size_t last = tasks_.size() - 1;
    while (const auto next = next_ready(last)) {
      TaskLink& task = *tasks_[*next];
      if (task.fresh()) ++under_way_[task.wire()];
      task.resume();
      if (task.ended()) --under_way_[task.wire()];
      last = *next;
    }
    std::vector<std::exception_ptr> outcomes;
    for (const auto& task : tasks_) outcomes.push_back(task->outcome());
    return outcomes;
  }

  [[nodiscard]] int under_way(int wire) const { return under_way_.at(wire); }
  // Takes the frames that have already arrived, without waiting.
  void poll_link() {
    constexpr std::uint64_t kLongest_us = 50'000;  // Frames may arrive faster than they are delivered.
    const std::uint64_t end_us = link_.now_us() + kLongest_us;
    for (auto frame = link_.receive(link_.now_us()); frame; frame = link_.receive(link_.now_us())) {
      deliver(*frame);
      if (link_.now_us() >= end_us) return;
    }
  }

 private:
  // Chooses round robin, starting after task `last`; waits for the link while no task can run. Empty means that all
  // tasks have ended.
  std::optional<std::size_t> next_ready(std::size_t last) {
    while (true) {
      for (std::size_t k = 1; k <= tasks_.size(); ++k) {
        const std::size_t index = (last + k) % tasks_.size();
        if (can_run(*tasks_[index])) return index;
      }
      TaskLink* const earliest = earliest_waiting();
      if (earliest == nullptr) return std::nullopt;
      wait_for_link(*earliest);
    }
  }
  [[nodiscard]] bool can_run(const TaskLink& task) {
    if (task.fresh()) return under_way_[task.wire()] < per_wire_;
    return task.waiting() && task.wait_is_over();
  }
  [[nodiscard]] TaskLink* earliest_waiting() const {
    TaskLink* earliest = nullptr;
    for (const auto& task : tasks_) {
      if (!task->waiting()) continue;
      if (earliest == nullptr || task->wait_until_us() < earliest->wait_until_us()) earliest = task.get();
    }
    return earliest;
  }
  void wait_for_link(TaskLink& earliest) {
    try {
      if (const auto frame = link_.receive(earliest.wait_until_us())) return deliver(*frame);
      for (const auto& task : tasks_) task->wake();  // Either a message channel has data, or the time has come.
    } catch (...) {
      earliest.fail(std::current_exception());  // The task fails as if it had waited alone.
    }
  }
  void deliver(const wire::CanFrame& frame) {
    for (const auto& task : tasks_) task->deliver(frame);
  }

  link::Link& link_;
  const int per_wire_;
  std::vector<std::unique_ptr<TaskLink>> tasks_;
  std::map<int, int> under_way_;  // Running tasks are counted by wire.
};

std::uint64_t TaskLink::answer_us() const {
  constexpr std::uint64_t kLongest_us = 10'000;  // A block of a table takes this long in classic frames at 125 kbit/s.
  return link_.answer_us() + static_cast<std::uint64_t>(scheduler_.under_way(wire_) - 1) * kLongest_us;
}

std::optional<wire::CanFrame> TaskLink::receive(std::uint64_t until_us) {
  if (inbox_.empty()) scheduler_.poll_link();
  if (inbox_.empty() && link_.now_us() < until_us) {
    wait_until_us_ = until_us;
    state_ = State::kWaiting;
    fiber_.suspend();
    if (link_failure_) std::rethrow_exception(std::exchange(link_failure_, nullptr));
  }
  if (inbox_.empty()) return std::nullopt;
  const wire::CanFrame frame = inbox_.front();
  inbox_.pop_front();
  return frame;
}

void TaskLink::resume() {
  woken_ = false;
  try {
    fiber_.resume();
  } catch (...) {  // If the system refuses a thread, this task fails and the others continue.
    outcome_ = std::current_exception();
    state_ = State::kEnded;
  }
}

void TaskLink::run() {
  try {
    Bus bus(*this);
    task_.run(bus);
  } catch (...) {
    outcome_ = std::current_exception();
  }
  state_ = State::kEnded;
}

}  // namespace

std::vector<std::exception_ptr> run_tasks(link::Link& link, std::span<const Task> tasks, int per_wire) {
  if (tasks.empty()) return {};
  return Scheduler(link, tasks, std::max(1, per_wire)).run();
}

}  // namespace triskin::session
