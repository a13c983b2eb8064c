# Every foreign library comes from Debian 12's packages (tools/dev/packages.txt).
find_package(Threads REQUIRED)
find_package(absl REQUIRED)
find_package(fmt REQUIRED)
find_package(Protobuf REQUIRED) # module mode: Debian's protobuf 3.21 ships no CMake configuration
find_package(CapnProto REQUIRED)
find_package(SQLite3 REQUIRED)
# CMake's own module asks for the server's headers, which a client does without.
find_package(PkgConfig REQUIRED)
pkg_check_modules(libmosquitto REQUIRED IMPORTED_TARGET libmosquitto) # of the synthetic fleet and a benchmark alone
pkg_check_modules(libpq REQUIRED IMPORTED_TARGET libpq)
pkg_check_modules(libsystemd REQUIRED IMPORTED_TARGET libsystemd)
pkg_check_modules(nghttp2 REQUIRED IMPORTED_TARGET libnghttp2)
find_package(OpenSSL REQUIRED)
find_package(ZLIB REQUIRED)
find_package(prometheus-cpp REQUIRED CONFIG) # its package states no version
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)
find_package(GTest REQUIRED)
if(UPLINK_WITH_GRPC)
  find_package(gRPC REQUIRED CONFIG)
endif()
# Beast and Asio are headers only; of Boost only JSON is linked.
find_path(UPLINK_BOOST_INCLUDE_DIR boost/beast/version.hpp REQUIRED)
find_package(boost_json 1.81 REQUIRED CONFIG)
