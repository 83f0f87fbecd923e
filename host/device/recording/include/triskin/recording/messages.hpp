// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/taxel_frames.hpp"

/// docs/recording.md describes the messages of a recording in CDR, and their definitions for ROS 2.
namespace triskin::recording {

class CdrWriter;

struct ModuleSample {
  layout::ModuleId module;
  std::uint64_t link_time_us = 0;  ///< The sample arrived at this time of the link's clock.
  wire::TaxelFrame sample;         ///< Here `module` is the row in the controller's table.
  std::uint64_t sampled_ns = 0;  ///< The sample was taken at this time since 1970, within ± error_us; 0 means unknown.
  std::uint32_t error_us = kNoBound;
  static constexpr std::uint32_t kNoBound = UINT32_MAX;
  /// When a recording is read, this is the patch whose controller read the module instead of its own; −1 means that
  /// its own did, or that the recording does not say.
  layout::PatchIndex adopter = layout::PatchIndex::none();
  bool operator==(const ModuleSample&) const = default;
};

/// The position of a pressed taxel is in the mesh frame.
struct PressedTaxel {
  layout::ModuleId module;
  layout::TaxelIndex taxel;
  double change_counts = 0.0;  ///< The change from the rest value is above 0.
  design::Vec3 position_mm{0, 0, 0}, normal{0, 0, 0};
  /// The calibration gives this force on the taxel's area of skin; 0 means that there is no calibration.
  double force_n = 0.0;
};

/// A contact is a pressed region of the skin, in the mesh frame.
struct Contact {
  design::Vec3 position_mm{0, 0, 0};  ///< The position lies on the skin.
  design::Vec3 normal{0, 0, 0};       ///< The unit vector points outward.
  double change_counts = 0.0;         ///< It sums over the taxels.
  double force_n = 0.0;               ///< The force acts against the normal and is 0 without a calibration.
  double area_mm2 = 0.0;              ///< The contact presses this area of skin.
  std::vector<PressedTaxel> taxels;   ///< The strongest comes first, and there is at least one.
};
/// Two taxels of one contact may be this far apart: those of a module are at 7 mm, those of neighbouring modules at up
/// to 10 mm.
inline constexpr double kContactReach_mm = 12.0;
/// Groups taxels into contacts, the strongest first. Two taxels belong together when they lie within kContactReach_mm
/// and do not face away from each other, as the two sides of a thin part do. Taxels that measure temperature are left
/// out. `module_area_mm2` is the area of one module, which its pressure taxels share equally. Throws nothing of its
/// own. Cost: O(taxels²).
[[nodiscard]] std::vector<Contact> gather_contacts(std::span<const PressedTaxel> taxels, double module_area_mm2);

struct MessageType {
  std::string_view name, definition;
};
extern const MessageType kRawFrameType, kLayoutType, kReadersType, kContactsType, kPointCloudType, kTransformsType;

/// Messages of a recording use this frame for coordinates: that of the mesh, in m.
inline constexpr std::string_view kMeshFrame = "skin";
/// Appends a std_msgs/Header. `stamp_ns` counts from 1970.
void put_header(CdrWriter& w, std::uint64_t stamp_ns, std::string_view frame_id);

/// Encodes a raw frame. The samples must be from one controller, have the same sample number and device times within 30
/// min, and not be empty. `numbers` are those of all modules of the design (ModuleLayout::numbers; empty: no gaps), as
/// for the other messages. Throws nothing of its own.
[[nodiscard]] std::vector<std::uint8_t> encode_raw(std::span<const ModuleSample> samples,
                                                   std::span<const int> numbers = {});
/// Decodes a raw frame; a module that the design lacks becomes −1. Returns nullopt if it is malformed.
[[nodiscard]] std::optional<std::vector<ModuleSample>> decode_raw(Bytes message, std::span<const int> numbers = {});
/// Encodes the message with the position of each taxel, lengths in m. Throws std::out_of_range for a patch that names a
/// module the layout lacks. Cost: linear.
[[nodiscard]] std::vector<std::uint8_t> encode_layout(const design::Design& design, std::uint64_t stamp_ns,
                                                      std::string_view frame_id = kMeshFrame);
/// Converts the counts of a contact to a force. If neither field is set, the unit of forces is "counts".
struct Calibration {
  double newton_per_count = 0.0;  ///< Each count of a contact's sum is this force, > 0; 0 means unknown.
  bool by_taxel = false;  ///< The contacts have force_n from the calibration of the skin, which takes precedence.
};
/// Encodes the message of contacts, lengths in m. Throws nothing of its own.
[[nodiscard]] std::vector<std::uint8_t> encode_contacts(std::span<const Contact> contacts, std::uint64_t stamp_ns,
                                                        std::string_view frame_id = kMeshFrame,
                                                        const Calibration& calibration = {},
                                                        std::span<const int> numbers = {});

/// The pose of a frame in its parent is in metres and has a unit quaternion x, y, z, w.
struct Pose {
  std::array<double, 3> translation_m{0.0, 0.0, 0.0};
  std::array<double, 4> rotation{0.0, 0.0, 0.0, 1.0};
};
/// Encodes a tf2_msgs/msg/TFMessage with one transform from `parent` to `child`. `stamp_ns` counts from 1970. Throws
/// nothing of its own.
[[nodiscard]] std::vector<std::uint8_t> encode_transform(std::string_view parent, std::string_view child,
                                                         const Pose& pose, std::uint64_t stamp_ns);

/// Publishes all taxels of a design with their latest values as sensor_msgs/msg/PointCloud2.
class PointCloud {
 public:
  /// Starts with every taxel, none of them valid yet. Throws std::out_of_range as design::wiring_of.
  explicit PointCloud(const design::Design& design);
  /// Updates the values of a module.
  void add(const ModuleSample& sample);
  /// Returns true when every module was heard, so that no point has the placeholder value 0.
  [[nodiscard]] bool is_complete() const { return heard_ == points_.size(); }
  /// Encodes one point per taxel: x, y, z (m), normal_x, normal_y, normal_z, module, value (counts), valid (1 or 0),
  /// taxel. Throws nothing of its own.
  [[nodiscard]] std::vector<std::uint8_t> encode(std::uint64_t stamp_ns, std::string_view frame_id = kMeshFrame) const;

 private:
  struct Point {
    design::Vec3 position_mm, normal;
    std::uint16_t value = 0;
    bool valid = false;
  };
  std::vector<std::array<Point, layout::kTaxelsPerModule>> points_;  // The points are indexed by module.
  std::vector<bool> is_heard_;
  std::vector<int> numbers_;
  std::size_t heard_ = 0;
};

}  // namespace triskin::recording
