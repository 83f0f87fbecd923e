// SPDX-License-Identifier: GPL-3.0-or-later
#include "guarded.hpp"
#include "triskin/connect/open_link.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/robot/site.hpp"
#include "triskin/session/bus.hpp"

triskin_status triskin_flash_simulation(const char* file) {
  using namespace triskin;
  return library::guarded([&] {
    library::require(file != nullptr, "triskin_flash_simulation: file is NULL");
    if (robot::is_robot_file(file))
      throw InputError(fmt::format("{}: is a robot file; flash its simulation by triskin flash {}", file, file));
    const design::Design design = design::read_intact_design(file);
    const auto link = connect::open_link({.link = "sim", .scene = "", .own_interrupts = false}, &design);
    session::Bus bus(*link);
    // New boards have no tables: which of them is plugged into which patch is seen from its modules and, if these are
    // alike, from a touch.
    deploy::FlashOptions options;
    options.recognise = true;
    options.actuator = link::touch_actuator_of(*link);
    (void)deploy::flash(bus, design, options);
    return TRISKIN_OK;
  });
}
