# Fails if an object of the wide kernels defines a weak symbol: the linker could take that copy, which older
# processors cannot run, for all of the program.
string(REPLACE "," ";" OBJECTS "${OBJECTS}")
foreach(object ${OBJECTS})
  execute_process(COMMAND ${NM} --defined-only ${object} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  if(NOT symbols MATCHES "(single|double|self)_[a-z_]*kernels")
    message(FATAL_ERROR "${object} does not hold the kernels")
  endif()
  if(symbols MATCHES "[^\n]* [WVwvu] [^\n]*")
    message(FATAL_ERROR "${object} defines a weak symbol: ${CMAKE_MATCH_0}")
  endif()
endforeach()
