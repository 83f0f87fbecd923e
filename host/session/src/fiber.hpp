// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace triskin::device {

/// A function with a stack of its own that runs only inside resume(). Owner and body never run at the same time; each
/// switch is a synchronization point, so data shared by the two need no lock. Stands on an operating-system thread:
/// docs/decisions/0020-tasks-on-threads.md.
class Fiber {
 public:
  /// `body` must not throw; it has not begun when this returns.
  explicit Fiber(std::function<void()> body) : body_(std::move(body)) {}
  /// The body has ended, or was never resumed.
  ~Fiber() = default;
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  /// Owner: runs the body until it suspends or ends. Not after it has ended. Throws std::system_error when the system
  /// refuses the thread, in the first call only; the body counts as never resumed then.
  void resume() {
    std::unique_lock lock(mutex_);
    running_ = true;
    if (thread_.joinable()) {
      switched_.notify_one();
    } else {
      thread_ = std::jthread([this] {
        body_();
        const std::lock_guard ending(mutex_);
        yield_to_owner();
      });
    }
    switched_.wait(lock, [this] { return !running_; });
  }
  /// Body: returns control to resume(); returns when the owner resumes again.
  void suspend() {
    std::unique_lock lock(mutex_);
    yield_to_owner();
    switched_.wait(lock, [this] { return running_; });
  }

 private:
  void yield_to_owner() {
    running_ = false;
    switched_.notify_one();
  }

  std::function<void()> body_;
  // Not two semaphores: those of libstdc++ 12 spin, and on a busy computer a switch then costs milliseconds.
  std::mutex mutex_;
  std::condition_variable switched_;
  bool running_ = false;  // True while it is the body's turn.
  std::jthread thread_;   // Declared last, so that it is joined before the others are destroyed.
};

}  // namespace triskin::device
