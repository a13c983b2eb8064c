#include "storage/postgres/link/url.h"

#include <algorithm>
#include <memory>

#include <libpq-fe.h>

namespace uplink::storage::postgres {
namespace {

struct FreeOptions {
  void operator()(PQconninfoOption* options) const { PQconninfoFree(options); }
};

std::vector<std::string> SplitList(std::string_view text) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t comma = text.find(',');
    parts.emplace_back(text.substr(0, comma));
    if (comma == std::string_view::npos) return parts;
    text.remove_prefix(comma + 1);
  }
}

/// libpq's sentence without what it quotes of the URL, which may hold a password; the name of a
/// parameter is none.
std::string Sentence(const char* text) {
  std::string sentence = text == nullptr ? "no cause given" : text;
  while (!sentence.empty() && sentence.back() == '\n') sentence.pop_back();
  if (sentence.find("URI query parameter: ") != std::string::npos &&
      sentence.find_first_of(":=@%", sentence.find('"')) == std::string::npos) {
    return sentence;
  }
  const std::size_t first = sentence.find('"');
  const std::size_t last = sentence.rfind('"');
  if (first != last) sentence.replace(first + 1, last - first - 1, "...");
  return sentence;
}

bool IsOfPlace(std::string_view keyword) {
  return keyword == "host" || keyword == "hostaddr" || keyword == "port";
}

/// The lists of hosts and ports as libpq pairs them: one port stands for all.
absl::Status FillPlaces(const std::vector<std::pair<std::string, std::string>>& lists, Url& url) {
  std::size_t places = 1;
  for (const auto& [keyword, value] : lists) places = std::max(places, SplitList(value).size());
  url.places.resize(places);
  for (const auto& [keyword, value] : lists) {
    const std::vector<std::string> parts = SplitList(value);
    if (parts.size() != places && parts.size() != 1) {
      return absl::InvalidArgumentError("store.url names " + std::to_string(places) +
                                        " hosts and " + std::to_string(parts.size()) + " of " +
                                        keyword + "; name one, or one for each host");
    }
    for (std::size_t i = 0; i < places; ++i) {
      const std::string& part = parts[parts.size() == 1 ? 0 : i];
      if (!part.empty()) url.places[i].emplace_back(keyword, part);
    }
  }
  return absl::OkStatus();
}

}  // namespace

bool IsPostgresUrl(std::string_view url) {
  return url.starts_with("postgresql://") || url.starts_with("postgres://");
}

absl::StatusOr<Url> ParseUrl(std::string_view url) {
  if (!IsPostgresUrl(url)) {
    return absl::InvalidArgumentError("store.url does not begin with postgresql://HOST/DATABASE");
  }
  char* error = nullptr;
  const std::unique_ptr<PQconninfoOption, FreeOptions> options(
      PQconninfoParse(std::string(url).c_str(), &error));
  const std::unique_ptr<char, void (*)(void*)> owned(error, PQfreemem);
  if (options == nullptr) return absl::InvalidArgumentError("store.url: " + Sentence(error));

  Url parsed;
  std::vector<std::pair<std::string, std::string>> lists;
  std::string host;
  std::string port = "5432";
  std::string database;
  for (const PQconninfoOption* option = options.get(); option->keyword != nullptr; ++option) {
    if (option->val == nullptr) continue;
    const std::string keyword = option->keyword;
    if (keyword == "password" || keyword == "sslpassword") {
      return absl::InvalidArgumentError(
          "store.url holds a " + keyword +
          "; name a file in store.password_file, or use ~/.pgpass or PGPASSFILE");
    }
    if (keyword == "replication") {
      return absl::InvalidArgumentError(
          "store.url asks for a session for replication; remove the parameter");
    }
    if (keyword == "host") host = option->val;
    if (keyword == "hostaddr" && host.empty()) host = option->val;
    if (keyword == "port") port = option->val;
    if (keyword == "dbname") database = option->val;
    (IsOfPlace(keyword) ? lists : parsed.settings).emplace_back(keyword, option->val);
  }
  absl::Status filled = FillPlaces(lists, parsed);
  if (!filled.ok()) return filled;
  parsed.shown = host.empty() ? "local socket" : host;
  parsed.shown += ":" + port;
  if (!database.empty()) parsed.shown += "/" + database;
  return parsed;
}

}  // namespace uplink::storage::postgres
