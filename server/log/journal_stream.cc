#include "server/log/journal_stream.h"

#include <charconv>
#include <cstdint>
#include <optional>

#include <sys/stat.h>

namespace uplink::log {
namespace {

std::optional<std::uint64_t> NumberOf(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

bool IsJournal(std::string_view journal_stream, int descriptor) {
  const std::size_t colon = journal_stream.find(':');
  if (colon == std::string_view::npos) return false;
  const auto device = NumberOf(journal_stream.substr(0, colon));
  const auto inode = NumberOf(journal_stream.substr(colon + 1));
  struct stat found {};
  if (!device || !inode || fstat(descriptor, &found) != 0) return false;
  return found.st_dev == *device && found.st_ino == *inode;
}

}  // namespace uplink::log
