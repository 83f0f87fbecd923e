// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "triskin/base/parallel.hpp"
#include "triskin/mesh/extract.hpp"

namespace triskin::mesh {

/// Returns true when the time of a step is over; the step then ends with its best result so far. It is asked between
/// steps, from one thread; an empty function is never late.
using IsLate = std::function<bool()>;

/// Measures the time of one repair by the clock of its options, beginning when the object is made.
class RepairTime {
 public:
  explicit RepairTime(const ExtractOptions& options);

  /// Returns the time left for the whole repair, in s; ≤ 0 when it is over.
  [[nodiscard]] double left_s() const { return end_s_ - clock_s_(); }
  /// Starts the limit of a step: it is late after `share` (0 … 1) of the whole time, and when the whole time is over.
  [[nodiscard]] IsLate part(double share) const;
  /// Returns `share` of the whole time as seconds of processor time for a child process, ≥ 1.
  [[nodiscard]] unsigned cpu_s(double share) const;

 private:
  std::function<double()> clock_s_;
  double whole_s_, end_s_;
};

/// This many rays leave each side of a face when its view of the sky is measured.
inline constexpr int kVisibilityRays = 64, kMinVisibilityRays = 8;

/// Holds the cosine-weighted fraction of the sky that each of these faces sees above its front and its back; all faces
/// use the same ray directions. Cost: 2 · `rays` > 0 rays per face, on all cores.
struct Visibility {
  double front = 0.0, back = 0.0;
};
[[nodiscard]] std::vector<Visibility> visibility_of(const Mesh& mesh, const std::vector<FaceIndex>& faces,
                                                    int rays = kVisibilityRays);

/// Returns the number of faces that visibility_of() answers for in about `cpu_s` seconds of processor time, counted as
/// at least 0.2 s.
[[nodiscard]] std::size_t faces_asked_in(double cpu_s);

/// Returns how many rays per side of a face fit into `cpu_s` seconds of processor time: kMinVisibilityRays …
/// kVisibilityRays. In a soup of triangles no face can stand for another, but eight rays still tell inside from
/// outside.
[[nodiscard]] int rays_for(std::size_t faces, double cpu_s);

/// Measures the visibility of all faces in about `cpu_s` > 0 seconds of processor time, at least 0.2 s. In a larger
/// mesh neighbours that face much the same way share the answer of one of them; if there are still too many faces, each
/// sends fewer rays. The result depends on no clock.
[[nodiscard]] std::vector<Visibility> visibility_of_all(const Mesh& mesh, double cpu_s);

/// Turns parts that see more with their back, removes faces that see less than the fraction, and smooths ragged rims.
/// Cost: visibility_of_all().
[[nodiscard]] Mesh outer_faces(const Mesh& mesh, double visibility_fraction, double cpu_s);

/// One measurement of the visibility of all faces may take this fraction of ExtractOptions::repair_s; a repair makes up
/// to three.
inline constexpr double kVisibilityTimeShare = 0.12;

/// Makes a closed surface around the mesh (CGAL's alpha wrap) in a child process. Returns nothing when that needs more
/// than `cpu_s` seconds of processor time, is late, or fails.
[[nodiscard]] std::optional<Mesh> wrapped(const Mesh& mesh, double alpha_mm, double offset_mm, unsigned cpu_s,
                                          const IsLate& is_late);

/// Makes a closed surface at 0.9 cells around any triangles by marching tetrahedra on a grid; the result is always a
/// manifold that does not cross itself. Enclosed cavities are filled. Cost: one distance per grid node near the mesh, 5
/// bytes per node.
[[nodiscard]] Mesh grid_wrapped(const Mesh& mesh, double cell_mm);

/// Names two faces that pass through or touch each other, the lower one first; a face without area is paired with
/// itself.
using FacePair = std::pair<FaceIndex, FaceIndex>;

/// Returns the mesh with the faces of these pairs divided along their common lines, so that they meet in whole edges
/// (exact constructions; coordinates are rounded at the end). Corners of faces keep their numbers and come first.
[[nodiscard]] Mesh arranged(const Mesh& mesh, const std::vector<FacePair>& crossings);

/// Returns the sorted pairs of faces of a manifold that pass through or touch each other beyond a common edge or
/// corner, by exact predicates. The search runs in a child process on one thread. Cost: O(n log n) typical.
[[nodiscard]] std::vector<FacePair> crossing_faces(const Mesh& mesh, int threads = all_threads());

/// Returns true if there are any such pairs.
[[nodiscard]] bool crosses_itself(const Mesh& surface);

/// Measures both ways between the outside faces of the input and all of the result. largest_mm is a proved bound, also
/// when it is late; found_mm is a distance that occurs, at most 0.02 mm below the bound unless time or the number of
/// parts ran out. Equal triangles of both count as 0 without a search. The mean uses up to 20,000 places each way.
/// Cost: one or two closest-point searches per changed face typical, at most 640,000 more; when late from the start
/// 60,000 in all.
[[nodiscard]] Deviation deviation_between(const Mesh& input, const std::vector<bool>& outside, const Mesh& result,
                                          const IsLate& is_late = {});

/// Lists the parts of the faces that are not `counted` of which some point may be farther than within_mm from the
/// result. Cost: up to four closest-point searches per face, on all cores.
[[nodiscard]] std::vector<DroppedPart> parts_beyond(const Mesh& input, const std::vector<bool>& counted,
                                                    const Mesh& result, double within_mm);

/// Lists the parts of the `counted` faces of which at least 1 mm² is farther than within_mm from the result, with the
/// area that is; the deviation covers them too. Cost: as parts_beyond(), and one search for each 0.05 mm² near the
/// limit, at most some 160,000.
[[nodiscard]] std::vector<DroppedPart> missing_parts(const Mesh& input, const std::vector<bool>& counted,
                                                     const Mesh& result, double within_mm);

/// What joined() does with parts smaller than a module and with faces that no edge is free for.
enum class SmallParts {
  kDropped,  ///< counted and named in the report
  kKept      ///< all of the mesh stays; a face without a free edge stands alone
};

/// Makes a manifold, consistently oriented surface of a welded mesh; the first step of extract(). Adds to the report
/// what it turned and dropped, and sets its number of components. Errors: InputError when no part remains.
[[nodiscard]] Mesh joined(const Mesh& mesh, ExtractReport& report, SmallParts small_parts = SmallParts::kDropped);

/// Holds what the test of usable() finds. A late test states the tested fraction in the report (`tested`) and counts
/// the other crossings as absent.
struct UsableTest {
  std::optional<Mesh> joined;  ///< The value is missing when no part is as large as a module.
  bool is_usable = false;
};
[[nodiscard]] UsableTest test_usable(const Mesh& mesh, ExtractReport& report, const IsLate& is_late = {});

/// Makes what design() takes. Moves apart corners that only touch, then drops one face of each crossing pair until no
/// faces cross: the one that sees less of the sky, or the smaller one when late. Then closes slits, when late all or
/// none. Errors: InputError when nothing remains. Cost: one search for crossings per round; each round drops a face and
/// measures visibility for at most `visibility_s` s.
[[nodiscard]] Mesh remove_crossings(const Mesh& mesh, double visibility_s, ExtractReport& report,
                                    const IsLate& is_late = {});

/// Repairs the mesh so that usable() holds; fills the report's repair, deviation and dropped parts. Each step stops
/// after its fraction of `time`; when all of it is over, the first usable surface is returned. Errors: InputError when
/// no part as large as a module can be made.
[[nodiscard]] Mesh repaired(const Mesh& mesh, const ExtractOptions& options, const RepairTime& time,
                            ExtractReport& report, const ProgressSink& progress);

/// Divides the faces at the border of the keep-outs and removes those inside.
[[nodiscard]] Mesh without_keep_outs(const Mesh& mesh, const ExtractOptions& options);

/// Removes parts that lie in a closed part, whichever way that one faces (a cavity, a shell in a shell), because no
/// module can be placed there. Returns their number. No two faces of the mesh may cross. Cost: O(n), and O(n) for each
/// tested corner (17 at most) of each part in the box of a closed one.
int drop_enclosed(Mesh& mesh);

/// Turns closed parts that face inward and returns the number of turned faces. Parts in another closed part stay, since
/// they may be its cavities. Cost: as drop_enclosed().
int turn_outward(Mesh& mesh);

/// Returns the area of all faces, mm². Cost: linear.
[[nodiscard]] double area_of(const Mesh& mesh);

}  // namespace triskin::mesh
