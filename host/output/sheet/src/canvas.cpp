// SPDX-License-Identifier: GPL-3.0-or-later
#include "canvas.hpp"

#include <fmt/format.h>

#include "triskin/base/error.hpp"
#include "triskin/base/markup.hpp"
#include "triskin/base/terminal_text.hpp"

#ifdef TRISKIN_CAIRO
#include <cairo/cairo-pdf.h>
#include <cairo/cairo-svg.h>
#include <fontconfig/fontconfig.h>
#include <qrencode.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

namespace triskin::sheet {
namespace {

constexpr double kPoint_mm = 25.4 / 72.0, kHair_mm = 0.06;

cairo_status_t append(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

double height_mm_of(std::span<const Vec2> page_sizes_mm) {
  double height_mm = 0.0;
  for (const Vec2& size : page_sizes_mm) height_mm += size.y();
  return height_mm;
}

void trace_circle(cairo_t* context, const Vec2& center, double radius_mm) {
  cairo_new_path(context);
  cairo_arc(context, center.x(), center.y(), radius_mm, 0.0, 2.0 * std::numbers::pi);
}

}  // namespace

struct Canvas::Cairo {
  Kind kind;
  std::string title;
  std::vector<Vec2> sizes_mm;
  std::size_t started = 0;
  std::string bytes;
  cairo_surface_t* surface = nullptr;
  cairo_t* context = nullptr;
  // While a picture is drawn, these keep the page, and where on it the picture will be.
  cairo_t* page = nullptr;
  Vec2 picture_mm{0, 0};
  double dots_per_mm = 1.0;

  void use(const Color& c) const { cairo_set_source_rgb(context, c.red, c.green, c.blue); }
  void use(const Pen& pen) const {
    use(pen.color);
    cairo_set_line_width(context, pen.width_mm);
    cairo_set_dash(context, &pen.dash_mm, pen.dash_mm > 0.0 ? 1 : 0, 0.0);
  }
  void path(std::span<const Vec2> points) const {
    cairo_new_path(context);
    for (const Vec2& p : points) cairo_line_to(context, p.x(), p.y());
    cairo_close_path(context);
  }
};

Canvas::Canvas(Kind kind, std::string title, std::vector<Vec2> page_sizes_mm) : cairo_(std::make_unique<Cairo>()) {
  Cairo& c = *cairo_;
  c.kind = kind;
  c.title = std::move(title);
  c.sizes_mm = std::move(page_sizes_mm);
  const double height_mm = height_mm_of(c.sizes_mm);
  double width_mm = 1.0;
  for (const Vec2& size : c.sizes_mm) width_mm = std::max(width_mm, size.x());
  if (kind == Kind::kPdf) {
    c.surface = cairo_pdf_surface_create_for_stream(append, &c.bytes, width_mm / kPoint_mm, height_mm / kPoint_mm);
    // A date would make the files of equal designs differ.
    cairo_pdf_surface_set_metadata(c.surface, CAIRO_PDF_METADATA_CREATE_DATE, "");
    cairo_pdf_surface_set_metadata(c.surface, CAIRO_PDF_METADATA_CREATOR, "triskin");
    cairo_pdf_surface_set_metadata(c.surface, CAIRO_PDF_METADATA_TITLE, c.title.c_str());
  } else {
    c.surface = cairo_svg_surface_create_for_stream(append, &c.bytes, width_mm, height_mm);
    cairo_svg_surface_set_document_unit(c.surface, CAIRO_SVG_UNIT_MM);
  }
  c.context = cairo_create(c.surface);
}

Canvas::~Canvas() {
  cairo_destroy(cairo_->context);
  cairo_surface_destroy(cairo_->surface);
  // Fonts stay loaded until the process ends, which a leak checker reports as leaks.
  cairo_debug_reset_static_data();
  FcFini();
}

bool Canvas::is_built() {
  return true;
}

void Canvas::next_page() {
  Cairo& c = *cairo_;
  const Vec2 size_mm = c.sizes_mm.at(c.started);
  cairo_identity_matrix(c.context);
  if (c.kind == Kind::kPdf) {
    if (c.started > 0) cairo_show_page(c.context);
    cairo_pdf_surface_set_size(c.surface, size_mm.x() / kPoint_mm, size_mm.y() / kPoint_mm);
    cairo_scale(c.context, 1.0 / kPoint_mm, 1.0 / kPoint_mm);
  } else {
    cairo_translate(c.context, 0.0, height_mm_of(std::span(c.sizes_mm).first(c.started)));
    fill_rectangle({0, 0}, size_mm, kWhite);
    rectangle({0, 0}, size_mm, {0.1, kPale, 0.0});
  }
  cairo_set_line_join(c.context, CAIRO_LINE_JOIN_MITER);
  ++c.started;
}

void Canvas::line(const Vec2& from, const Vec2& to, const Pen& pen) {
  cairo_->use(pen);
  cairo_new_path(cairo_->context);
  cairo_move_to(cairo_->context, from.x(), from.y());
  cairo_line_to(cairo_->context, to.x(), to.y());
  cairo_stroke(cairo_->context);
}

void Canvas::outline(std::span<const Vec2> points, const Pen& pen) {
  cairo_->use(pen);
  cairo_->path(points);
  cairo_stroke(cairo_->context);
}

void Canvas::fill(std::span<const Vec2> points, const Color& color) {
  cairo_->use(color);
  cairo_->path(points);
  cairo_fill(cairo_->context);
}

void Canvas::fill_tight(std::span<const Vec2> points, const Color& color) {
  Vec2 center(0, 0);
  for (const Vec2& p : points) center += p / static_cast<double>(points.size());
  std::vector<Vec2> larger(points.begin(), points.end());
  for (Vec2& p : larger) p += kHair_mm * (p - center).stableNormalized();
  fill(larger, color);
}

void Canvas::rectangle(const Vec2& corner, const Vec2& size_mm, const Pen& pen) {
  cairo_->use(pen);
  cairo_rectangle(cairo_->context, corner.x(), corner.y(), size_mm.x(), size_mm.y());
  cairo_stroke(cairo_->context);
}

void Canvas::fill_rectangle(const Vec2& corner, const Vec2& size_mm, const Color& color) {
  cairo_->use(color);
  cairo_rectangle(cairo_->context, corner.x(), corner.y(), size_mm.x(), size_mm.y());
  cairo_fill(cairo_->context);
}

void Canvas::circle(const Vec2& center, double radius_mm, const Pen& pen) {
  cairo_->use(pen);
  trace_circle(cairo_->context, center, radius_mm);
  cairo_stroke(cairo_->context);
}

void Canvas::fill_circle(const Vec2& center, double radius_mm, const Color& color) {
  cairo_->use(color);
  trace_circle(cairo_->context, center, radius_mm);
  cairo_fill(cairo_->context);
}

void Canvas::text(const Vec2& at, const std::string& wish, const TextLook& look) {
  const std::string text = for_terminal(wish);  // Bytes that are no UTF-8 would end the whole drawing.
  cairo_t* const c = cairo_->context;
  cairo_save(c);
  cairo_->use(look.color);
  cairo_select_font_face(c, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         look.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, look.size_mm);
  cairo_text_extents_t extents;
  cairo_text_extents(c, text.c_str(), &extents);
  cairo_translate(c, at.x(), at.y());
  cairo_rotate(c, look.turn_rad);
  cairo_move_to(c, -look.align * extents.x_advance, 0.0);
  cairo_show_text(c, text.c_str());
  cairo_restore(c);
}

void Canvas::begin_clip(const Vec2& corner, const Vec2& size_mm) {
  cairo_save(cairo_->context);
  cairo_rectangle(cairo_->context, corner.x(), corner.y(), size_mm.x(), size_mm.y());
  cairo_clip(cairo_->context);
}

void Canvas::end_clip() {
  cairo_restore(cairo_->context);
}

void Canvas::begin_raster(const Vec2& corner, const Vec2& size_mm, double dots_per_mm) {
  Cairo& c = *cairo_;
  const Vec2 dots = (dots_per_mm * size_mm).array().ceil().max(1.0);
  cairo_surface_t* const picture =
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(dots.x()), static_cast<int>(dots.y()));
  c.page = c.context;
  c.picture_mm = corner;
  c.dots_per_mm = dots_per_mm;
  c.context = cairo_create(picture);
  cairo_surface_destroy(picture);  // The context keeps the surface alive.
  cairo_scale(c.context, dots_per_mm, dots_per_mm);
  cairo_translate(c.context, -corner.x(), -corner.y());
  c.use(kWhite);
  cairo_paint(c.context);
}

void Canvas::end_raster() {
  Cairo& c = *cairo_;
  cairo_t* const drawn = std::exchange(c.context, std::exchange(c.page, nullptr));
  cairo_save(c.context);
  cairo_translate(c.context, c.picture_mm.x(), c.picture_mm.y());
  cairo_scale(c.context, 1.0 / c.dots_per_mm, 1.0 / c.dots_per_mm);
  cairo_set_source_surface(c.context, cairo_get_target(drawn), 0.0, 0.0);
  cairo_paint(c.context);
  cairo_restore(c.context);
  cairo_destroy(drawn);
}

std::string Canvas::finish() {
  cairo_surface_finish(cairo_->surface);
  for (const cairo_status_t status : {cairo_status(cairo_->context), cairo_surface_status(cairo_->surface)}) {
    if (status != CAIRO_STATUS_SUCCESS)
      throw InputError(fmt::format("export: Cairo cannot draw the sheet: {}", cairo_status_to_string(status)));
  }
  std::string& bytes = cairo_->bytes;
  // Cairo writes no title into an SVG, and its letters are outlines.
  if (cairo_->kind == Kind::kSvg)
    bytes.insert(bytes.find('\n', bytes.find("<svg ")) + 1, "<title>" + escape_markup(cairo_->title) + "</title>\n");
  return std::move(bytes);
}

void draw_qr(Canvas& canvas, const std::string& text, const Vec2& corner, double size_mm) {
  const std::unique_ptr<QRcode, decltype(&QRcode_free)> code(
      QRcode_encodeString(text.c_str(), 0, QR_ECLEVEL_M, QR_MODE_8, 1), QRcode_free);
  if (!code) throw InputError(fmt::format("export: no QR code holds \"{}\"", text));
  const double square_mm = size_mm / code->width;
  for (int y = 0; y < code->width; ++y) {
    for (int x = 0; x < code->width; ++x) {
      const int first = x;
      while (x < code->width && (code->data[y * code->width + x] & 1) != 0) ++x;
      // Each row is slightly larger, so that no gap shows to the next one.
      if (x > first)
        canvas.fill_rectangle(corner + square_mm * Vec2(first, y), {square_mm * (x - first), square_mm * 1.03}, kBlack);
    }
  }
}

}  // namespace triskin::sheet

#else

namespace triskin::sheet {

struct Canvas::Cairo {};

Canvas::Canvas(Kind /*kind*/, std::string /*title*/, std::vector<Vec2> /*page_sizes_mm*/) {
  throw InputError(
      "this triskin was built without its assembly sheet, since Cairo or libqrencode was not installed; install the "
      "packages libcairo2-dev, libqrencode-dev and fonts-dejavu-core and build again");
}
Canvas::~Canvas() = default;

bool Canvas::is_built() {
  return false;
}

// This build has no canvas on which these could be called.
void Canvas::next_page() {}
void Canvas::line(const Vec2& /*from*/, const Vec2& /*to*/, const Pen& /*pen*/) {}
void Canvas::outline(std::span<const Vec2> /*points*/, const Pen& /*pen*/) {}
void Canvas::fill(std::span<const Vec2> /*points*/, const Color& /*color*/) {}
void Canvas::fill_tight(std::span<const Vec2> /*points*/, const Color& /*color*/) {}
void Canvas::rectangle(const Vec2& /*corner*/, const Vec2& /*size_mm*/, const Pen& /*pen*/) {}
void Canvas::fill_rectangle(const Vec2& /*corner*/, const Vec2& /*size_mm*/, const Color& /*color*/) {}
void Canvas::circle(const Vec2& /*center*/, double /*radius_mm*/, const Pen& /*pen*/) {}
void Canvas::fill_circle(const Vec2& /*center*/, double /*radius_mm*/, const Color& /*color*/) {}
void Canvas::text(const Vec2& /*at*/, const std::string& /*text*/, const TextLook& /*look*/) {}
void Canvas::begin_clip(const Vec2& /*corner*/, const Vec2& /*size_mm*/) {}
void Canvas::end_clip() {}
void Canvas::begin_raster(const Vec2& /*corner*/, const Vec2& /*size_mm*/, double /*dots_per_mm*/) {}
void Canvas::end_raster() {}
std::string Canvas::finish() {
  return {};
}
void draw_qr(Canvas& /*canvas*/, const std::string& /*text*/, const Vec2& /*corner*/, double /*size_mm*/) {}

}  // namespace triskin::sheet

#endif
