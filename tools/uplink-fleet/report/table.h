#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tools/terminal/terminal.h"

namespace uplink::synthetic {

/// One cell of a table, and what its colour says. A value.
struct Cell {
  enum class Tone : std::uint8_t { kPlain, kGood, kBad, kHeading };

  Cell() = default;
  // Most cells are plain texts.
  Cell(std::string content) : text(std::move(content)) {}
  Cell(const char* content) : text(content) {}
  Cell(std::string content, Tone its_tone) : text(std::move(content)), tone(its_tone) {}

  std::string text;
  Tone tone = Tone::kPlain;
};

/// Rows of cells in columns as wide as their widest cell: the first to the left, the others to the
/// right, a last one without a heading to the left. Texts are taken to be ASCII.
///
/// Thread: confined to one thread.
class Table final {
 public:
  explicit Table(std::vector<std::string> headings) : headings_(std::move(headings)) {}

  /// As many cells as there are headings; missing ones are empty.
  void Add(std::vector<Cell> cells) { lines_.push_back({std::move(cells), {}}); }
  /// A line across all columns.
  void AddNote(std::string note) { lines_.push_back({{}, std::move(note)}); }

  [[nodiscard]] bool empty() const { return lines_.empty(); }
  /// Headings, a rule and the rows; no blank at a line's end. Nothing without rows.
  [[nodiscard]] std::string Text(const Palette& palette) const;

 private:
  struct Line {
    std::vector<Cell> cells;
    /// In place of cells.
    std::string note;
  };

  [[nodiscard]] std::vector<std::size_t> Widths() const;
  [[nodiscard]] std::string LineText(const std::vector<Cell>& cells,
                                     const std::vector<std::size_t>& widths,
                                     const Palette& palette) const;

  std::vector<std::string> headings_;
  std::vector<Line> lines_;
};

}  // namespace uplink::synthetic
