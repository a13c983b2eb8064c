#include "tools/pki/directory.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/pki/folder_lock.h"

namespace uplink::pki {
namespace {

constexpr mode_t kFileMode = 0600;
constexpr mode_t kFolderMode = 0700;

absl::Status SystemError(const std::string& path, const char* doing, int error) {
  const char* const remedy = error == EACCES || error == EPERM ? "; let this user do it" : "";
  const std::string text = fmt::format("{}: cannot be {}: {}{}", path, doing,
                                       std::generic_category().message(error), remedy);
  if (error == ENOENT) return absl::NotFoundError(text);
  if (error == EACCES || error == EPERM) return absl::PermissionDeniedError(text);
  return absl::InternalError(text);
}

absl::Status Taken(const std::string& path) {
  return absl::AlreadyExistsError(
      fmt::format("{}: already there; --keep leaves it, --force replaces it for good", path));
}

bool Exists(const std::string& path) {
  struct stat info {};
  return lstat(path.c_str(), &info) == 0;
}

bool WriteAll(int fd, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t n = write(fd, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    written += static_cast<std::size_t>(n);
  }
  return fsync(fd) == 0;
}

absl::Status WriteFile(const std::string& path, const std::string& text, Existing existing) {
  const std::filesystem::path whole(path);
  const std::filesystem::path folder = whole.has_parent_path() ? whole.parent_path() : ".";
  const FolderLock lock(folder.string());
  const std::string aside = folder / fmt::format(".{}.new", whole.filename().string());
  // A call that was killed as it wrote may have left one, with a private key.
  unlink(aside.c_str());
  const int fd =
      open(aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, kFileMode);
  if (fd < 0) return SystemError(aside, "written", errno);
  const bool written = fchmod(fd, kFileMode) == 0 && WriteAll(fd, text);
  const int write_error = errno;
  close(fd);
  int error = written ? 0 : write_error;
  if (written) {
    // link() refuses an existing name in one step; rename() replaces it in one step.
    if (existing == Existing::kReplace) {
      error = rename(aside.c_str(), path.c_str()) == 0 ? 0 : errno;
    } else {
      error = link(aside.c_str(), path.c_str()) == 0 ? 0 : errno;
    }
  }
  if (error != 0 || existing == Existing::kRefuse) unlink(aside.c_str());
  if (error == EEXIST) return Taken(path);
  return error == 0 ? absl::OkStatus() : SystemError(path, "written", error);
}

absl::StatusOr<std::string> ReadFile(const std::string& path) {
  // If it is a pipe, do not wait for its writer.
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return SystemError(path, "read", errno);
  struct stat info {};
  if (fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) {
    close(fd);
    return absl::InvalidArgumentError(
        fmt::format("{}: it is not a regular file; name the right folder (--dir)", path));
  }
  std::string text(kPemBytesMax + 1, '\0');
  std::size_t size = 0;
  ssize_t n = 0;
  while (size < text.size() && (n = read(fd, text.data() + size, text.size() - size)) > 0) {
    size += static_cast<std::size_t>(n);
  }
  const int error = errno;
  close(fd);
  if (n < 0) return SystemError(path, "read", error);
  if (size > kPemBytesMax) {
    return absl::InvalidArgumentError(
        fmt::format("{}: larger than {} bytes; name the right folder (--dir)", path, kPemBytesMax));
  }
  text.resize(size);
  return text;
}

/// Who owns a folder, or may write into it, can put a key or an authority of theirs in place of
/// ours.
absl::Status CheckTrusted(const std::string& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) return SystemError(path, "looked at", errno);
  return CheckFolder(path, {.owner = info.st_uid, .mode = info.st_mode}, geteuid());
}

}  // namespace

absl::Status CheckFolder(const std::string& path, const FolderFacts& facts, uid_t caller) {
  if (facts.owner != 0 && facts.owner != caller) {
    return absl::FailedPreconditionError(
        fmt::format("{}: the folder belongs to user {}, who could replace the files; name another, "
                    "or give it to this user: chown {} {}",
                    path, facts.owner, caller, path));
  }
  if ((facts.mode & (S_IWGRP | S_IWOTH)) != 0) {
    return absl::FailedPreconditionError(
        fmt::format("{}: others than the folder's owner may write into it (mode {:04o}) and could "
                    "replace the files; name another, or take that away: chmod go-w {}",
                    path, facts.mode & 07777U, path));
  }
  return absl::OkStatus();
}

std::string Directory::CertificatePath(const std::string& name) const {
  return (std::filesystem::path(path_) / (name + ".crt")).string();
}

std::string Directory::KeyPath(const std::string& name) const {
  return (std::filesystem::path(path_) / (name + ".key")).string();
}

absl::Status Directory::Prepare() const {
  const std::filesystem::path folder(path_);
  std::error_code error;
  if (folder.has_parent_path()) {
    std::filesystem::create_directories(folder.parent_path(), error);
    if (error) return SystemError(folder.parent_path().string(), "made", error.value());
  }
  if (mkdir(path_.c_str(), kFolderMode) != 0 && errno != EEXIST) {
    return SystemError(path_, "made", errno);
  }
  if (!std::filesystem::is_directory(folder, error)) {
    return absl::InvalidArgumentError(
        fmt::format("{}: it is not a folder; name another (--dir)", path_));
  }
  return CheckTrusted(path_);
}

absl::StatusOr<bool> Directory::HasPair(const std::string& name) const {
  const bool certificate = Exists(CertificatePath(name));
  const bool key = Exists(KeyPath(name));
  if (certificate == key) return certificate;
  const std::string there = certificate ? CertificatePath(name) : KeyPath(name);
  const std::string missing = certificate ? KeyPath(name) : CertificatePath(name);
  return absl::FailedPreconditionError(
      fmt::format("{} is there and {} is missing; restore the missing file, or make both anew with "
                  "--force in place of --keep",
                  there, missing));
}

absl::Status Directory::CheckFree(const std::string& name) const {
  for (const std::string& path : {CertificatePath(name), KeyPath(name)}) {
    if (Exists(path)) return Taken(path);
  }
  return absl::OkStatus();
}

absl::Status Directory::Write(const std::string& name, const Credentials& credentials,
                              Existing existing) const {
  if (existing == Existing::kRefuse) {
    if (absl::Status status = CheckFree(name); !status.ok()) return status;
  }
  // The key first: a certificate without its key would be of no use.
  if (absl::Status status = WriteFile(KeyPath(name), credentials.key_pem, existing); !status.ok()) {
    return status;
  }
  return WriteFile(CertificatePath(name), credentials.certificate_pem, existing);
}

absl::Status Directory::WriteCertificate(const std::string& name,
                                         const Credentials& credentials) const {
  return WriteFile(CertificatePath(name), credentials.certificate_pem, Existing::kReplace);
}

absl::StatusOr<Credentials> Directory::Read(const std::string& name) const {
  absl::StatusOr<std::string> certificate = ReadFile(CertificatePath(name));
  if (!certificate.ok()) return certificate.status();
  absl::StatusOr<std::string> key = ReadFile(KeyPath(name));
  if (!key.ok()) return key.status();
  return Credentials{std::move(*certificate), std::move(*key)};
}

absl::StatusOr<std::unique_ptr<Authority>> Directory::LoadAuthority() const {
  const absl::StatusOr<Credentials> credentials = Read(kAuthorityName);
  if (absl::IsNotFound(credentials.status())) {
    return absl::NotFoundError(
        fmt::format("{}; make the authority first (uplinkctl pki init --dir {})",
                    std::string(credentials.status().message()), path_));
  }
  if (!credentials.ok()) return credentials.status();
  absl::StatusOr<std::unique_ptr<Authority>> authority = Authority::Load(*credentials);
  if (!authority.ok()) {
    return absl::Status(authority.status().code(),
                        fmt::format("{}: {}", path_, std::string(authority.status().message())));
  }
  return authority;
}

}  // namespace uplink::pki
