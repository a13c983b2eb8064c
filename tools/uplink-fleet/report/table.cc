#include "tools/uplink-fleet/report/table.h"

#include <algorithm>
#include <cstddef>

namespace uplink::synthetic {
namespace {

std::string Painted(const Cell& cell, const Palette& palette) {
  switch (cell.tone) {
    case Cell::Tone::kPlain:
      return cell.text;
    case Cell::Tone::kGood:
      return palette.Good(cell.text);
    case Cell::Tone::kBad:
      return palette.Bad(cell.text);
    case Cell::Tone::kHeading:
      return palette.Heading(cell.text);
  }
  return cell.text;
}

}  // namespace

std::vector<std::size_t> Table::Widths() const {
  std::vector<std::size_t> widths;
  for (const std::string& heading : headings_) widths.push_back(heading.size());
  for (const Line& line : lines_) {
    for (std::size_t i = 0; i < line.cells.size() && i < widths.size(); ++i) {
      widths[i] = std::max(widths[i], line.cells[i].text.size());
    }
  }
  return widths;
}

std::string Table::LineText(const std::vector<Cell>& cells, const std::vector<std::size_t>& widths,
                            const Palette& palette) const {
  std::string text;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const Cell cell = i < cells.size() ? cells[i] : Cell();
    const bool last = i + 1 == widths.size();
    const bool left = i == 0 || (last && headings_[i].empty());
    const std::string blanks(widths[i] - cell.text.size(), ' ');
    if (i > 0) text += " | ";
    if (!left) text += blanks;
    text += Painted(cell, palette);
    if (left && !last) text += blanks;
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text + "\n";
}

std::string Table::Text(const Palette& palette) const {
  if (lines_.empty()) return {};
  const std::vector<std::size_t> widths = Widths();
  std::vector<Cell> headings;
  for (const std::string& heading : headings_) headings.emplace_back(heading, Cell::Tone::kHeading);
  std::string text = LineText(headings, widths, palette);
  for (std::size_t i = 0; i < widths.size(); ++i) {
    text += (i > 0 ? "-+-" : "") + std::string(widths[i], '-');
  }
  text += "\n";
  for (const Line& line : lines_) {
    text += line.cells.empty() ? line.note + "\n" : LineText(line.cells, widths, palette);
  }
  return text;
}

}  // namespace uplink::synthetic
