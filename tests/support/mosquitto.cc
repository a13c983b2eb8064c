#include "tests/support/mosquitto.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <utility>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

constexpr const char* kProgram = "/usr/sbin/mosquitto";
constexpr const char* kPasswords = "/usr/bin/mosquitto_passwd";
/// Between our look for a free port and the broker's start another one may take it.
constexpr int kTries = 10;

void WriteText(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
  std::filesystem::permissions(
      path, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

void ReplaceAll(std::string& text, const std::string& word, const std::string& with) {
  for (std::size_t at = text.find(word); at != std::string::npos;
       at = text.find(word, at + with.size())) {
    text.replace(at, word.size(), with);
  }
}

}  // namespace

Mosquitto::Mosquitto(const MosquittoOptions& options) : options_(options) {
  UPLINK_CHECK(std::filesystem::exists(kProgram), "install mosquitto (tools/dev/packages.txt)");
  WriteText(folder_.File("acl"), options_.acl);
  WriteText(folder_.File("passwords"), "");
  for (const auto& [user, password] : options_.users) {
    ServerProcess added({kPasswords, "-b", folder_.File("passwords"), user, password});
    UPLINK_CHECK(added.WaitForExit() == 0, "mosquitto_passwd takes a password");
  }
  WriteText(folder_.File("cert.pem"), options_.certificate);
  WriteText(folder_.File("key.pem"), options_.key);
  WriteText(folder_.File("ca.pem"), options_.client_ca);
  for (int tried = 0; tried < kTries; ++tried) {
    port_ = FreePort();
    WriteConfiguration();
    process_ = std::make_unique<ServerProcess>(
        std::vector<std::string>{kProgram, "-c", folder_.File("mosquitto.conf")});
    if (process_->WaitFor(" running")) return;
  }
  UPLINK_CHECK(false, process_->text());
}

Mosquitto::~Mosquitto() = default;

void Mosquitto::WriteConfiguration() {
  if (!options_.configuration.empty()) {
    std::string text = options_.configuration;
    ReplaceAll(text, "FOLDER", folder_.path());
    ReplaceAll(text, "PORT", std::to_string(port_));
    return WriteText(folder_.File("mosquitto.conf"), text);
  }
  std::string text =
      std::string("user root\nlog_dest stderr\nlog_timestamp false\n") +
      (options_.tells_packets
           ? "log_type all\n"
           : "log_type error\nlog_type warning\nlog_type notice\nlog_type information\n") +
      "persistence true\npersistence_location " + folder_.path() + "/\nlistener " +
      std::to_string(port_) + " 127.0.0.1\n";
  if (options_.users.empty()) {
    text += "allow_anonymous true\n";
  } else {
    text += "allow_anonymous false\npassword_file " + folder_.File("passwords") + "\n";
  }
  if (!options_.acl.empty()) text += "acl_file " + folder_.File("acl") + "\n";
  if (!options_.certificate.empty()) {
    text += "certfile " + folder_.File("cert.pem") + "\nkeyfile " + folder_.File("key.pem") + "\n";
  }
  if (!options_.client_ca.empty()) {
    text += "cafile " + folder_.File("ca.pem") + "\nrequire_certificate true\n";
  }
  WriteText(folder_.File("mosquitto.conf"), text + options_.lines);
}

std::string Mosquitto::SecurityPlugin() {
  // Below a folder that is named after the machine's kind.
  for (const auto& folder : std::filesystem::directory_iterator("/usr/lib")) {
    const std::filesystem::path plugin = folder.path() / "mosquitto_dynamic_security.so";
    if (std::filesystem::exists(plugin)) return plugin.string();
  }
  UPLINK_CHECK(false, "install mosquitto (tools/dev/packages.txt)");
}

void Mosquitto::Stop() {
  process_->Signal(SIGTERM);
  UPLINK_CHECK(process_->WaitForExit().has_value(), "mosquitto ends when it is told to");
}

void Mosquitto::Start() {
  process_ = std::make_unique<ServerProcess>(
      std::vector<std::string>{kProgram, "-c", folder_.File("mosquitto.conf")});
  UPLINK_CHECK(process_->WaitFor(" running"), process_->text());
}

bool Mosquitto::Logged(const std::string& part) { return process_->WaitFor(part, milliseconds(1)); }

}  // namespace uplink::testing
