#include "tools/uplinkctl/show/rows.h"

#include <algorithm>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "schema/base/rfc3339.h"
#include "tools/uplinkctl/show/ages.h"
#include "tools/uplinkctl/show/csv.h"
#include "tools/uplinkctl/show/json_text.h"
#include "tools/uplinkctl/show/one_line.h"
#include "tools/uplinkctl/show/short_names.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

ShortNames NamesIn(const Columns& columns, const json::array& rows,
                   std::vector<std::string> ruris) {
  for (const Column& column : columns) {
    if (column.kind != Kind::kRobot) continue;
    for (const json::value& row : rows) {
      if (!row.is_object()) continue;
      std::string ruri = TextAt(row.get_object(), column.member);
      if (!ruri.empty()) ruris.push_back(std::move(ruri));
    }
  }
  return ShortNamesOf(ruris);
}

/// Each member that a column shows, once: a time and its age share one, a length has two.
std::vector<std::string> MembersOf(const Columns& columns) {
  std::vector<std::string> members;
  for (const Column& column : columns) {
    std::string_view rest = column.member;
    while (!rest.empty()) {
      const std::string_view member = rest.substr(0, rest.find(','));
      rest.remove_prefix(std::min(rest.size(), member.size() + 1));
      if (std::ranges::find(members, member) == members.end()) members.emplace_back(member);
    }
  }
  return members;
}

bool IsEmpty(const json::value& value) {
  if (const auto* text = value.if_string()) return text->empty();
  if (const auto* list = value.if_array()) return list->empty();
  if (const auto* object = value.if_object()) return object->empty();
  return value.is_null();
}

using TakeField = std::function<void(const std::string& name, const json::value& value)>;

/// Every scalar and list of scalars below the object.
void Flatten(const json::object& object, const std::string& before, const TakeField& take) {
  for (const auto& [key, value] : object) {
    if (IsEmpty(value)) continue;
    const std::string name = before + std::string(key.data(), key.size());
    if (const auto* inner = value.if_object()) {
      Flatten(*inner, name + ".", take);
    } else {
      take(name, value);
    }
  }
}

std::string ValueText(const json::value& value, SystemTime now) {
  std::string text = OneLine(ScalarText(value));
  const auto time = value.is_string() ? FromRfc3339(text) : std::nullopt;
  if (!time) return text;
  const std::string age = AgeText(*time, now);
  const bool ahead = *time > now || age == "now";
  return fmt::format("{} ({}{})", text, age, ahead ? "" : " ago");
}

}  // namespace

Format FormatOf(std::string_view word) {
  if (word == kJsonWord) return Format::kJson;
  return word == kCsvWord ? Format::kCsv : Format::kTable;
}

std::string TableOf(const Columns& columns, const json::array& rows, const RowTerms& terms) {
  const ShortNames names = NamesIn(columns, rows, terms.robots);
  std::vector<Heading> headings;
  for (const Column& column : columns) headings.push_back(HeadingOf(column));
  Table table(std::move(headings));
  for (const json::value& row : rows) {
    if (!row.is_object()) continue;
    std::vector<Cell> cells;
    for (const Column& column : columns) {
      cells.push_back(CellOf(column, row.get_object(), {terms.now, names}));
    }
    table.Add(std::move(cells));
  }
  return table.Text(terms.table);
}

std::string CsvOf(const Columns& columns, const json::array& rows, bool headings) {
  const std::vector<std::string> members = MembersOf(columns);
  std::string text = headings ? CsvLine(members) : "";
  for (const json::value& row : rows) {
    if (!row.is_object()) continue;
    std::vector<std::string> fields;
    for (const std::string& member : members) {
      const json::value* value = MemberAt(row.get_object(), member);
      fields.push_back(value == nullptr ? std::string() : ScalarText(*value));
    }
    text += CsvLine(fields);
  }
  return text;
}

std::string FieldsOf(const json::object& object, const RowTerms& terms) {
  Table table({{"", Fit::kKeep}, {"", Fit::kShrink}});
  Flatten(object, "", [&](const std::string& name, const json::value& value) {
    table.Add({{OneLine(name)}, {ValueText(value, terms.now), ToneOf(ScalarText(value))}});
  });
  TableTerms without = terms.table;
  without.headings = false;
  return table.Text(without);
}

std::string FieldsCsvOf(const json::object& object) {
  std::string text = CsvLine({"field", "value"});
  Flatten(object, "", [&text](const std::string& name, const json::value& value) {
    text += CsvLine({name, ScalarText(value)});
  });
  return text;
}

}  // namespace uplink::ctl
