# Writes the source that tells version and commit (server/config/version.cc.in), at build time:
# cmake -DSOURCE=TREE -DVERSION=0.1.0 -DCOMMIT=ID -DTEMPLATE=FILE -DOUTPUT=FILE -P version.cmake.
# Without an id git is asked for it.
if(NOT COMMIT)
  # A tree that lies inside another repository is not a commit of that one.
  execute_process(COMMAND git -C "${SOURCE}" rev-parse --show-prefix
                  RESULT_VARIABLE failed OUTPUT_VARIABLE prefix OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(failed EQUAL 0 AND prefix STREQUAL "")
    execute_process(COMMAND git -C "${SOURCE}" rev-parse --short=8 HEAD
                    OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  endif()
endif()
if(NOT COMMIT)
  set(COMMIT unknown)
endif()
if(NOT COMMIT MATCHES "^[0-9A-Za-z._+~-]+$")
  message(FATAL_ERROR "UPLINK_COMMIT is \"${COMMIT}\": letters, digits and . _ + ~ - alone")
endif()
configure_file("${TEMPLATE}" "${OUTPUT}" @ONLY)
file(TOUCH "${OUTPUT}")
