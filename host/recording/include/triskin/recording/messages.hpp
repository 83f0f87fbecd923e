// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/taxel_frames.hpp"

/// The messages of a recording, in CDR, and their definitions as ROS 2 reads them (docs/recording.md).
namespace triskin::recording {

class CdrWriter;

/// One sample of one module.
struct ModuleSample {
  int module = 0;                  ///< It is an id of the design.
  std::uint64_t link_time_us = 0;  ///< It came at this time of the link's clock.
  wire::TaxelFrame sample;         ///< Its `module` is the row in the controller's table.
  std::uint64_t sampled_ns = 0;    ///< It was taken at this time since 1970, within ± error_us; 0 means unknown.
  std::uint32_t error_us = kNoBound;
  static constexpr std::uint32_t kNoBound = UINT32_MAX;
  /// Patch whose controller read the module in place of its own, in a recording that is read; -1: its own did, or the
  /// recording does not say so.
  int adopter = -1;
  bool operator==(const ModuleSample&) const = default;
};

/// A taxel under pressure, mesh frame.
struct PressedTaxel {
  int module = 0, taxel = 0;
  double change_counts = 0.0;  ///< It is the change against the rest value, above 0.
  design::Vec3 position_mm{0, 0, 0}, normal{0, 0, 0};
  /// The calibration gives this force on the taxel's area of skin; 0 means that there is none.
  double force_n = 0.0;
};

/// A region of the skin under pressure, mesh frame.
struct Contact {
  design::Vec3 position_mm{0, 0, 0};  ///< It lies on the skin.
  design::Vec3 normal{0, 0, 0};       ///< It is an outward unit vector.
  double change_counts = 0.0;         ///< It sums over the taxels.
  double force_n = 0.0;               ///< It acts against the normal, and is 0 without a calibration.
  double area_mm2 = 0.0;              ///< So much skin is pressed.
  std::vector<PressedTaxel> taxels;   ///< The strongest comes first, and there is at least one.
};
/// Farthest that two taxels of one contact lie from the next one: those of a module are 7 mm apart, those of neighbours
/// up to 10 mm.
inline constexpr double kContactReach_mm = 12.0;
/// Gathers taxels to contacts, the strongest first: two belong together when they lie within kContactReach_mm and do
/// not face away from each other (the two sides of a thin part). Taxels that measure temperature are left out.
/// `module_area_mm2`: area of one module, which its pressure taxels share equally. Throws nothing of its own. Cost:
/// O(taxels²).
[[nodiscard]] std::vector<Contact> gather_contacts(std::span<const PressedTaxel> taxels, double module_area_mm2);

/// Name and definition of a message type.
struct MessageType {
  std::string_view name, definition;
};
extern const MessageType kRawFrameType, kLayoutType, kReadersType, kContactsType, kPointCloudType, kTransformsType;

/// Frame of a skin's coordinates in the messages of a recording: that of the mesh, in m.
inline constexpr std::string_view kMeshFrame = "skin";
/// Appends std_msgs/Header. `stamp_ns`: since 1970.
void put_header(CdrWriter& w, std::uint64_t stamp_ns, std::string_view frame_id);

/// The raw frame of samples of one controller that have one sample number and device times within 30 min; not empty.
/// Throws nothing of its own.
[[nodiscard]] std::vector<std::uint8_t> encode_raw(std::span<const ModuleSample> samples);
/// The samples of a raw frame; nullopt: it is malformed.
[[nodiscard]] std::optional<std::vector<ModuleSample>> decode_raw(Bytes message);
/// The message that says where each taxel is, lengths in m. Throws std::out_of_range for a patch that names a module
/// the layout lacks. Cost: linear.
[[nodiscard]] std::vector<std::uint8_t> encode_layout(const design::Design& design, std::uint64_t stamp_ns,
                                                      std::string_view frame_id = kMeshFrame);
/// What the counts of a contact are worth. Without either the unit of forces is "counts".
struct Calibration {
  double newton_per_count = 0.0;  ///< It is the force for each count of the sum over a contact, > 0; 0 means unknown.
  bool by_taxel = false;  ///< The contacts have force_n from the calibration of the skin, which takes precedence.
};
/// The message of contacts, lengths in m. Throws nothing of its own.
[[nodiscard]] std::vector<std::uint8_t> encode_contacts(std::span<const Contact> contacts, std::uint64_t stamp_ns,
                                                        std::string_view frame_id = kMeshFrame,
                                                        const Calibration& calibration = {});

/// Pose of a frame in its parent: metres, and a unit quaternion x, y, z, w.
struct Pose {
  std::array<double, 3> translation_m{0.0, 0.0, 0.0};
  std::array<double, 4> rotation{0.0, 0.0, 0.0, 1.0};
};
/// tf2_msgs/msg/TFMessage with one transform from `parent` to `child`. `stamp_ns`: since 1970. Throws nothing of its
/// own.
[[nodiscard]] std::vector<std::uint8_t> encode_transform(std::string_view parent, std::string_view child,
                                                         const Pose& pose, std::uint64_t stamp_ns);

/// All taxels of a design as sensor_msgs/msg/PointCloud2, with their latest values.
class PointCloud {
 public:
  /// Knows every taxel, none of them valid yet. Throws std::out_of_range as design::wiring_of.
  explicit PointCloud(const design::Design& design);
  /// Takes the values of a module.
  void add(const ModuleSample& sample);
  /// True when every module was heard: then no point has the value 0 that stands for nothing.
  [[nodiscard]] bool is_complete() const { return heard_ == points_.size(); }
  /// One point a taxel: x, y, z (m), normal_x, normal_y, normal_z, module, value (counts), valid (1 or 0), taxel.
  /// Throws nothing of its own.
  [[nodiscard]] std::vector<std::uint8_t> encode(std::uint64_t stamp_ns, std::string_view frame_id = kMeshFrame) const;

 private:
  struct Point {
    design::Vec3 position_mm, normal;
    std::uint16_t value = 0;
    bool valid = false;
  };
  std::vector<std::array<Point, layout::kTaxelsPerModule>> points_;  // Indexed by module.
  std::vector<bool> is_heard_;                                       // Indexed by module.
  std::size_t heard_ = 0;
};

}  // namespace triskin::recording
