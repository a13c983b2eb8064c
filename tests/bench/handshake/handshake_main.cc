// What a connection that shows nothing we trust costs the server, by what it says: CPU of the
// server's side of one handshake, without sockets.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <openssl/evp.h>
#include <openssl/ssl.h>

#include "schema/base/check.h"
#include "server/config/tls_groups.h"
#include "server/front/tls/tls_engine.h"
#include "server/identity/pem.h"
#include "tests/bench/handshake/hellos.h"
#include "tests/support/certificates.h"
#include "tests/support/der.h"
#include "tests/support/memory_tls.h"
#include "tests/support/odd_certificates.h"

namespace uplink::bench {
namespace {

namespace der = testing::der;
namespace odd = testing::odd;
using front::TlsEngine;
using testing::MemoryTls;
using testing::RobotSpec;
using testing::ShownChain;

constexpr int kTimes = 31;
constexpr char kRuri[] = "rcan://x.local/robots/1";

/// Of this process, which has one thread.
double CpuMs() { return static_cast<double>(std::clock()) * 1e3 / CLOCKS_PER_SEC; }

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

transport::TlsRules RulesOf(config::TlsVersion minimum) {
  config::TlsConfig tls;
  tls.min_version = minimum;
  return {.minimum = minimum, .groups = config::ServedGroups(tls)};
}

std::string_view TextOf(TlsEngine::Step step, TlsEngine::Failure failure) {
  if (step == TlsEngine::Step::kDone) return "taken";
  if (step == TlsEngine::Step::kMore) return "waits";
  switch (failure) {
    case TlsEngine::Failure::kCertificate:
      return "certificate";
    case TlsEngine::Failure::kUntrusted:
      return "untrusted";
    case TlsEngine::Failure::kNoCertificate:
      return "no_certificate";
    case TlsEngine::Failure::kNothingShared:
      return "nothing_shared";
    default:  // the others are no case here
      return "handshake_error";
  }
}

class Bench final {
 public:
  /// One line of the table: handshakes with clients that say this, each turn of theirs in `pieces`.
  void Run(const std::string& name, const MemoryTls::Options& options, std::size_t pieces = 1) {
    Measure(name, [&](TlsEngine& engine, double& ms) {
      MemoryTls client(options);
      auto step = TlsEngine::Step::kMore;
      while (step == TlsEngine::Step::kMore) {
        const std::string heard = client.Step(buffers_.out);
        buffers_.out.clear();
        if (heard.empty()) break;
        step = HearInPieces(engine, heard, pieces, ms);
      }
      return step;
    });
  }
  void RunHello(const std::string& name, const std::string& hello) {
    Measure(name, [&](TlsEngine& engine, double& ms) { return Hear(engine, hello, ms); });
  }
  void Serve(config::TlsVersion minimum) {
    auto made = front::TlsContext::Make({.certificate = server_.certificate,
                                         .key = server_.key,
                                         .client_ca = authority.certificate()},
                                        RulesOf(minimum));
    UPLINK_CHECK(made.ok(), made.status().ToString());
    context_ = *made;
  }
  /// One signature by the server's key.
  double SignatureMs() const {
    const identity::Key key = *identity::ReadKey({"the key", server_.key});
    std::vector<double> all;
    for (int i = 0; i < kTimes; ++i) {
      EVP_MD_CTX* context = EVP_MD_CTX_new();
      unsigned char signature[256];
      std::size_t size = sizeof signature;
      const double before = CpuMs();
      EVP_DigestSignInit(context, nullptr, EVP_sha256(), nullptr, key.get());
      EVP_DigestSign(context, signature, &size, signature, 64);
      all.push_back(CpuMs() - before);
      EVP_MD_CTX_free(context);
    }
    return Median(all);
  }

  const testing::TestAuthority authority;

 private:
  TlsEngine::Step HearInPieces(TlsEngine& engine, std::string_view heard, std::size_t pieces,
                               double& ms) {
    auto step = TlsEngine::Step::kMore;
    for (std::size_t i = 0; i < pieces && step == TlsEngine::Step::kMore; ++i) {
      const std::size_t begin = heard.size() * i / pieces;
      step = Hear(engine, heard.substr(begin, heard.size() * (i + 1) / pieces - begin), ms);
    }
    return step;
  }

  TlsEngine::Step Hear(TlsEngine& engine, std::string_view heard, double& ms) {
    buffers_.in = heard;
    const double before = CpuMs();
    const auto step = engine.Handshake();
    ms += CpuMs() - before;
    return step;
  }

  void Measure(const std::string& name,
               const std::function<TlsEngine::Step(TlsEngine&, double&)>& handshake) {
    std::vector<double> all;
    std::string_view outcome;
    for (int i = 0; i < kTimes; ++i) {
      double ms = 0;
      double before = CpuMs();
      auto engine = std::make_unique<TlsEngine>(context_, method_, buffers_);
      ms += CpuMs() - before;
      const auto step = handshake(*engine, ms);
      outcome = TextOf(step, engine->failure());
      before = CpuMs();
      engine.reset();
      ms += CpuMs() - before;
      buffers_.out.clear();
      buffers_.in = {};
      all.push_back(ms);
    }
    fmt::print("| {:<62} | {:>6.2f} | {:>6.2f} | {} |\n", name, Median(all),
               Median(all) - SignatureMs(), outcome);
    std::fflush(stdout);
  }

  const testing::KeyPair server_ = authority.Issue(testing::ServerSpec());
  std::shared_ptr<const front::TlsContext> context_;
  const front::BufferMethod method_;
  front::TlsBuffers buffers_{};
};

std::shared_ptr<const ShownChain> Nine(const std::string& key) {
  return std::make_shared<ShownChain>(std::vector<std::string>(9, odd::CertificateWith(key)));
}

/// Certificates that each are signed by the next one's name, up to our authority's.
std::shared_ptr<const ShownChain> Ladder() {
  std::vector<std::string> chain;
  for (int i = 0; i < 9; ++i) {
    odd::Parts parts;
    parts.key = odd::RsaKey(4096, 64);
    parts.subject = odd::NameOf(i == 0 ? "a stranger" : "step " + std::to_string(i));
    parts.issuer = odd::NameOf(i == 8 ? "test authority" : "step " + std::to_string(i + 1));
    parts.extensions = odd::Extension("\x55\x1D\x13", der::Sequence(der::Element(0x01, "\xFF")));
    chain.push_back(odd::CertificateOf(parts));
  }
  return std::make_shared<ShownChain>(chain);
}

std::shared_ptr<const ShownChain> ManyNames(std::size_t count) {
  odd::Parts parts;
  parts.key = odd::Ed25519Key();
  std::string names;
  for (std::size_t i = 0; i < count; ++i) names += der::Element(0x82, "a");
  parts.extensions = odd::Extension("\x55\x1D\x11", der::Sequence(names));
  return std::make_shared<ShownChain>(std::vector<std::string>{odd::CertificateOf(parts)});
}

/// One whose issuer has our authority's name, so that its signature is verified.
testing::KeyPair NamedAsOurs() {
  return testing::TestAuthority("test authority").Issue(RobotSpec(kRuri));
}

void RunCertificates(Bench& bench) {
  const testing::TestAuthority other("a stranger");
  const MemoryTls::Options stranger{.identity = other.Issue(RobotSpec(kRuri)), .behind = nullptr};
  const auto behind = [&](std::shared_ptr<const ShownChain> chain) {
    MemoryTls::Options options = stranger;
    options.behind = std::move(chain);
    return options;
  };
  bench.Run("a robot of ours, P-256",
            {.identity = bench.authority.Issue(RobotSpec(kRuri)), .behind = nullptr});
  bench.Run("no certificate", {});
  bench.Run("one of another authority", stranger);
  bench.Run("one of an authority with the name of ours",
            {.identity = NamedAsOurs(), .behind = nullptr});
  bench.Run("9 behind it: P-521, compressed",
            behind(Nine(odd::NamedCurveKey(odd::Curve::kP521, odd::Point::kCompressed))));
  bench.Run("9 behind it: P-256, compressed",
            behind(Nine(odd::NamedCurveKey(odd::Curve::kP256, odd::Point::kCompressed))));
  bench.Run("9 behind it: RSA 4,096, exponent of 64 bits", behind(Nine(odd::RsaKey(4096, 64))));
  bench.Run("9 behind it: RSA-PSS 4,096, exponent of 64 bits",
            behind(Nine(odd::RsaPssKey(4096, 64))));
  bench.Run("9 behind it: Ed448", behind(Nine(odd::Ed448Key())));
  bench.Run("9 behind it whose names lead to our authority", behind(Ladder()));
  bench.Run("2,000 names", behind(ManyNames(2'000)));
  bench.Run("9 behind it: P-521, compressed, and 600 extensions",
            behind(std::make_shared<ShownChain>(odd::DearChain())));
  MemoryTls::Options dearest = behind(std::make_shared<ShownChain>(odd::DearChain()));
  dearest.groups = "P-384:P-256";
  // Three turns, so that all pieces are within what a handshake may bring.
  bench.Run("the same, asked for another key share, in 3 times 42 pieces", dearest, 42);
  bench.Run("10,000 names", behind(ManyNames(10'000)));
  bench.Run("50 behind it: curves that are written out",
            behind(std::make_shared<ShownChain>(
                std::vector<std::string>(50, odd::CertificateWith(odd::ExplicitCurveKey())))));
}

void RunHellos(Bench& bench) {
  MemoryTls::Options options{};
  options.groups = "P-384:P-256";
  bench.Run("asked for another key share (HelloRetryRequest)", options);
  for (const std::size_t bytes : {std::size_t{4000}, std::size_t{16'000}}) {
    const auto hello = [&](const std::string& name, Filler filler) {
      bench.RunHello(fmt::format("ClientHello of {} bytes: {}", bytes, name),
                     HelloWith(filler, bytes));
    };
    hello("key shares of one group", Filler::kKeyShares);
    hello("groups, and key shares of them", Filler::kGroupsAndKeyShares);
    hello("sessions to come back to", Filler::kSessions);
    hello("suites", Filler::kSuites);
    hello("signature algorithms", Filler::kAlgorithms);
    hello("extensions", Filler::kExtensions);
  }
}

void RunWith12(Bench& bench) {
  bench.Serve(config::TlsVersion::k12);
  for (const int version : {TLS1_2_VERSION, TLS1_3_VERSION}) {
    for (const char* group : {"X25519", "P-256", "P-384", "P-521"}) {
      MemoryTls::Options options{.identity = NamedAsOurs(), .behind = nullptr};
      options.version_max = version;
      // By TLS 1.2 the server's certificate needs its curve too.
      options.groups = std::string(group) + ":P-256";
      if (options.groups == "P-256:P-256") options.groups = "P-256";
      bench.Run(fmt::format("tls.min_version 1.2, TLS 1.{}, {}", version - TLS1_VERSION, group),
                options);
    }
  }
}

int Run() {
  Bench bench;
  bench.Serve(config::TlsVersion::k13);
  fmt::print("one signature by the server's key: {:.2f} ms\n\n", bench.SignatureMs());
  fmt::print("| a stranger's connection | CPU, ms | beyond a signature | outcome |\n");
  fmt::print("| --- | --- | --- | --- |\n");
  RunCertificates(bench);
  RunHellos(bench);
  RunWith12(bench);
  return 0;
}

}  // namespace
}  // namespace uplink::bench

int main() { return uplink::bench::Run(); }
