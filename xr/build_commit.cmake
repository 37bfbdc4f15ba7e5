# Writes OUT with the commit of SOURCE, touching it only when it changes, so that nothing is rebuilt for nothing.
find_program(GIT git)
set(commit "")
if(GIT)
  # The tree may belong to another user inside a container.
  execute_process(COMMAND ${GIT} -c safe.directory=* -C ${SOURCE} describe --always --dirty --abbrev=10
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT commit)
  set(commit "commit unknown")
endif()
set(text "#define PROBEWALK_COMMIT \"${commit}\"\n")
set(old "")
if(EXISTS ${OUT})
  file(READ ${OUT} old)
endif()
if(NOT old STREQUAL text)
  file(WRITE ${OUT} "${text}")
endif()
