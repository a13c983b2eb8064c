#include "server/transport/key_files.h"

#include <utility>

#include "server/config/authority_folder.h"
#include "server/config/file_modes.h"
#include "server/identity/authorities.h"
#include "server/identity/pem_file.h"
#include "server/identity/server_pair.h"

namespace uplink::transport {
namespace {

using identity::NamedPem;

absl::Status CheckNamed(const NamedPem& certificate, const NamedPem& key,
                        const NamedPem& client_ca) {
  if (absl::Status fit = identity::CheckServerPair(certificate, key); !fit.ok()) return fit;
  return identity::CheckAuthorities(client_ca);
}

/// Whom we trust, and for what.
struct Trusted {
  NamedPem pem;
  identity::AuthorityRules rules;
};

absl::StatusOr<Trusted> ReadTrusted(const PemFiles& files) {
  Trusted trusted{.pem = {files.client_ca, {}}, .rules = {}};
  if (!files.client_ca.empty() || files.authorities.empty()) {
    auto pem = identity::ReadPem(files.client_ca);
    if (!pem.ok()) return pem.status();
    trusted.pem = *std::move(pem);
  }
  if (files.authorities.empty()) return trusted;
  auto folder = config::ReadAuthorityFolder(files.authorities);
  if (!folder.ok()) return folder.status();
  if (trusted.pem.name.empty()) trusted.pem.name = files.authorities;
  if (!files.entries_alone) trusted.pem.text.append("\n").append(folder->pems);
  trusted.rules = std::move(folder->rules);
  return trusted;
}

}  // namespace

absl::Status CheckTexts(const PemTexts& texts) {
  return CheckNamed({"the certificate", texts.certificate}, {"the key", texts.key},
                    {"the client authority", texts.client_ca});
}

absl::StatusOr<bool> KeyFiles::Refresh() {
  auto certificate = identity::ReadPem(files_.certificate);
  if (!certificate.ok()) return certificate.status();
  auto key = identity::ReadPem(files_.key);
  if (!key.ok()) return key.status();
  auto trusted = ReadTrusted(files_);
  if (!trusted.ok()) return trusted.status();
  NamedPem* const client_ca = &trusted->pem;
  // A user who may write them chooses which robots are admitted. Checked after the files were read,
  // since they could change between an earlier check and the read.
  for (const std::string& path : {files_.certificate, files_.key, files_.client_ca}) {
    if (path.empty()) continue;
    if (absl::Status good = config::CheckWriters(path); !good.ok()) return good;
  }
  if (certificate->text == texts_.certificate && key->text == texts_.key &&
      client_ca->text == texts_.client_ca && trusted->rules == texts_.rules) {
    return false;
  }
  if (absl::Status good = CheckNamed(*certificate, *key, *client_ca); !good.ok()) return good;
  auto served = identity::ServedPemsOf(*certificate, *client_ca);
  if (!served.ok()) return served.status();
  served_ = *std::move(served);
  texts_ = {std::move(certificate->text), std::move(key->text), std::move(client_ca->text),
            std::move(trusted->rules)};
  return true;
}

}  // namespace uplink::transport
