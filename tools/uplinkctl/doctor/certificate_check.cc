#include "tools/uplinkctl/doctor/certificate_check.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/core.h>
#include <fmt/format.h>

#include "schema/base/doc_page.h"
#include "server/config/address.h"
#include "server/identity/expiry.h"

namespace uplink::ctl {
namespace {

std::string Renew() {
  return "renew it with every name that robots dial; see " +
         DocPage("docs/operate/security.md", "Renew a certificate");
}

std::string DaysText(milliseconds span) {
  const auto days = std::chrono::duration_cast<std::chrono::days>(span).count();
  if (days > 0) return fmt::format("{} day{}", days, days == 1 ? "" : "s");
  return fmt::format("{} h", std::chrono::duration_cast<std::chrono::hours>(span).count());
}

/// What is wrong with the dates.
struct Dates {
  Severity severity = Severity::kOk;
  std::string text;
};

Dates JudgeDates(const CertificateFacts& certificate, SystemTime now) {
  const std::string end = identity::ExpiryText(certificate.end);
  if (now >= certificate.end) {
    return {Severity::kError,
            fmt::format("expired {} ago, at {}", DaysText(now - certificate.end), end)};
  }
  if (now < certificate.begin) {
    return {Severity::kError,
            fmt::format("is not valid before {}: the certificate or this machine's clock is wrong",
                        identity::ExpiryText(certificate.begin))};
  }
  if (certificate.end >= identity::kNoExpiry) return {Severity::kOk, "never expires"};
  const std::string left =
      fmt::format("expires in {}, at {}", DaysText(certificate.end - now), end);
  return {certificate.end - now < kExpirySoon ? Severity::kWarning : Severity::kOk, left};
}

/// `what` names the certificate.
Finding DatesFinding(const std::string& key, const std::string& what, const Dates& dates,
                     const std::string& remedy) {
  Finding finding{dates.severity, key, what + " " + dates.text};
  if (dates.severity != Severity::kOk) finding.remedy = remedy;
  return finding;
}

Finding TrustFinding(const ServerCertificate& certificate) {
  const auto& [key, path] = certificate.file;
  const std::string& issuer = certificate.facts.issuer;
  switch (certificate.facts.trust) {
    case Trust::kOwnAuthority:
      return Ok(key, "it leads to an authority of tls.client_ca_file");
    case Trust::kSystem:
      return Ok(key, "it leads to an authority that this machine trusts");
    case Trust::kElsewhere:
      return Ok(key, fmt::format("its authority {} is not in tls.client_ca_file: robots must have "
                                 "it as theirs",
                                 issuer));
    case Trust::kOtherKey:
      return Error(key,
                   fmt::format("{} was not signed by the authority {} of tls.client_ca_file, but "
                               "by another of that name",
                               path, issuer),
                   "issue it anew by that authority, or name the file of the other one");
    case Trust::kBroken:
      return Error(key, fmt::format("a certificate of {} is not signed by the one behind it", path),
                   "put the server's first, then each one's issuer");
  }
  return {};
}

bool IsLoopbackName(const std::string& name) { return config::IsLoopbackHost(name); }

Finding NamesFinding(const ServerCertificate& certificate) {
  const auto& [key, path] = certificate.file;
  const std::vector<std::string>& names = certificate.facts.names;
  if (names.empty()) {
    return Error(key, fmt::format("{} names no host (subject alternative names)", path), Renew());
  }
  const std::string text = fmt::format("it is for {}", fmt::join(names, ", "));
  if (certificate.serves_others && std::all_of(names.begin(), names.end(), IsLoopbackName)) {
    return Warning(key, text + " alone: robots on other machines cannot verify the server",
                   Renew());
  }
  return Ok(key, text);
}

}  // namespace

Findings ServerCertificateFindings(const ServerCertificate& certificate, SystemTime now) {
  const auto& [key, path] = certificate.file;
  const std::vector<CertificateFacts>& chain = certificate.facts.chain;
  Findings findings{DatesFinding(key, path, JudgeDates(chain.front(), now), Renew())};
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const Dates dates = JudgeDates(chain[i], now);
    if (dates.severity == Severity::kOk) continue;
    findings.push_back(
        DatesFinding(key, fmt::format("{}, {} behind the server's,", path, chain[i].subject), dates,
                     "ask its authority for a new chain"));
  }
  findings.push_back(TrustFinding(certificate));
  findings.push_back(NamesFinding(certificate));
  return findings;
}

Findings AuthorityFindings(const NamedFile& file, const std::vector<CertificateFacts>& authorities,
                           SystemTime now) {
  int good = 0;
  SystemTime good_until = identity::kNoExpiry;
  for (const CertificateFacts& each : authorities) {
    if (JudgeDates(each, now).severity == Severity::kError) continue;
    ++good;
    good_until = std::min(good_until, each.end);
  }
  Findings findings;
  if (good > 0) {
    const std::string until = good_until < identity::kNoExpiry
                                  ? ", good until " + identity::ExpiryText(good_until)
                                  : std::string();
    findings.push_back(Ok(file.key, fmt::format("{} has {} authorit{} that did not expire{}",
                                                file.path, good, good == 1 ? "y" : "ies", until)));
  }
  for (const CertificateFacts& authority : authorities) {
    Dates dates = JudgeDates(authority, now);
    if (dates.severity == Severity::kOk) continue;
    // The robots of the others connect.
    if (good > 0) dates.severity = Severity::kWarning;
    findings.push_back(DatesFinding(
        file.key, fmt::format("authority {} of {}", authority.subject, file.path), dates,
        "extend it with the same key; see " +
            DocPage("docs/operate/security.md", "The robots' authority expired")));
  }
  return findings;
}

Findings ListFindings(const NamedFile& file, const std::vector<identity::RevocationList>& lists,
                      SystemTime now) {
  Findings findings;
  for (const identity::RevocationList& list : lists) {
    if (!list.next_update || now < *list.next_update) continue;
    findings.push_back(Warning(
        file.key,
        fmt::format("the list of {} in {} is over since {}: it counts, and misses what was revoked "
                    "later",
                    list.issuer, file.path, identity::ExpiryText(*list.next_update)),
        "let its authority write the next one"));
  }
  return findings;
}

Findings ShownCertificateFindings(const NamedFile& file, const std::vector<CertificateFacts>& chain,
                                  SystemTime now) {
  if (chain.empty()) return {};
  return {DatesFinding(file.key, file.path, JudgeDates(chain.front(), now),
                       "rename a new certificate and its key into place")};
}

}  // namespace uplink::ctl
