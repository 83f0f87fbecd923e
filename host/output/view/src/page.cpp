// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/view/page.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "triskin/base/base64.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/markup.hpp"

namespace triskin::view {
namespace {

void replace_all(std::string& text, std::string_view what, std::string_view with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
}

void replace_one(std::string& text, std::string_view what, std::string_view with) {
  const std::size_t at = text.find(what);
  if (at == std::string::npos) throw std::logic_error(fmt::format("the page lacks \"{}\"", what));
  text.replace(at, what.size(), with);
}

// An embedded module has no address, so the relative names in its imports become names of the import map.
std::string import_map() {
  std::string map;
  for (const auto& [name, asset] : assets()) {
    if (!name.ends_with(".js")) continue;
    std::string code(asset.bytes);
    if (name != "three.js") replace_all(code, "from \"./", "from \"page/");
    map +=
        fmt::format("{}\"page/{}\":\"data:text/javascript;base64,{}\"", map.empty() ? "" : ",\n", name, base64(code));
  }
  return "{\"imports\":{\n" + map + "}}";
}

// The licence of three.js requires its notice in every copy.
constexpr std::string_view kNotice =
    "<!-- Made by triskin export --format html. Contains three.js (licence MIT), Copyright 2010-2019 three.js "
    "authors:\n";

}  // namespace

bool has_page() {
  return assets().contains("three.js");
}

void require_page() {
  if (has_page()) return;
  throw InputError(
      "this triskin was built without its page, since three.js was not installed; install the package libjs-three and "
      "build again");
}

std::string page_html(const design::Design& design, std::string_view track, const Notes& notes) {
  require_page();
  std::string html(assets().at("index.html").bytes);
  replace_one(html, "<title>triskin view</title>",
              fmt::format("<title>{} – triskin view</title>", escape_markup(design.name)));
  replace_one(html, "<link rel=\"stylesheet\" href=\"style.css\">",
              fmt::format("<style>\n{}</style>", assets().at("style.css").bytes));
  const std::string recording =
      track.empty()
          ? ""
          : fmt::format("<script type=\"application/octet-stream\" id=\"recording\">{}</script>\n", base64(track));
  replace_one(html, "<script type=\"module\" src=\"main.js\"></script>",
              fmt::format("<script type=\"application/json\" id=\"model\">{}</script>\n{}<script "
                          "type=\"importmap\">{}</script>\n<script type=\"module\">import \"page/main.js\";</script>",
                          model_json(design, !track.empty(), notes), recording, import_map()));
  replace_one(html, "<meta charset=\"utf-8\">",
              "<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
              "script-src 'unsafe-inline' data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'\">");
  replace_one(html, "<!doctype html>\n",
              fmt::format("<!doctype html>\n{}{}-->\n", kNotice, assets().at("three_licence.txt").bytes));
  return html;
}

}  // namespace triskin::view
