#include "tools/uplinkctl/verbs/list_text.h"

#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "tools/uplinkctl/show/json_text.h"

namespace uplink::ctl {
namespace {

std::string Document(std::string_view member, Rows rows, bool follow) {
  boost::json::object document;
  document.emplace(member, std::move(rows.rows));
  for (auto& [name, value] : rows.beside) document.emplace(name, std::move(value));
  return DocumentText(document, follow);
}

}  // namespace

std::string ListText(const List& list, const CommonFlags& flags, Rows rows, const RowTerms& terms) {
  switch (flags.format()) {
    case Format::kJson:
      return Document(list.member, std::move(rows), flags.follow);
    case Format::kCsv:
      return CsvOf(list.columns, rows.rows, true);
    case Format::kTable:
      return TableOf(list.columns, rows.rows, terms);
  }
  return {};
}

void NoteRows(const Rows& rows, const Screen& screen) {
  const auto* unjudged = rows.beside.if_contains("unjudged");
  if (const std::string count = unjudged == nullptr ? "" : ScalarText(*unjudged);
      !count.empty() && count != "0") {
    screen.note(fmt::format(
        "{} robots of other servers may match, too: the store does not tell what was asked",
        count));
  }
  if (rows.rows.empty()) {
    screen.note("nothing matches");
    return;
  }
  if (!rows.more) return;
  const std::string total =
      rows.beside.contains("total") ? " of " + CountText(ScalarText(rows.beside.at("total"))) : "";
  screen.note(fmt::format("the first {}{}; --limit shows more", rows.rows.size(), total));
}

}  // namespace uplink::ctl
