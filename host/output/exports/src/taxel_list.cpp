// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "metres.hpp"
#include "module_names.hpp"
#include "npz.hpp"
#include "simulator_taxels.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/exports/simulators.hpp"

namespace triskin::exports {

std::string taxel_list_json(const design::Design& design) {
  const std::string name = simulator_name(design);
  nlohmann::json list = nlohmann::json::array();
  for (const SimulatorTaxel& t : simulator_taxels(design))
    list.push_back({{"cover", cover_name(design, t.module)},
                    {"module", design::number_of(design, t.module)},
                    {"taxel", t.taxel},
                    {"link", link_name(design, t.module)},
                    {"position_m", {t.position_m.x(), t.position_m.y(), t.position_m.z()}},
                    {"normal", {t.normal.x(), t.normal.y(), t.normal.z()}},
                    {"radius_m", kElectrodeRadius_mm * kMetres_per_mm}});
  const nlohmann::json document = {{"format", "triskin-taxels"},
                                   {"version", 1},
                                   {"design", fmt::format("{:016x}", design.design_id)},
                                   {"frame", name},
                                   {"taxels", std::move(list)}};
  return document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string taxel_list_npz(const design::Design& design) {
  std::vector<double> position, normal, radius;
  std::vector<int> module, taxel;
  std::vector<std::string> link, cover;
  for (const SimulatorTaxel& t : simulator_taxels(design)) {
    position.insert(position.end(), t.position_m.begin(), t.position_m.end());
    normal.insert(normal.end(), t.normal.begin(), t.normal.end());
    radius.push_back(kElectrodeRadius_mm * kMetres_per_mm);
    module.push_back(design::number_of(design, t.module).value);
    taxel.push_back(t.taxel);
    link.push_back(link_name(design, t.module));
    cover.push_back(cover_name(design, t.module));
  }
  NpzWriter npz;
  npz.add("position", position, 3);
  npz.add("normal", normal, 3);
  npz.add("radius", radius, 1);
  npz.add("cover", std::span<const std::string>(cover));
  npz.add("module", module);
  npz.add("taxel", taxel);
  npz.add("link", std::span<const std::string>(link));
  return npz.finish();
}

}  // namespace triskin::exports
