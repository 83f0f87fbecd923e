// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/scans.hpp"

#include <chrono>
#include <random>

#include "kernels/evaluator.hpp"

namespace triskin::placement {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kDescents = 40;  // PlacementMethod::kDescent makes this many random starts.

class Scan {
 public:
  Scan(const PreparedPolygon& polygon, const TileGrid& grid, const PlacementOptions& options)
      : polygon_(polygon),
        options_(options),
        evaluator_(polygon, grid),
        period_(grid.period_rad),
        pitch_(grid.row_step_mm),
        height_(grid.row_height_mm) {
    if (options.time_limit_s > 0) {
      deadline_ = Clock::now() +
                  std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.time_limit_s));
    }
  }

  // Takes the best of the six axis steps while it is no worse, halving the step.
  void descend(Motion at) {
    int value = try_motion(at);
    for (double step = 4.0; step > 0.05; step *= 0.5) {
      for (const auto& [dx, dy, dt] :
           {std::array{1., 0., 0.}, {-1., 0., 0.}, {0., 1., 0.}, {0., -1., 0.}, {0., 0., 1.}, {0., 0., -1.}}) {
        const Motion next{at.x + step * dx, at.y + step * dy, at.theta + step * dt / std::max(1.0, polygon_.radius_mm)};
        const int n_next = try_motion(next);
        if (n_next > value) {
          value = n_next;
          at = next;
        }
      }
    }
  }
  [[nodiscard]] const ScanResult& best() const { return best_; }

  ScanResult run() {
    switch (options_.method) {
      case PlacementMethod::kScanEdges:
        edges_on_grid_lines(false);
        break;
      case PlacementMethod::kScanSlides:
        edges_on_grid_lines(true);
        break;
      case PlacementMethod::kScanShifts:
        translations(0.0, 1.0);
        break;
      case PlacementMethod::kScanAngles:
        angles_and_translations(60, 1.0);
        break;
      case PlacementMethod::kScanEdgeAngles:
        edge_angles_and_translations(2.0);
        break;
      case PlacementMethod::kRandom:
        random_placements(2000);
        break;
      default:
        random_descents(kDescents);
        break;
    }
    return best_;
  }

 private:
  int try_motion(const Motion& m) {
    ++best_.evaluations;
    const int n = evaluator_.count(m, -options_.tolerance_mm);
    if (n > best_.modules) {
      best_.modules = n;
      best_.motion = m;
    }
    return n;
  }
  [[nodiscard]] bool out_of_time() const { return Clock::now() > deadline_; }

  // Turns the polygon so that the edge is parallel to a grid line, and puts its first end on a grid vertex.
  [[nodiscard]] Motion edge_on_line(const std::array<Vec2, 2>& edge) const {
    const Vec2 d = edge[1] - edge[0];
    const double theta = -std::atan2(d.y(), d.x());
    const double c = std::cos(theta), s = std::sin(theta);
    return {-(c * edge[0].x() - s * edge[0].y()), -(s * edge[0].x() + c * edge[0].y()), theta};
  }

  void edges_on_grid_lines(bool slide) {
    for (const auto& edge : polygon_.edges) {
      Motion m = edge_on_line(edge);
      const int steps = slide ? 10 : 1;
      for (int k = 0; k < steps && !out_of_time(); ++k, m.x += pitch_ / steps) try_motion(m);
    }
  }

  void translations(double theta, double step_mm) {
    for (double y = 0; y < height_ && !out_of_time(); y += step_mm) {
      for (double x = 0; x < pitch_; x += step_mm) try_motion({x, y, theta});
    }
  }

  void angles_and_translations(int n_angles, double step_mm) {
    for (int k = 0; k < n_angles && !out_of_time(); ++k) translations(period_ * k / n_angles, step_mm);
  }

  void edge_angles_and_translations(double step_mm) {
    for (const auto& edge : polygon_.edges) {
      if (out_of_time()) return;
      translations(edge_on_line(edge).theta, step_mm);
    }
  }

  Motion random_motion() {
    const auto unit = [&] { return static_cast<double>(random_() >> 11) * 0x1p-53; };
    const double x = unit() * pitch_, y = unit() * height_;
    return {x, y, unit() * period_};
  }

  void random_placements(int n) {
    for (int k = 0; k < n && !out_of_time(); ++k) try_motion(random_motion());
  }

  void random_descents(int n) {
    for (int k = 0; k < n && !out_of_time(); ++k) descend(random_motion());
  }

  const PreparedPolygon& polygon_;
  const PlacementOptions& options_;
  Evaluator evaluator_;
  const double period_, pitch_, height_;
  Clock::time_point deadline_ = Clock::time_point::max();
  std::mt19937_64 random_{options_.seed};
  ScanResult best_;
};

}  // namespace

ScanResult run_scan(const PreparedPolygon& polygon, const TileGrid& grid, const PlacementOptions& options) {
  return Scan(polygon, grid, options).run();
}

ScanResult descend(const PreparedPolygon& polygon, const TileGrid& grid, double tolerance_mm, const Motion& start) {
  PlacementOptions options;
  options.tolerance_mm = tolerance_mm;
  Scan scan(polygon, grid, options);
  scan.descend(start);
  return scan.best();
}

}  // namespace triskin::placement
