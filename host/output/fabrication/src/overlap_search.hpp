// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <random>
#include <vector>

#include "overlap_field.hpp"
#include "silhouette.hpp"

namespace triskin::fabrication {

/// Shortens a layout by guided local search on its overlap (Egeblad, Nielsen and Odgaard, European Journal of
/// Operational Research 183, 2007); the order of the moves and the weights follow "sparrow" (Gardeyn, Vanden Berghe and
/// Wauters, 2025). The room is shortened, islands may overlap, and one after the other moves to where it overlaps
/// least. Pairs that still overlap gain weight, until no pair does or the search gives up and exchanges two islands.
class OverlapSearch {
 public:
  /// A sheet has `width` × `height` pixels. The silhouettes must outlive the search, and every island must fit an
  /// empty sheet in one of its turns.
  OverlapSearch(const Silhouettes& silhouettes, int width, int height, std::uint64_t seed);

  /// Returns a layout without overlap that is at most as long as `start`, which must not overlap. `work` counts
  /// elementary steps; 10⁹ take about one second. Deterministic for seed, start and work.
  [[nodiscard]] std::vector<PixelPlace> shorten(const std::vector<PixelPlace>& start, std::int64_t work);

 private:
  struct Candidate {
    std::int64_t overlap;
    PixelPlace place;
  };

  [[nodiscard]] const Silhouette& silhouette(std::size_t island, const PixelPlace& p) const;
  [[nodiscard]] int length_of(const std::vector<PixelPlace>& places) const;
  [[nodiscard]] int shortest_length() const;
  [[nodiscard]] int target_below(int length, bool in_large_steps) const;
  [[nodiscard]] int sheet_count() const { return (length_ + height_ - 1) / height_; }
  [[nodiscard]] int rows_of(int sheet) const;
  [[nodiscard]] bool fits(std::size_t island, const PixelPlace& p) const;

  bool separate(int length);
  void move_inside();
  void move_overlapping();
  void raise_weights();
  void exchange_two();

  [[nodiscard]] PixelPlace best_place(std::size_t island);
  void fill_field(std::size_t island, int sheet);
  [[nodiscard]] std::vector<Candidate> candidates(std::size_t island, int sheet);
  void add_candidates(std::size_t island, const PixelPlace& turned, std::vector<Candidate>& found);
  [[nodiscard]] Candidate refined(std::size_t island, const PixelPlace& from);

  [[nodiscard]] std::int64_t pair_overlap(std::size_t a, std::size_t b);
  void measure(std::size_t island);
  [[nodiscard]] std::int64_t overlap_of(std::size_t island) const;
  [[nodiscard]] std::int64_t total_overlap() const;
  [[nodiscard]] std::size_t pair(std::size_t a, std::size_t b) const { return a * silhouettes_.size() + b; }

  const Silhouettes& silhouettes_;
  Silhouettes coarse_;
  int width_, height_;
  std::mt19937_64 dice_;
  OverlapField field_;
  std::vector<float> estimates_;

  int length_ = 0;  // The rows that may be used: those of all sheets but the last, and some of the last.
  std::vector<PixelPlace> places_;
  std::vector<double> weights_;         // Both matrices are symmetric; pair() gives the index.
  std::vector<std::int64_t> overlaps_;  // In pixels.
  std::int64_t work_left_ = 0;
};

}  // namespace triskin::fabrication
