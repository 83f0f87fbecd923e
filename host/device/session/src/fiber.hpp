// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace triskin::session {

/// A fiber is a function with its own stack that runs only inside resume(). Owner and body never run at the same time;
/// each switch is a synchronization point, so data that both use needs no lock. It is implemented with an
/// operating-system thread: docs/decisions.md.
class Fiber {
 public:
  /// `body` must not throw; it has not started when the constructor returns.
  explicit Fiber(std::function<void()> body) : body_(std::move(body)) {}
  /// Requires that the body has ended or was never resumed.
  ~Fiber() = default;
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  /// Called by the owner: runs the body until it suspends or ends; not allowed after it has ended. Throws
  /// std::system_error, in the first call only, when the system refuses the thread; the body then counts as never
  /// resumed.
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
  /// Called by the body: returns control to resume(), and returns when the owner resumes again.
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
  // Semaphores of libstdc++ 12 would spin, and on a busy computer a switch would then cost milliseconds.
  std::mutex mutex_;
  std::condition_variable switched_;
  bool running_ = false;  // True means that it is the body's turn.
  std::jthread thread_;   // The thread is declared last, so that it is joined before the other members are destroyed.
};

}  // namespace triskin::session
