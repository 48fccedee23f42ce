# Writes build_info.cc from its template, with the commit of the source tree; run at every build, touches the file only
# when something changed. Arguments: SOURCE, TEMPLATE, RESULT, and the versions the template names.
execute_process(COMMAND git describe --always --dirty WORKING_DIRECTORY ${SOURCE}
                OUTPUT_VARIABLE GIT_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(GIT_COMMIT "unknown")
endif()
configure_file(${TEMPLATE} ${RESULT} @ONLY)
