# Bad input ends with exit code 2 and a message that names it, before any scene is run.
#   cmake -DPROGRAM=.../peers -DFOLDER=... -P peers_bad_input.cmake
cmake_minimum_required(VERSION 3.25)

function(refuses message)
  execute_process(COMMAND ${PROGRAM} ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT code EQUAL 2)
    message(SEND_ERROR "peers ${ARGN}: exit code ${code}, not 2")
  endif()
  if(NOT "${out}${err}" MATCHES "${message}")
    message(SEND_ERROR "peers ${ARGN}: says \"${out}${err}\", not \"${message}\"")
  endif()
endfunction()

refuses("GROUP is required")
refuses("no group is called \"stop\"" stop)
refuses("no row of the group matches \"pile_sand\"" step pile_sand)
refuses("no row of the group matches \"balls/turning\"" sweeps balls/turning)
refuses("missing/rows.json: cannot be written" step --json ${FOLDER}/missing/rows.json)
refuses("not expected" step --fast)

# What was there stays as it was where nothing was run.
file(WRITE ${FOLDER}/peers_rows.json "kept")
refuses("no row" step pile_sand --json ${FOLDER}/peers_rows.json)
file(READ ${FOLDER}/peers_rows.json kept)
if(NOT kept STREQUAL "kept")
  message(SEND_ERROR "a refused run changed its report file")
endif()
