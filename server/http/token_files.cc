#include "server/http/token_files.h"

#include <utility>

#include <absl/status/statusor.h>

#include "server/config/file_modes.h"

namespace uplink::http {

TokenFiles::TokenFiles(Paths paths, const log::Logger& logger)
    : paths_(std::move(paths)), logger_(logger), tokens_(std::make_shared<const Tokens>()) {}

absl::Status TokenFiles::Look() {
  absl::StatusOr<std::shared_ptr<const Tokens>> read = Read();
  const bool was_unread = unread_.exchange(!read.ok());
  if (!read.ok()) {
    // A new reason is logged too: after one file is corrected, the other may not be good either.
    const std::string before = std::exchange(why_, std::string(read.status().message()));
    if (!was_unread || before != why_) {
      logger_.Error("tokens_unreadable", {{"why", why_}});
    }
    return read.status();
  }
  why_.clear();
  if (*read != nullptr) {
    const std::lock_guard lock(mutex_);
    tokens_ = *std::move(read);
  } else if (!was_unread) {
    return absl::OkStatus();
  }
  logger_.Info("tokens_read", {{"tokens", tokens()->table.entries().size()}});
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const Tokens>> TokenFiles::Read() {
  identity::ReadTokens read;
  if (!paths_.tokens.empty()) {
    auto file = identity::ReadTokenFile(paths_.tokens);
    if (!file.ok()) return file.status();
    read = *std::move(file);
  }
  std::optional<identity::TokenHash> scrape;
  if (!paths_.scrape.empty()) {
    const auto hash = identity::ReadScrapeToken(paths_.scrape);
    if (!hash.ok()) return hash.status();
    scrape = *hash;
  }
  // Who may write them chooses who may ask. Checked after the files were read, since they could
  // change between an earlier check and the read.
  for (const std::string& path : {paths_.tokens, paths_.scrape}) {
    if (path.empty()) continue;
    if (absl::Status good = config::CheckWriters(path); !good.ok()) return good;
  }
  if (looked_ && read.text == text_ && scrape == tokens()->scrape) {
    return std::shared_ptr<const Tokens>();
  }
  looked_ = true;
  text_ = std::move(read.text);
  return std::make_shared<const Tokens>(Tokens{std::move(read.table), scrape});
}

std::shared_ptr<const Tokens> TokenFiles::tokens() const {
  const std::lock_guard lock(mutex_);
  return tokens_;
}

}  // namespace uplink::http
