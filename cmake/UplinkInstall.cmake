# What `cmake --install` puts where. The unit and the programs name /usr and /etc, so that is the
# default; ./dev package installs below a folder of its own.
if(CMAKE_INSTALL_PREFIX_INITIALIZED_TO_DEFAULT)
  set_property(CACHE CMAKE_INSTALL_PREFIX PROPERTY VALUE /usr)
endif()
if(UPLINK_SANITIZE)
  return()
endif()
set(deploy "${PROJECT_SOURCE_DIR}/deploy")
set(handbook share/doc/uplinkd)

install(TARGETS uplinkd uplinkctl uplink-fleet RUNTIME DESTINATION bin)
install(FILES "${deploy}/systemd/uplinkd.service" DESTINATION lib/systemd/system)
install(FILES "${deploy}/systemd/uplinkd.sysusers.conf" DESTINATION lib/sysusers.d RENAME uplinkd.conf)
install(FILES "${deploy}/systemd/uplinkd.tmpfiles.conf" DESTINATION lib/tmpfiles.d RENAME uplinkd.conf)
# A file that an operator edited stays.
install(CODE "
  if(NOT EXISTS \"\$ENV{DESTDIR}/etc/uplinkd/uplinkd.toml\")
    file(INSTALL \"${deploy}/uplinkd.toml\" DESTINATION /etc/uplinkd)
  endif()")
install(FILES "${deploy}/prometheus/alerts.rules.yml" "${deploy}/prometheus/recording.rules.yml"
              "${deploy}/prometheus/prometheus.yml" DESTINATION share/uplinkd/prometheus)
install(DIRECTORY "${deploy}/grafana/" DESTINATION share/uplinkd/grafana FILES_MATCHING PATTERN "*.json")
install(DIRECTORY "${CMAKE_BINARY_DIR}/manual/" DESTINATION share OPTIONAL)
install(FILES README.md CHANGELOG.md LICENSE SECURITY.md DESTINATION "${handbook}")
install(DIRECTORY docs DESTINATION "${handbook}" FILES_MATCHING REGEX "\\.(md|svg|yaml)$")
install(FILES "${deploy}/systemd/credentials.conf" DESTINATION "${handbook}/examples")
install(DIRECTORY "${deploy}/mosquitto" "${deploy}/proxy" DESTINATION "${handbook}/examples")
