# Writes build_info.cc from its template, with the commit of the source tree; run at every build, touches the file only
# when something changed. Arguments: SOURCE, TEMPLATE, RESULT, and the versions the template names.
# A checkout may be somebody else's: git looks at it all the same.
execute_process(COMMAND git -c safe.directory=${SOURCE} describe --always --dirty WORKING_DIRECTORY ${SOURCE}
                OUTPUT_VARIABLE GIT_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(GIT_COMMIT "unknown")
endif()
configure_file(${TEMPLATE} ${RESULT} @ONLY)
