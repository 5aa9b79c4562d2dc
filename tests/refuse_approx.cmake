# cmake -DFOLDER=tests -P refuse_approx.cmake: fails where a test compares by a bare doctest::Approx, which is
# absolute where values are far below 1 (near.h), and names file and line.
set(excluded "^near\\.h$")
file(GLOB_RECURSE files RELATIVE ${FOLDER} ${FOLDER}/*.cpp ${FOLDER}/*.h)
set(found)
foreach(file IN LISTS files)
  file(READ ${FOLDER}/${file} text)
  if(file MATCHES "${excluded}" OR NOT text MATCHES "Approx")
    continue()
  endif()
  string(REGEX REPLACE "[][;\\]" " " text "${text}")  # what means something to lists
  string(REPLACE "\n" ";." lines ".${text}")
  set(number 0)
  foreach(line IN LISTS lines)
    math(EXPR number "${number} + 1")
    if(line MATCHES "[^A-Za-z]Approx")
      string(APPEND found "${FOLDER}/${file}:${number}: a bare Approx; use near(value, relative) of tests/near.h\n")
    endif()
  endforeach()
endforeach()
if(found)
  message("${found}")  # as it stands: an error would be wrapped
  message(FATAL_ERROR "bare comparisons")
endif()
