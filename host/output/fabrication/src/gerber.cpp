// SPDX-License-Identifier: GPL-3.0-or-later
#include "gerber.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace triskin::fabrication {
namespace {

using design::Vec2;

constexpr int kFirstCode = 10;  // Smaller ones are reserved.

std::string coordinates(const Vec2& p) {
  const auto whole = [](double mm) { return std::llround(mm * 1e6); };
  return fmt::format("X{}Y{}", whole(p.x()), whole(p.y()));
}

}  // namespace

Gerber::Gerber(std::string_view function) : function_(function) {}

void Gerber::select(const std::string& shape, std::string_view use) {
  const auto [known, is_new] =
      codes_.try_emplace(fmt::format("{} {}", shape, use), kFirstCode + static_cast<int>(codes_.size()));
  const int code = known->second;
  if (is_new) {
    const std::string_view name = std::string_view(shape).substr(0, shape.find(','));
    const std::string_view numbers = std::string_view(shape).substr(name.size());
    apertures_ += fmt::format("%TA.AperFunction,{}*%\n%ADD{}{}{}*%\n%TD*%\n", use, code, name, numbers);
  }
  if (code == code_) return;
  body_ += fmt::format("D{}*\n", code);
  code_ = code;
}

void Gerber::carry(std::string_view net) {
  if (net == net_) return;
  body_ += net.empty() ? std::string("%TD.N*%\n") : fmt::format("%TO.N,{}*%\n", net);
  net_ = net;
}

void Gerber::flash(const Vec2& at_mm, double diameter_mm, std::string_view use, std::string_view net) {
  carry(net);
  select(fmt::format("C,{:.4f}", diameter_mm), use);
  body_ += coordinates(at_mm) + "D03*\n";
}

void Gerber::flash_rectangle(const Vec2& at_mm, const Vec2& size_mm, double angle_rad, std::string_view use,
                             std::string_view net) {
  carry(net);
  // A rectangle is the same after half a turn.
  double angle_deg = std::fmod(angle_rad * 180.0 / std::numbers::pi, 180.0);
  if (angle_deg < 0.0) angle_deg += 180.0;
  select(fmt::format("TURNED,{:.4f}X{:.4f}X{:.3f}", size_mm.x(), size_mm.y(), angle_deg), use);
  body_ += coordinates(at_mm) + "D03*\n";
}

void Gerber::line(const Vec2& from_mm, const Vec2& to_mm, double width_mm, std::string_view use, std::string_view net) {
  carry(net);
  select(fmt::format("C,{:.4f}", width_mm), use);
  body_ += coordinates(from_mm) + "D02*\n" + coordinates(to_mm) + "D01*\n";
}

void Gerber::region(const Ring& ring_mm, std::string_view net) {
  carry(net);
  body_ += "G36*\n" + coordinates(ring_mm.front()) + "D02*\n";
  for (std::size_t k = 1; k < ring_mm.size(); ++k) body_ += coordinates(ring_mm[k]) + "D01*\n";
  body_ += coordinates(ring_mm.front()) + "D01*\nG37*\n";
}

std::string Gerber::text() const {
  const bool is_mask = function_.starts_with("Soldermask");
  return fmt::format(
             "%TF.GenerationSoftware,Triskin,triskin*%\n%TF.SameCoordinates,Original*%\n%TF.FileFunction,{}*%\n"
             "%TF.FilePolarity,{}*%\n%FSLAX46Y46*%\n%MOMM*%\nG01*\n%LPD*%\n%AMTURNED*21,1,$1,$2,0,0,$3*%\n",
             function_, is_mask ? "Negative" : "Positive") +
         apertures_ + body_ + "M02*\n";
}

std::string excellon(std::string_view function, double diameter_mm, std::span<const Vec2> at_mm) {
  std::string text =
      fmt::format("M48\n; #@! TF.FileFunction,{}\nFMAT,2\nMETRIC\nT1C{:.3f}\n%\nG90\nG05\nT1\n", function, diameter_mm);
  for (const Vec2& p : at_mm) text += fmt::format("X{:.4f}Y{:.4f}\n", p.x(), p.y());
  return text + "T0\nM30\n";
}

}  // namespace triskin::fabrication
