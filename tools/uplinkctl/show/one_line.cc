#include "tools/uplinkctl/show/one_line.h"

#include <algorithm>

#include "schema/base/utf8.h"

namespace uplink::ctl {

std::string OneLine(std::string_view text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.remove_suffix(1);
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; }, ' ');
  return PrintableUtf8(line, std::string::npos);
}

}  // namespace uplink::ctl
