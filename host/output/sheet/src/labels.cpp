// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "drawing.hpp"
#include "pages.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/sheet/page_code.hpp"

namespace triskin::sheet {
namespace {

constexpr double kLabelCode_mm = 15.0;

std::vector<Label> labels_of(const design::Design& design, const Plan& plan) {
  std::vector<Label> labels;
  for (const layout::PatchIndex p : design::patches_of(design)) {
    const int entry = design.patches[static_cast<std::size_t>(p)].entry;
    labels.push_back({p, fmt::format("C{}", p), fmt::format("node address {}", design::node_address_of(design, p)),
                      fmt::format("entry: module {}", design::number_of(design, entry))});
  }
  for (const design::Jumper& j : design.layout.jumpers) {
    const auto end = [&](std::size_t e) {
      return fmt::format("module {} port {}", design::number_of(design, j.node[e]),
                         port_at(j.side[e], plan.wiring[static_cast<std::size_t>(j.node[e])].routed.rotation));
    };
    labels.push_back({-1, design::jumper_name(design, j), end(0), end(1)});
  }
  return labels;
}

void draw_label(const Drawing& d, const Vec2& corner, const Label& label) {
  d.canvas.rectangle(corner, kLabel_mm, {0.15, kPale, 0.0});
  double x = 3.0;
  if (label.patch >= 0) {
    draw_qr(d.canvas, text_of(PageCode{d.design.design_id, label.patch, d.number}), corner + Vec2(2.5, 2.5),
            kLabelCode_mm);
    x = 2.5 + kLabelCode_mm + 3.0;
  }
  d.canvas.text(corner + Vec2(x, 7.0), label.name, {.size_mm = 5.0, .bold = true});
  d.canvas.text(corner + Vec2(x, 11.5), label.first, {.size_mm = 2.6});
  d.canvas.text(corner + Vec2(x, 15.0), label.second, {.size_mm = 2.6});
}

std::size_t columns_on(const Vec2& size_mm) {
  return static_cast<std::size_t>((size_mm.x() - 2.0 * kMargin_mm) / kLabel_mm.x());
}

}  // namespace

std::vector<Page> label_pages(const design::Design& design, const Plan& plan, Paper paper) {
  const Vec2 size_mm = text_size_mm(paper);
  const double high_mm = size_mm.y() - 2.0 * kMargin_mm - kHead_mm - kFoot_mm;
  const std::size_t a_page = columns_on(size_mm) * static_cast<std::size_t>(high_mm / kLabel_mm.y());
  const std::vector<Label> labels = labels_of(design, plan);
  std::vector<Page> pages;
  for (std::size_t first = 0; first < labels.size(); first += a_page) {
    Page page{.kind = PageKind::kLabels, .title = "Labels to cut out and stick", .size_mm = size_mm};
    const auto begin = labels.begin() + static_cast<std::ptrdiff_t>(first);
    const auto count = static_cast<std::ptrdiff_t>(std::min(a_page, labels.size() - first));
    page.labels.assign(begin, begin + count);
    pages.push_back(std::move(page));
  }
  return pages;
}

void draw_labels(const Drawing& d) {
  const std::size_t columns = columns_on(d.page.size_mm);
  for (std::size_t k = 0; k < d.page.labels.size(); ++k) {
    const Vec2 place(kLabel_mm.x() * static_cast<double>(k % columns),
                     kLabel_mm.y() * static_cast<double>(k / columns));
    draw_label(d, Vec2(kMargin_mm, kMargin_mm + kHead_mm) + place, d.page.labels[k]);
  }
}

}  // namespace triskin::sheet
