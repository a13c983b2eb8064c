#include "server/identity/token_file.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "schema/base/file_text.h"

namespace uplink::identity {
namespace {

/// The first line, and room for a comment behind it.
constexpr std::size_t kScrapeFileBytesMax = 4096;

absl::Status Unfit(const std::string& path, const std::string& text) {
  return absl::FailedPreconditionError(fmt::format("{}: {}", path, text));
}

bool IsTokenCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("-._~+/=").find(c) != std::string_view::npos;
}

}  // namespace

absl::StatusOr<ReadTokens> ReadTokenFile(const std::string& path) {
  FileText file = ReadFileText(path, kTokensFileBytesMax);
  if (!file.problem.empty()) return Unfit(path, file.problem);
  absl::StatusOr<TokenTable> table = TokenTable::Parse(file.text, path);
  if (!table.ok()) return table.status();
  return ReadTokens{*std::move(table), std::move(file.text)};
}

absl::StatusOr<TokenHash> ReadScrapeToken(const std::string& path) {
  const FileText file = ReadFileText(path, kScrapeFileBytesMax);
  if (!file.problem.empty()) return Unfit(path, file.problem);
  std::string_view line(file.text);
  line = line.substr(0, line.find('\n'));
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (line.size() < kScrapeTokenMin || line.size() > kScrapeTokenMax ||
      !std::ranges::all_of(line, IsTokenCharacter)) {
    return Unfit(path, fmt::format("its first line is no token; write {} to {} letters, digits and "
                                   "-._~+/= into it, such as those of `openssl rand -hex 32`",
                                   kScrapeTokenMin, kScrapeTokenMax));
  }
  return HashOfToken(line);
}

}  // namespace uplink::identity
