#include "server/config/nearest.h"

#include <algorithm>
#include <array>

namespace uplink::config {
namespace {

/// A row of the table of edits: one place for each byte, and one before the first.
using Row = std::array<std::size_t, kNearNameBytesMax + 1>;

/// Optimal string alignment distance. Both texts have at most kNearNameBytesMax bytes.
std::size_t EditsBetween(std::string_view a, std::string_view b) {
  Row before_last{};
  Row last{};
  Row row{};
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last = last;
    last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, last[j] + 1, row[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::optional<std::string> NearestName(std::string_view wrong, std::span<const std::string> names) {
  if (wrong.size() > kNearNameBytesMax) return std::nullopt;
  const std::string* nearest = nullptr;
  std::size_t fewest = std::min(kNearEditsMax, wrong.size() / 3) + 1;
  for (const std::string& name : names) {
    if (name.size() > kNearNameBytesMax) continue;
    const std::size_t edits = EditsBetween(wrong, name);
    if (edits >= fewest) continue;
    fewest = edits;
    nearest = &name;
  }
  return nearest == nullptr ? std::nullopt : std::optional(*nearest);
}

std::string DidYouMean(std::string_view wrong, std::span<const std::string> names,
                       std::string_view otherwise) {
  const std::optional<std::string> near = NearestName(wrong, names);
  return near ? "; did you mean " + *near + "?" : std::string(otherwise);
}

}  // namespace uplink::config
