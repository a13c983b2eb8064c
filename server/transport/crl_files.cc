#include "server/transport/crl_files.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "server/config/file_modes.h"
#include "server/identity/expiry.h"
#include "server/identity/pem_file.h"

namespace uplink::transport {
namespace {

struct Texts {
  identity::NamedPem lists;
  identity::NamedPem authorities;
};

absl::StatusOr<Texts> Read(const CrlFile& file) {
  auto lists = identity::ReadPem(file.lists);
  if (!lists.ok()) return lists.status();
  auto authorities = identity::ReadPem(file.authorities);
  if (!authorities.ok()) return authorities.status();
  // Who may write it chooses who is turned away. Checked after it was read, as in KeyFiles.
  if (absl::Status good = config::CheckWriters(file.lists); !good.ok()) return good;
  return Texts{*std::move(lists), *std::move(authorities)};
}

}  // namespace

std::optional<std::vector<identity::SignedSerial>> CrlFiles::Look() {
  const std::vector<CrlFile> files = files_();
  // A file that is not named any more has no say.
  bool changed = std::erase_if(followed_, [&files](const Followed& each) {
                   return std::ranges::find(files, each.file) == files.end();
                 }) > 0;
  for (const CrlFile& file : files) {
    auto found = std::ranges::find(followed_, file, &Followed::file);
    if (found == followed_.end()) {
      found = followed_.emplace(followed_.end());
      found->file = file;
    }
    changed = LookAt(*found) || changed;
    TellOver(*found);
  }
  unread_.store(std::ranges::any_of(
      followed_, [](const Followed& each) { return !each.why.empty() || each.told_over; }));
  if (!changed) return std::nullopt;
  std::vector<identity::SignedSerial> revoked;
  for (const Followed& each : followed_) {
    for (const identity::RevocationList& list : each.lists) {
      revoked.insert(revoked.end(), list.revoked.begin(), list.revoked.end());
    }
  }
  return revoked;
}

bool CrlFiles::LookAt(Followed& followed) {
  auto texts = Read(followed.file);
  const bool is_same = texts.ok() && followed.why.empty() && texts->lists.text == followed.text &&
                       texts->authorities.text == followed.authorities;
  if (is_same) return false;
  absl::StatusOr<std::vector<identity::RevocationList>> lists =
      texts.ok() ? identity::ReadRevocationLists(texts->lists, texts->authorities) : texts.status();
  const std::string before = std::exchange(followed.why, std::string(lists.status().message()));
  if (!lists.ok()) {
    if (before != followed.why) {
      logger_.Error("crl_unreadable", {{"file", followed.file.lists}, {"why", followed.why}});
    }
    return false;
  }
  followed.text = std::move(texts->lists.text);
  followed.authorities = std::move(texts->authorities.text);
  followed.lists = *std::move(lists);
  followed.told_over = false;
  std::size_t revoked = 0;
  for (const identity::RevocationList& list : followed.lists) revoked += list.revoked.size();
  logger_.Info(
      "crl_read",
      {{"file", followed.file.lists}, {"lists", followed.lists.size()}, {"revoked", revoked}});
  return true;
}

void CrlFiles::TellOver(Followed& followed) {
  if (followed.told_over) return;
  for (const identity::RevocationList& list : followed.lists) {
    if (!list.next_update || *list.next_update > clock_.System()) continue;
    followed.told_over = true;
    logger_.Warn("crl_expired", {{"file", followed.file.lists},
                                 {"issuer", list.issuer},
                                 {"expires", identity::ExpiryText(*list.next_update)}});
    return;
  }
}

}  // namespace uplink::transport
