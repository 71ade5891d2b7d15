// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <string>

namespace leaflight {

// Thrown by a computation whose progress was cancelled.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("The computation was cancelled.") {}
};

// The state that a computation shares with observers in other threads: its work so far, and
// requests to end.
class Progress {
 public:
  void cancel() { cancelled_ = true; }
  bool cancelled() const { return cancelled_; }
  // Asks a computation in passes to end after the current pass.
  void stop() { stopped_ = true; }
  bool stopped() const { return stopped_; }
  double fraction() const { return std::min(1.0, done_.load() / total_); }
  std::string stage() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return stage_;
  }

  // Returns the rays and lines traced so far.
  std::uint64_t rays() const { return rays_; }
  void count_rays(std::uint64_t traced) { rays_ += traced; }

  // Sets the expected work. Its unit is about one ray.
  void expect(double total) { total_ = total > 0 ? total : 1; }
  // Adds to the expected work, which stays unknown if it is infinite.
  void expect_more(double work) { total_ = total_ + work; }
  void begin(const std::string& stage) {
    const std::lock_guard<std::mutex> lock(mutex_);
    stage_ = stage;
  }
  double work() const { return done_; }
  void advance(double work) {
    double done = done_.load();
    while (!done_.compare_exchange_weak(done, done + work)) {
    }
  }
  void check() const {
    if (cancelled()) throw Cancelled();
  }

 private:
  std::atomic<bool> cancelled_{false}, stopped_{false};
  std::atomic<std::uint64_t> rays_{0};
  std::atomic<double> done_{0};
  std::atomic<double> total_{1};
  mutable std::mutex mutex_;
  std::string stage_;
};

}  // namespace leaflight
