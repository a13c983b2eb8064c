#include "server/http/token_files.h"

#include <utility>

#include <absl/status/statusor.h>

#include "server/config/file_modes.h"

namespace uplink::http {

TokenFiles::TokenFiles(Paths paths, const log::Logger& logger)
    : paths_(std::move(paths)), logger_(logger), tokens_(std::make_shared<const Tokens>()) {}

absl::Status TokenFiles::Look() {
  Tokens fresh = *tokens();
  // Each by itself, so that a flaw in one keeps no revoked token of the other alive.
  const absl::StatusOr<bool> table = ReadTable(fresh);
  const absl::StatusOr<bool> scrape = ReadScrape(fresh);
  const bool changed = table.value_or(false) || scrape.value_or(false);
  if (changed) {
    const std::lock_guard lock(mutex_);
    tokens_ = std::make_shared<const Tokens>(std::move(fresh));
  }
  absl::Status looked = table.status();
  looked.Update(scrape.status());
  const bool was_unread = unread_.exchange(!looked.ok());
  const std::string before = std::exchange(why_, std::string(looked.message()));
  // A new reason is logged too: after one file is corrected, the other may not be good either.
  if (!looked.ok() && before != why_) logger_.Error("tokens_unreadable", {{"why", why_}});
  if (changed || (looked.ok() && was_unread)) {
    logger_.Info("tokens_read", {{"tokens", tokens()->table.entries().size()}});
  }
  return looked;
}

// Who may write them chooses who may ask. Checked after the files were read, since they could
// change between an earlier check and the read.

absl::StatusOr<bool> TokenFiles::ReadTable(Tokens& tokens) {
  identity::ReadTokens read;
  if (!paths_.tokens.empty()) {
    auto file = identity::ReadTokenFile(paths_.tokens);
    if (!file.ok()) return file.status();
    if (absl::Status good = config::CheckWriters(paths_.tokens); !good.ok()) return good;
    read = *std::move(file);
  }
  if (text_ == read.text) return false;
  text_ = std::move(read.text);
  tokens.table = std::move(read.table);
  return true;
}

absl::StatusOr<bool> TokenFiles::ReadScrape(Tokens& tokens) const {
  if (paths_.scrape.empty()) return false;
  const auto hash = identity::ReadScrapeToken(paths_.scrape);
  if (!hash.ok()) return hash.status();
  if (absl::Status good = config::CheckWriters(paths_.scrape); !good.ok()) return good;
  if (tokens.scrape == *hash) return false;
  tokens.scrape = *hash;
  return true;
}

std::shared_ptr<const Tokens> TokenFiles::tokens() const {
  const std::lock_guard lock(mutex_);
  return tokens_;
}

}  // namespace uplink::http
