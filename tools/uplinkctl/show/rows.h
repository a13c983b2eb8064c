#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <boost/json.hpp>

#include "schema/base/clock.h"
#include "tools/uplinkctl/show/columns.h"
#include "tools/uplinkctl/show/table.h"

namespace uplink::ctl {

/// How rows are printed. Closed.
enum class Format : std::uint8_t { kTable, kCsv, kJson };

/// The words of -o.
inline constexpr const char* kTableWord = "table";
inline constexpr const char* kCsvWord = "csv";
inline constexpr const char* kJsonWord = "json";
[[nodiscard]] Format FormatOf(std::string_view word);

struct RowTerms {
  SystemTime now;
  TableTerms table;
  /// RURIs from which a short name must tell a robot, beside those in the rows.
  std::vector<std::string> robots{};
};

/// The rows as a table, with the short names of the robots in them. Pure; any thread.
[[nodiscard]] std::string TableOf(const Columns& columns, const boost::json::array& rows,
                                  const RowTerms& terms);
/// The rows as CSV; `headings` begins it with the members' names. Pure; any thread.
[[nodiscard]] std::string CsvOf(const Columns& columns, const boost::json::array& rows,
                                bool headings);

/// An object as lines of a name and a value: members of members have points in their names, and a
/// time has its age. Nothing for empty texts, lists and objects. Pure; any thread.
[[nodiscard]] std::string FieldsOf(const boost::json::object& object, const RowTerms& terms);
/// The same as CSV: field, value; times as they are.
[[nodiscard]] std::string FieldsCsvOf(const boost::json::object& object);

}  // namespace uplink::ctl
