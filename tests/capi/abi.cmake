# The binary interface of lobe_c.h is the committed one: -DHEADER=… -DCOMPILER=… -DABIDIFF=… -DABIDW=…
# -DEXPECTED=… -DFOLDER=…. The header's functions, with empty bodies, are compiled with debug information;
# abidiff compares their types with the description in EXPECTED. With -DRENEW=ON that is written anew.
if(NOT ABIDIFF OR NOT ABIDW)
  message("skipped: needs abidiff and abidw of the package abigail-tools; ./dev test installs it")
  return()
endif()
file(READ ${HEADER} header)
string(REGEX REPLACE "/\\*([^*]|\\*+[^*/])*\\*+/" "" header "${header}")
string(REGEX MATCHALL "LOBE_API (lobe|const|void|uint)[^;#]+" declarations "${header}")
set(source "#include <lobe_c.h>\n")
foreach(declaration ${declarations})
  string(REGEX REPLACE "^LOBE_API " "" declaration "${declaration}")
  if(declaration MATCHES "^void ")
    string(APPEND source "${declaration} {}\n")
  else()
    string(APPEND source "${declaration} { return 0; }\n")
  endif()
endforeach()
file(WRITE ${FOLDER}/abi.c "${source}")
get_filename_component(include ${HEADER} DIRECTORY)
set(library ${FOLDER}/liblobe_c_abi.so)
# The description must not name the folder: the compiler is told the source's name alone.
execute_process(COMMAND ${COMPILER} -std=c99 -g -O0 -w -shared -fPIC -I ${include} abi.c -o ${library}
  WORKING_DIRECTORY ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
if(RENEW)
  execute_process(COMMAND ${ABIDW} --no-show-locs --no-corpus-path --no-comp-dir-path --no-elf-needed --no-architecture
    --out-file ${EXPECTED} ${library} COMMAND_ERROR_IS_FATAL ANY)
  return()
endif()
# It tells a change that old callers survive (4) from one that they do not (8).
execute_process(COMMAND ${ABIDIFF} --no-show-locs --no-architecture ${EXPECTED} ${library}
  RESULT_VARIABLE status OUTPUT_VARIABLE report)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${report}\nabidiff: ${status}. If old callers still work, renew ${EXPECTED} with the target "
    "renew_c_abi. If they do not, raise LOBE_ABI_VERSION and the library's SOVERSION first.")
endif()
