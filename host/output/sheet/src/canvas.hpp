// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "triskin/design/mesh.hpp"

namespace triskin::sheet {

using design::Vec2;

struct Color {
  double red = 0.0, green = 0.0, blue = 0.0;
};
inline constexpr Color kBlack{0, 0, 0}, kGrey{0.55, 0.55, 0.55}, kPale{0.85, 0.85, 0.85}, kWhite{1, 1, 1},
    kRed{0.8, 0.05, 0.05}, kBlue{0.05, 0.2, 0.75};

/// A positive `dash_mm` draws dashes of that length.
struct Pen {
  double width_mm = 0.2;
  Color color = kBlack;
  double dash_mm = 0.0;
};

/// Text is placed by its baseline: `align` 0 begins at the point, 0.5 is centred on it, 1 ends there.
struct TextLook {
  double size_mm = 3.1;
  bool bold = false;
  double align = 0.0;
  Color color = kBlack;
  double turn_rad = 0.0;  ///< Positive angles turn clockwise as seen on the page.
};

/// Draws pages, and is the only class that uses Cairo. Lengths are in mm from the upper left corner of the page, y
/// downwards. A process may have only one at a time, because it releases the fonts when it ends.
class Canvas {
 public:
  enum class Kind { kPdf, kSvg };
  /// Prepares pages of these sizes in a document of this title; next_page() begins each of them, the first too. Throws
  /// InputError if the program was built without Cairo.
  Canvas(Kind kind, std::string title, std::vector<Vec2> page_sizes_mm);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  [[nodiscard]] static bool is_built();

  void next_page();
  void line(const Vec2& from, const Vec2& to, const Pen& pen);
  /// Draws a closed line through the points.
  void outline(std::span<const Vec2> points, const Pen& pen);
  void fill(std::span<const Vec2> points, const Color& color);
  /// Fills slightly more than the outline, so that no gap shows beside the next shape.
  void fill_tight(std::span<const Vec2> points, const Color& color);
  void rectangle(const Vec2& corner, const Vec2& size_mm, const Pen& pen);
  void fill_rectangle(const Vec2& corner, const Vec2& size_mm, const Color& color);
  void circle(const Vec2& center, double radius_mm, const Pen& pen);
  void fill_circle(const Vec2& center, double radius_mm, const Color& color);
  void text(const Vec2& at, const std::string& text, const TextLook& look);
  /// Limits drawing to the rectangle until end_clip().
  void begin_clip(const Vec2& corner, const Vec2& size_mm);
  void end_clip();
  /// Draws into a picture of `dots_per_mm` until end_raster(), which then fills the rectangle; meant for shapes that
  /// are too many to write one by one. White where nothing is drawn.
  void begin_raster(const Vec2& corner, const Vec2& size_mm, double dots_per_mm);
  void end_raster();
  /// Ends the drawing and returns the bytes of the file. Throws InputError when Cairo reports an error.
  [[nodiscard]] std::string finish();

 private:
  struct Cairo;
  std::unique_ptr<Cairo> cairo_;
};

/// Draws `text` as a QR code with error correction M; its dark squares fill `size_mm` from `corner`, and the quiet zone
/// of four squares lies around it. Throws InputError if the program was built without libqrencode.
void draw_qr(Canvas& canvas, const std::string& text, const Vec2& corner, double size_mm);

}  // namespace triskin::sheet
