#include "tools/uplinkctl/show/table.h"

#include <algorithm>

#include "tools/uplinkctl/show/text_width.h"

namespace uplink::ctl {
namespace {

constexpr std::size_t kBetween = 2;
/// Fewer cells of a text tell nothing.
constexpr std::size_t kShrunkMin = 10;

/// Of the columns that are drawn; one of width 0 is left out.
std::size_t Total(const std::vector<std::size_t>& widths) {
  std::size_t total = 0;
  for (const std::size_t width : widths) total += width == 0 ? 0 : width + kBetween;
  return total == 0 ? 0 : total - kBetween;
}

std::string Painted(const std::string& text, Tone tone, const Palette& palette) {
  switch (tone) {
    case Tone::kPlain:
      return text;
    case Tone::kGood:
      return palette.Good(text);
    case Tone::kWarning:
      return palette.Warning(text);
    case Tone::kBad:
      return palette.Bad(text);
  }
  return text;
}

/// The widest column that may be cut further; none: the number of columns.
std::size_t WidestToShrink(const std::vector<Heading>& headings,
                           const std::vector<std::size_t>& widths) {
  std::size_t widest = headings.size();
  for (std::size_t i = 0; i < headings.size(); ++i) {
    if (headings[i].fit != Fit::kShrink || widths[i] <= kShrunkMin) continue;
    if (widest == headings.size() || widths[i] > widths[widest]) widest = i;
  }
  return widest;
}

}  // namespace

std::vector<std::size_t> Table::Widths(const TableTerms& terms) const {
  std::vector<std::size_t> widths(headings_.size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < widths.size(); ++i) {
      widths[i] = std::max(widths[i], WidthOf(row[i].text));
    }
  }
  for (std::size_t i = 0; i < widths.size(); ++i) {
    if (widths[i] == 0 && headings_[i].fit == Fit::kDrop) continue;
    if (terms.headings) widths[i] = std::max(widths[i], WidthOf(headings_[i].title));
  }
  if (terms.columns == 0) return widths;
  for (std::size_t i = widths.size(); i-- > 0 && Total(widths) > terms.columns;) {
    if (headings_[i].fit == Fit::kDrop) widths[i] = 0;
  }
  while (Total(widths) > terms.columns) {
    const std::size_t widest = WidestToShrink(headings_, widths);
    if (widest == headings_.size()) break;
    --widths[widest];
  }
  return widths;
}

std::string Table::Line(const std::vector<Cell>& cells, const std::vector<std::size_t>& widths,
                        const TableTerms& terms, bool heading) const {
  std::string line;
  std::size_t blanks = 0;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    if (widths[i] == 0) continue;
    const std::string text = CutTo(cells[i].text, widths[i]);
    const std::size_t pad = widths[i] - WidthOf(text);
    if (headings_[i].right) blanks += pad;
    if (!text.empty()) {
      line += std::string(blanks, ' ');
      line += heading ? terms.palette.Heading(text) : Painted(text, cells[i].tone, terms.palette);
      blanks = 0;
    }
    blanks += kBetween + (headings_[i].right ? 0 : pad);
  }
  return line + '\n';
}

std::string Table::Text(const TableTerms& terms) const {
  if (rows_.empty()) return {};
  const std::vector<std::size_t> widths = Widths(terms);
  std::string text;
  if (terms.headings) {
    std::vector<Cell> titles;
    for (const Heading& each : headings_) titles.push_back({each.title});
    text += Line(titles, widths, terms, true);
  }
  for (const auto& row : rows_) text += Line(row, widths, terms, false);
  return text;
}

}  // namespace uplink::ctl
