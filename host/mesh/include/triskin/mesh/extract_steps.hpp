// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "triskin/base/parallel.hpp"
#include "triskin/mesh/extract.hpp"

namespace triskin::geometry {

/// True when the time of a part is over, which then ends with the best so far. Asked between steps, from one thread; an
/// empty one is never late.
using IsLate = std::function<bool()>;

/// The time of one repair, by the clock of its options; it begins with the object.
class RepairTime {
 public:
  explicit RepairTime(const ExtractOptions& options);

  /// Time left for the whole repair, s; ≤ 0 when it is over.
  [[nodiscard]] double left_s() const { return end_s_ - clock_s_(); }
  /// Limit of a part that begins now: late after `share` (0 … 1) of the whole, and when the whole is over.
  [[nodiscard]] IsLate part(double share) const;
  /// `share` of the whole as seconds of processor time for a child process, ≥ 1.
  [[nodiscard]] unsigned cpu_s(double share) const;

 private:
  std::function<double()> clock_s_;
  double whole_s_, end_s_;
};

/// Rays for each side of a face that is asked what it sees of the sky.
inline constexpr int kVisibilityRays = 64, kMinVisibilityRays = 8;

/// Cosine-weighted share of the sky that each of these faces sees above its front and its back (directions that
/// repeat). Cost: 2 · `rays` > 0 rays a face asked, on all cores.
struct Visibility {
  double front = 0.0, back = 0.0;
};
[[nodiscard]] std::vector<Visibility> visibility_of(const Mesh& mesh, const std::vector<int>& faces,
                                                    int rays = kVisibilityRays);

/// Number of faces that visibility_of() answers for in about `cpu_s` seconds of processor time, counted as at least 0.2
/// s.
[[nodiscard]] std::size_t faces_asked_in(double cpu_s);

/// Rays for each side of so many faces that fit into `cpu_s` seconds of processor time: kMinVisibilityRays …
/// kVisibilityRays. A soup has too many faces of which none stands for another: eight rays still tell inside from
/// outside.
[[nodiscard]] int rays_for(std::size_t faces, double cpu_s);

/// The same of all faces in about `cpu_s` > 0 seconds of processor time, at least 0.2 s: of a mesh with too many faces
/// for that, neighbours that face much the same way share the answer of one of them, and where those are still too many
/// each sends fewer rays. Depends on no clock.
[[nodiscard]] std::vector<Visibility> visibility_of_all(const Mesh& mesh, double cpu_s);

/// Parts that see more with their back are turned; faces that see less than the fraction go, ragged rims evened out.
/// Cost: visibility_of_all().
[[nodiscard]] Mesh outer_faces(const Mesh& mesh, double visibility_fraction, double cpu_s);

/// Share of ExtractOptions::repair_s that one look at the sky of all faces may take: up to three are taken.
inline constexpr double kVisibilityTimeShare = 0.12;

/// Closed surface around the mesh (CGAL's alpha wrap), made in a child process; nothing when that needs more than
/// `cpu_s` seconds of processor time, is late, or fails.
[[nodiscard]] std::optional<Mesh> wrapped(const Mesh& mesh, double alpha_mm, double offset_mm, unsigned cpu_s,
                                          const IsLate& is_late);

/// Closed surface at 0.9 cells around any triangles by marching tetrahedra on a grid: a manifold that does not cross
/// itself, always. What is enclosed is not part of it. Cost: one distance a node near the mesh, 5 bytes a node.
[[nodiscard]] Mesh grid_wrapped(const Mesh& mesh, double cell_mm);

/// The mesh with the faces of these pairs divided along their common lines, so that they meet in whole edges (exact
/// constructions; coordinates are rounded at the end). Corners of faces keep their numbers and come first.
[[nodiscard]] Mesh arranged(const Mesh& mesh, const std::vector<std::pair<int, int>>& crossings);

/// Pairs of faces that pass through or touch each other beyond a common edge or corner, by exact predicates. The mesh
/// is a manifold. Sorted. In a child process on one thread. Cost: O(n log n) typical.
[[nodiscard]] std::vector<std::pair<int, int>> crossing_faces(const Mesh& mesh, int threads = all_threads());

/// True if there are any.
[[nodiscard]] bool crosses_itself(const Mesh& surface);

/// Distances both ways between the outside faces of the input and all of the result. largest_mm is a proved bound,
/// also when it is late; found_mm is a distance that occurs, and 0.02 mm below the bound at most when neither time nor
/// the number of parts ran out. Equal triangles of both count as 0 without a search. The mean is that of up to 20,000
/// places each way. Cost: one or two closest-point searches a changed face typical, at most 640,000 more; when late
/// from the start 60,000 in all.
[[nodiscard]] Deviation deviation_between(const Mesh& input, const std::vector<bool>& outside, const Mesh& result,
                                          const IsLate& is_late = {});

/// Repair of the topology alone, the first step of extract(). Errors: InputError when no part is as large as a module.
[[nodiscard]] Extraction repair_topology(const Mesh& mesh);

/// What the test of usable() finds. Late, it says so in the report (`tested`) and takes what it did not find for
/// absent.
struct UsableTest {
  std::optional<Extraction> joined;  ///< It is empty when no part is as large as a module.
  bool is_usable = false;
};
[[nodiscard]] UsableTest test_usable(const Mesh& mesh, const IsLate& is_late = {});

/// Makes what design() takes: moves corners apart that only touch, then drops faces that still cross, until none does:
/// of two the one that sees less of the sky, when late the smaller one. Then closes slits, when late all or none.
/// Errors: InputError when nothing is left. Cost: a search for crossings a round; each round drops a face, of looks at
/// the sky `visibility_s` s a round at most.
[[nodiscard]] Extraction remove_crossings(const Mesh& mesh, double visibility_s, const IsLate& is_late = {});

/// Repairs so that usable() holds; fills the report's repair and deviation. Each part gives up in its share of `time`;
/// what is made when all of it is over is the first surface that is usable.
/// Errors: InputError when no part as large as a module can be made.
[[nodiscard]] Extraction repaired(const Mesh& mesh, const ExtractOptions& options, const RepairTime& time,
                                  const ProgressSink& progress);

/// Divides the faces at the border of the keep-outs and takes away what lies in them.
[[nodiscard]] Mesh without_keep_outs(const Mesh& mesh, const ExtractOptions& options);

/// Takes parts away that lie in a closed part, whichever side that one shows: a cavity, a shell in a shell. No module
/// can be brought there. How many. Of a mesh of which no two faces cross. Cost: O(n), and O(n) for each corner that is
/// asked (17 at most) of each part in the box of a closed one.
int drop_enclosed(Mesh& mesh);

/// Turns closed parts whose front is inside; those in another closed part stay: they may be its cavities. The number
/// of faces turned. Cost: as drop_enclosed().
int turn_outward(Mesh& mesh);

[[nodiscard]] double area_of(const Mesh& mesh);

}  // namespace triskin::geometry
