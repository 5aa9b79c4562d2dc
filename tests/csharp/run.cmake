# cmake -DMCS=… -DMONO=… -DSIZES=program -DLIBRARY=liblobe_c.so -DROOT=project -DFOLDER=… -P run.cmake:
# compiles the C# sources with the example for Unity and the driver, and runs the driver.
if(NOT MCS OR NOT MONO)
  message("skipped: needs mono-mcs and mono-runtime; ./dev test installs them")
  return()
endif()
file(MAKE_DIRECTORY ${FOLDER})
execute_process(COMMAND ${SIZES} OUTPUT_FILE ${FOLDER}/sizes.txt COMMAND_ERROR_IS_FATAL ANY)
file(GLOB sources ${ROOT}/capi/csharp/*.cs ${ROOT}/examples/unity/*.cs ${ROOT}/tests/csharp/*.cs)
execute_process(COMMAND ${MCS} -warnaserror -out:${FOLDER}/driver.exe ${sources} COMMAND_ERROR_IS_FATAL ANY)
cmake_path(GET LIBRARY PARENT_PATH library_folder)
set(ENV{LD_LIBRARY_PATH} ${library_folder})
execute_process(COMMAND ${MONO} ${FOLDER}/driver.exe ${ROOT}/data ${FOLDER} ${FOLDER}/sizes.txt
  COMMAND_ERROR_IS_FATAL ANY)
