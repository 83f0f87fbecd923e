// SPDX-License-Identifier: GPL-3.0-or-later
#include "off_reader.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>
#include <vector>

#include "polygon_faces.hpp"
#include "text_numbers.hpp"
#include "triskin/base/error.hpp"

namespace triskin::mesh {
namespace {

constexpr long kMaxCount = 100'000'000;

struct Word {
  std::string_view text;
  int line;
};

// The first word may name texture, colours, normals or four coordinates before "OFF".
struct Head {
  bool has_texture = false, has_colour = false, has_normal = false, is_homogeneous = false, is_n_dimensional = false;
};

std::optional<Head> head_of(std::string_view word) {
  if (!word.ends_with("OFF")) return std::nullopt;
  word.remove_suffix(3);
  Head head;
  const auto take = [&](std::string_view prefix, bool& has) {
    has = word.starts_with(prefix);
    if (has) word.remove_prefix(prefix.size());
  };
  take("ST", head.has_texture);
  take("C", head.has_colour);
  take("N", head.has_normal);
  take("4", head.is_homogeneous);
  take("n", head.is_n_dimensional);
  return word.empty() ? std::optional(head) : std::nullopt;
}

// Splits a text into words line by line, without its comments; lines without a word are left out.
std::vector<std::vector<Word>> lines_of(std::string_view text) {
  std::vector<std::vector<Word>> lines;
  LineReader reader(text);
  for (std::string_view line; reader.next(line);) {
    line = line.substr(0, line.find('#'));
    std::vector<Word> words;
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line))
      words.push_back({word, reader.number()});
    if (!words.empty()) lines.push_back(std::move(words));
  }
  return lines;
}

class OffReader {
 public:
  explicit OffReader(const MeshSource& source) : source_(source), lines_(lines_of(source.bytes)) {}

  Mesh read() {
    read_head();
    try {
      return by_lines();
    } catch (const InputError&) {
      Mesh mesh;
      if (by_words(mesh)) return mesh;
      throw;
    }
  }

 private:
  [[noreturn]] void fail(int line, const std::string& what) const {
    throw InputError(fmt::format("{}, line {}: not a mesh that can be read ({}); repair or export the mesh again",
                                 source_.name, line, what));
  }

  // Keeps in lines_ only the text after the counts.
  void read_head() {
    if (lines_.empty()) fail(1, "the file ends before the counts");
    std::vector<Word>& first = lines_.front();
    if (const auto head = head_of(first.front().text)) {
      head_ = *head;
      first.erase(first.begin());
      if (!first.empty() && first.front().text == "BINARY") fail(1, "it is binary OFF; convert it to text");
      if (head_.is_n_dimensional) fail(1, "it is nOFF of any dimension; convert it to three");
    }
    if (first.empty()) lines_.erase(lines_.begin());
    if (lines_.empty()) fail(1, "the file ends before the counts");
    std::vector<Word>& counts = lines_.front();
    if (counts.size() < 2) fail(counts.front().line, "the numbers of vertices and faces are missing");
    vertices_ = count(counts[0], "vertices");
    faces_ = count(counts[1], "faces");
    counts.erase(counts.begin(), counts.begin() + std::min<std::ptrdiff_t>(3, std::ssize(counts)));
    if (counts.empty()) lines_.erase(lines_.begin());
  }
  [[nodiscard]] long count(const Word& word, const char* what) const {
    const auto n = whole_number(word.text);
    if (!n || *n < 0 || *n > kMaxCount)
      fail(word.line, fmt::format("the number of {} must be 0 … {}", what, kMaxCount));
    return *n;
  }

  [[nodiscard]] double number(const Word& word) const {
    if (const auto value = decimal_number(word.text)) return *value;
    fail(word.line, has_decimal_comma(word.text)
                        ? "its numbers have decimal commas; export it with points, as under the language English"
                        : "a vertex must be three numbers");
  }
  [[nodiscard]] std::size_t coordinates() const { return head_.is_homogeneous ? 4 : 3; }
  template <class WordAt>
  Vec3 vertex(WordAt at) const {
    Vec3 p(number(at(0)), number(at(1)), number(at(2)));
    if (!head_.is_homogeneous) return p;
    const double w = number(at(3));
    if (w == 0.0) fail(at(3).line, "a vertex at infinity: its fourth coordinate is 0");
    return p / w;
  }
  [[nodiscard]] VertexIndex corner(const Word& word) const {
    const auto v = whole_number(word.text);
    if (!v || *v < 0 || *v >= vertices_) fail(word.line, "a face names a vertex that does not exist");
    return VertexIndex(*v);
  }
  void add_face(Mesh& mesh, std::vector<VertexIndex> corners) const {
    if (corners.size() >= 3) add_polygon(mesh, std::move(corners));
  }

  // Anything after the coordinates or the corners in a line (normals, colours) is ignored.
  Mesh by_lines() {
    Mesh mesh;
    std::size_t at = 0;
    const int end = lines_.empty() ? 1 : lines_.back().front().line;
    for (long v = 0; v < vertices_; ++v, ++at) {
      if (at >= lines_.size()) fail(end, fmt::format("the file ends before vertex {} of {}", v + 1, vertices_));
      const auto& line = lines_[at];
      if (line.size() < coordinates()) fail(line.front().line, "a vertex must be three numbers");
      mesh.vertices.push_back(vertex([&](std::size_t k) { return line[k]; }));
    }
    int lines_and_points = 0;
    for (long f = 0; f < faces_; ++f, ++at) {
      if (at >= lines_.size()) fail(end, fmt::format("the file ends before face {} of {}", f + 1, faces_));
      const auto& line = lines_[at];
      const auto n = static_cast<std::size_t>(count(line[0], "corners"));
      if (line.size() < n + 1) fail(line[0].line, "a face has fewer corners than it says");
      std::vector<VertexIndex> corners;
      for (std::size_t k = 1; k <= n; ++k) corners.push_back(corner(line[k]));
      lines_and_points += n < 3 ? 1 : 0;
      add_face(mesh, std::move(corners));
    }
    if (at < lines_.size()) fail(lines_[at].front().line, "more follows than its counts say");
    if (lines_and_points > 0)
      source_.notes.push_back(fmt::format("{} faces of fewer than three corners were left out", lines_and_points));
    note_cut();
    return mesh;
  }

  // The last number of a truncated file may have lost digits.
  void note_cut() const {
    const char last = source_.bytes.back();
    if (last != '\n' && last != '\r')
      source_.notes.emplace_back("ends without a line end: if the file was cut, its last number may be another one");
  }

  // Without line breaks only numbers can be told apart, so every one of them must be used.
  bool by_words(Mesh& mesh) const {
    std::vector<Word> words;
    for (const auto& line : lines_) words.insert(words.end(), line.begin(), line.end());
    const std::size_t width =
        coordinates() * (head_.has_normal ? 2 : 1) + (head_.has_colour ? 4 : 0) + (head_.has_texture ? 2 : 0);
    std::size_t at = static_cast<std::size_t>(vertices_) * width;
    if (at > words.size()) return false;
    for (std::size_t v = 0; v < at; v += width)
      mesh.vertices.push_back(vertex([&](std::size_t k) { return words[v + k]; }));
    for (long f = 0; f < faces_; ++f) {
      if (at >= words.size()) return false;
      const auto n = static_cast<std::size_t>(count(words[at], "corners"));
      if (at + n >= words.size()) return false;
      std::vector<VertexIndex> corners;
      for (std::size_t k = 1; k <= n; ++k) corners.push_back(corner(words[at + k]));
      add_face(mesh, std::move(corners));
      at += n + 1;
    }
    if (at == words.size()) note_cut();
    return at == words.size();
  }

  const MeshSource& source_;
  std::vector<std::vector<Word>> lines_;
  Head head_;
  long vertices_ = 0, faces_ = 0;
};

}  // namespace

bool is_off(std::string_view text) {
  LineReader reader(text);
  for (std::string_view line; reader.next(line);) {
    line = line.substr(0, line.find('#'));
    if (const std::string_view word = next_word(line); !word.empty()) return head_of(word).has_value();
  }
  return false;
}

Mesh read_off(const MeshSource& source) {
  return OffReader(source).read();
}

}  // namespace triskin::mesh
