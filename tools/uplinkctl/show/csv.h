#pragma once

#include <string>
#include <vector>

namespace uplink::ctl {

/// One record with its line feed. A field with a comma, a quote or a blank at an end is quoted, and
/// its quotes are doubled. Control characters are shown as PrintableUtf8 shows them, so that a
/// record is a line. A text that a spreadsheet would take for a formula begins with an apostrophe.
///
/// Source: RFC 4180, with a line feed alone.
/// Thread: pure; any thread.
[[nodiscard]] std::string CsvLine(const std::vector<std::string>& fields);

}  // namespace uplink::ctl
