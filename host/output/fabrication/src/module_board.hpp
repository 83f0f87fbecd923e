// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/module.hpp"

/// Defines the copper of the strapped module: the only owner of its pads, contacts and rings. It is a proposal until
/// one is built (docs/fabrication.md). Frame of the module: seen from the touch side, origin at the centroid, x along
/// the side of port A to the right, y up, mm. Port p is port A turned by 120° · p counter-clockwise.
namespace triskin::fabrication {

/// Every port carries power, then data and clock of each line.
inline constexpr std::size_t kBusNets = 2 + 2 * layout::kLines;
inline constexpr std::array<std::string_view, kBusNets> kBusNetNames{"GND",  "VDD",  "SDA0", "SCL0", "SDA1",
                                                                     "SCL1", "SDA2", "SCL2", "SDA3", "SCL3"};
/// Returns the number of the data line of I²C line `line`; its clock has the next number.
[[nodiscard]] constexpr std::size_t data_net(int line) {
  return 2 + 2 * static_cast<std::size_t>(line);
}

/// A contact of a port lies `along_mm` from the middle of its side, and again at −along_mm, so that any port of one
/// module fits any port of another; it is `inset_mm` from the side. The ring of the net runs at the same inset.
struct Contact {
  double along_mm, inset_mm;
};
/// The index is the bus net. Four nets cross between the two middle taxels of a side, six between the outer ones,
/// because their plated holes reach the touch side. GND is the outermost ring; nothing plated lies nearer to a side,
/// because the joint bends there (bend.hpp).
inline constexpr std::array<Contact, kBusNets> kContacts{{{5.75, 1.85},
                                                          {6.15, 2.23},
                                                          {6.55, 2.61},
                                                          {6.95, 2.965},
                                                          {7.35, 3.32},
                                                          {7.75, 3.675},
                                                          {0.25, 4.03},
                                                          {0.65, 4.385},
                                                          {1.05, 4.74},
                                                          {1.45, 5.095}}};

inline constexpr double kTrack_mm = 0.15, kNarrowTrack_mm = 0.1, kStrapTrack_mm = 0.4;
/// Supply rings and their tracks over joints are wider than those of the lines.
[[nodiscard]] constexpr double ring_track_mm(std::size_t net) {
  return net < 2 ? kTrack_mm : kNarrowTrack_mm;
}
inline constexpr double kClearance_mm = 0.1, kEdgeClearance_mm = 0.3;
inline constexpr double kContactPad_mm = 0.4, kContactHole_mm = 0.2;
inline constexpr double kPressurePad_mm = 3.5, kTemperaturePad_mm = 2.0;  ///< Both values are diameters.
/// The plane that ACSHIELD drives, on the first inner layer, begins this far from a side, where the pads of the outer
/// taxels begin. So no copper but the tracks of a joint lies nearer to a side.
inline constexpr double kShieldInset_mm = 1.25;
/// A larger corner cut would leave less than kEdgeClearance_mm beside the pads of the corner taxels.
inline constexpr double kMaxBoardCornerCut_mm = 4.5;

/// A module has pads on these layers.
enum class PadLayer {
  kThrough,  ///< A plated hole goes through all four layers.
  kTouch,    ///< The front copper is on the side that is touched.
  kBack,     ///< The back copper carries chip, straps and capacitors.
};

/// One pad in the frame of the module.
struct ModulePad {
  /// Contacts are A1 … C10, each twice; taxels T0 … T11; chip pins U1.1 … U1.25; capacitors C1.1 …; straps
  /// SDA0.1 …
  std::string name;
  PadLayer layer = PadLayer::kBack;
  design::Vec2 at_mm;
  design::Vec2 size_mm;    ///< Equal sizes mean a circle on kThrough and kTouch, but a rectangle on kBack.
  double angle_rad = 0.0;  ///< The rectangle is turned counter-clockwise.
};

/// Returns all pads of the module, always the same. Cost: constant.
[[nodiscard]] const std::vector<ModulePad>& module_pads();

/// Returns the names of pins 1 … 24 of the AD7147-1 in its LFCSP of 24 pins; [0] is pin 1. Source: its data sheet,
/// functional block diagram; the net list of a public board with this chip agrees (opendous).
[[nodiscard]] const std::array<std::string_view, 24>& chip_pins();

/// Pin 8 of the chip drives the shield (AD7147 data sheet, ACSHIELD).
inline constexpr const char* kShieldPin = "U1.8";

/// Paste for the chip's wide pad: four windows that cover 55 % of it, so that the chip does not float. Frame of the
/// module. Constant cost.
[[nodiscard]] const std::vector<ModulePad>& paste_windows();

/// A part that is soldered to a module.
struct ModulePart {
  const char* designator;
  const char* value;
  const char* package;
  const char* manufacturer;
  const char* order_number;
  design::Vec2 at_mm;         ///< its middle
  double angle_rad;           ///< from pin 1 at the left or upper left, as seen from the back, counter-clockwise there
  design::Vec2 half_size_mm;  ///< of its courtyard
};
/// Returns U1 and C1 … C3. Constant cost.
[[nodiscard]] const std::array<ModulePart, 4>& module_parts();

/// Silkscreen of the back: a mark beside pin 1 of the chip, and lines between the pads of each capacitor.
inline constexpr double kSilk_mm = 0.15;
struct SilkLine {
  design::Vec2 from_mm, to_mm;
};
[[nodiscard]] const std::vector<SilkLine>& module_silk();

/// A strap has two pads on the back, NAME.1 and NAME.2, which copper joins when it is closed.
struct Strap {
  std::string name;  ///< SDA0 … SCL3 select the line; ADD0L, ADD0H, ADD1L, ADD1H tie address pins to GND or VDD.
  design::Vec2 at_mm[2];
};
/// Returns all straps of a module. Constant cost.
[[nodiscard]] const std::vector<Strap>& straps();

/// States patch, line and address of a module.
struct ModuleSetting {
  design::ModuleNumber number{0};
  /// −1 means no patch; the nets of the module are then its own.
  layout::PatchIndex patch = layout::PatchIndex::none();
  std::optional<int> line;     ///< The lines are 0 … 3.
  std::optional<int> address;  ///< The addresses are 0 … 3.
};
/// Returns the setting of a module of a design. `wiring` must be wiring_of() of the design. Errors: std::out_of_range.
[[nodiscard]] ModuleSetting setting_of(const design::Design& design, const std::vector<design::ModuleWiring>& wiring,
                                       layout::ModuleId id);

/// Returns true when the strap is closed on a module of this setting. Without line and address all are open.
[[nodiscard]] bool is_closed(const Strap& strap, const ModuleSetting& setting);

/// Returns the name of bus net `net` on this module, such as P0_SDA2. Errors: std::out_of_range.
[[nodiscard]] std::string bus_net_name(const ModuleSetting& setting, std::size_t net);
/// Returns the net of a pad of module_pads() on this module; empty if it is not connected.
[[nodiscard]] std::string net_of(const ModulePad& pad, const ModuleSetting& setting);

/// Returns the points of the ring of a bus net, closed, counter-clockwise, including its contacts; the corners of the
/// module are cut by `corner_cut_mm`. Cost: constant.
[[nodiscard]] std::vector<design::Vec2> ring_of(std::size_t net, double corner_cut_mm);

/// Returns the place of a contact of port `port`; `sign` +1 or −1 selects one of the two of a net.
[[nodiscard]] design::Vec2 contact_at(std::size_t port, std::size_t net, int sign);

/// The flat cable of an entry or jumper has ten pads on the back of a port, at 1 mm. Pin 1 lies at −4.5 mm along the
/// side, seen from the touch side. The table gives the bus net of each pin.
inline constexpr std::array<std::size_t, kBusNets> kCablePinNets{0, 1, 2, 9, 7, 6, 8, 5, 4, 3};
inline constexpr double kCablePitch_mm = 1.0, kCableInset_mm = 1.7, kCablePadWidth_mm = 0.6, kCablePadLength_mm = 1.55;
/// Returns the middle of cable pad `pin` (0-based) of port A.
[[nodiscard]] design::Vec2 cable_pad_at(std::size_t pin);
/// Returns the track on the back from cable pad `pin` of port A to a contact of its net, in the frame of the module.
[[nodiscard]] std::vector<design::Vec2> cable_track(std::size_t pin);

}  // namespace triskin::fabrication
