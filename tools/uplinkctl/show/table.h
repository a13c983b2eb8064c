#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tools/terminal/terminal.h"

namespace uplink::ctl {

/// What a column gives up on a narrow terminal. Closed.
enum class Fit : std::uint8_t {
  kKeep,
  /// Its texts are cut.
  kShrink,
  /// It is left out, the last one first; also wherever all its cells are empty.
  kDrop,
};

/// How a cell is painted. Closed.
enum class Tone : std::uint8_t { kPlain, kGood, kWarning, kBad };

struct Heading {
  std::string title;
  Fit fit = Fit::kKeep;
  bool right = false;
};

struct Cell {
  std::string text;
  Tone tone = Tone::kPlain;
};

/// What a table is drawn for. A value.
struct TableTerms {
  /// Cells of a line; 0: a line may have any length.
  std::size_t columns = 0;
  bool headings = true;
  Palette palette{Terminal{}};
};

/// Rows of printable texts in columns as wide as their widest cell, two blanks apart.
///
/// Thread: confined to one thread.
class Table final {
 public:
  explicit Table(std::vector<Heading> headings) : headings_(std::move(headings)) {}

  /// As many cells as there are headings.
  void Add(std::vector<Cell> cells) { rows_.push_back(std::move(cells)); }

  /// Lines without a blank at their end. Nothing without rows. A table whose kept columns are wider
  /// than the terminal is as wide as they are.
  [[nodiscard]] std::string Text(const TableTerms& terms) const;

 private:
  [[nodiscard]] std::vector<std::size_t> Widths(const TableTerms& terms) const;
  [[nodiscard]] std::string Line(const std::vector<Cell>& cells,
                                 const std::vector<std::size_t>& widths, const TableTerms& terms,
                                 bool heading) const;

  std::vector<Heading> headings_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace uplink::ctl
