#include "tools/uplinkctl/ask/access.h"

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <sys/stat.h>

#include "schema/base/file_text.h"
#include "server/config/address.h"
#include "server/identity/pem_file.h"

namespace uplink::ctl {
namespace {

absl::Status Wrong(const std::string& text) { return absl::InvalidArgumentError(text); }

/// b64token of RFC 6750, section 2.1.
bool IsTokenCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '.' || c == '_' || c == '~' || c == '+' || c == '/' || c == '=';
}

/// A secret that others may read is none.
absl::Status CheckSecret(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    return Wrong(fmt::format("{}: {}", path, std::generic_category().message(errno)));
  }
  constexpr mode_t kOthers = S_IRWXO | S_IWGRP;
  if ((status.st_mode & kOthers) == 0) return absl::OkStatus();
  return Wrong(
      fmt::format("{}: others than its owner may read or write it (mode {:04o}); chmod 600 {}",
                  path, status.st_mode & 07777U, path));
}

absl::StatusOr<std::string> ReadText(const std::string& path) {
  if (path.empty()) return std::string();
  auto pem = identity::ReadPem(path);
  if (!pem.ok()) return Wrong(std::string(pem.status().message()));
  // An empty text would stand for no file.
  if (pem->text.empty()) return Wrong(path + ": is empty");
  return std::move(pem->text);
}

/// The files are named in the error: what is in them has no name.
absl::Status WithFiles(const absl::Status& status, const AccessFiles& files,
                       const std::string& server_certificate_file) {
  std::string names;
  for (const std::string& each :
       {files.ca_file, files.certificate_file, files.key_file, server_certificate_file}) {
    if (!each.empty()) names += (names.empty() ? "" : ", ") + each;
  }
  return Wrong(
      fmt::format("{}: {}", names.empty() ? "https" : names, std::string(status.message())));
}

absl::Status AddTls(link::HttpServer& server, const AccessFiles& files,
                    const std::string& server_certificate_file) {
  if (!files.key_file.empty()) {
    if (absl::Status secret = CheckSecret(files.key_file); !secret.ok()) return secret;
  }
  link::ServerTlsOptions options;
  const std::pair<const std::string*, std::string*> texts[] = {
      {&files.ca_file, &options.authorities},
      {&files.certificate_file, &options.certificate},
      {&files.key_file, &options.key}};
  for (const auto& [path, text] : texts) {
    auto read = ReadText(*path);
    if (!read.ok()) return read.status();
    *text = *std::move(read);
  }
  // Who names authorities wants them to decide.
  const bool own = files.ca_file.empty() && !server_certificate_file.empty();
  if (own) {
    auto read = ReadText(server_certificate_file);
    if (!read.ok()) return read.status();
    options.server_certificate = *std::move(read);
  }
  auto tls = link::ServerTls::Create(options);
  if (!tls.ok()) return WithFiles(tls.status(), files, own ? server_certificate_file : "");
  server.tls = *std::move(tls);
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckAccess(const ServerUrl& url, const AccessFiles& files) {
  if (files.certificate_file.empty() != files.key_file.empty()) {
    return Wrong("--certificate-file and --key-file go together");
  }
  if (url.tls || (files.ca_file.empty() && files.certificate_file.empty())) return absl::OkStatus();
  return Wrong(fmt::format(
      "{} is asked without TLS: --ca-file, --certificate-file and --key-file are for https://",
      ToText(url)));
}

absl::StatusOr<std::string> ReadToken(const std::string& path) {
  if (absl::Status secret = CheckSecret(path); !secret.ok()) return secret;
  FileText file = ReadFileText(path, kTokenFileBytesMax);
  if (!file.problem.empty()) return Wrong(fmt::format("{}: {}", path, file.problem));
  std::string token = file.text.substr(0, file.text.find_first_of("\r\n"));
  if (!token.empty() && std::ranges::all_of(token, IsTokenCharacter)) return token;
  return Wrong(fmt::format(
      "{}: its first line is no token; it holds what uplinkctl tokens new prints", path));
}

absl::StatusOr<link::HttpServer> ServerWith(const ServerUrl& url, const AccessFiles& files,
                                            const std::string& server_certificate_file) {
  if (absl::Status good = CheckAccess(url, files); !good.ok()) return good;
  link::HttpServer server{.address = url.address};
  if (!files.token_file.empty()) {
    absl::StatusOr<std::string> token = ReadToken(files.token_file);
    if (!token.ok()) return token.status();
    server.token = *std::move(token);
  }
  if (!url.tls) return server;
  if (absl::Status added = AddTls(server, files, server_certificate_file); !added.ok()) {
    return added;
  }
  return server;
}

absl::StatusOr<link::HttpServer> ServerToProbe(const ServerUrl& url) {
  link::HttpServer server{.address = url.address};
  if (!url.tls) return server;
  auto tls = link::ServerTls::Create({.authorities = {}, .verify = false});
  if (!tls.ok()) return tls.status();
  server.tls = *std::move(tls);
  return server;
}

bool ShowsToken(const link::HttpServer& server) {
  if (server.token.empty() || server.tls != nullptr || server.address.starts_with('/')) {
    return false;
  }
  std::string host = server.address.substr(0, server.address.rfind(':'));
  if (host.starts_with('[')) host = host.substr(1, host.size() - 2);
  return !config::IsLoopbackHost(host);
}

}  // namespace uplink::ctl
