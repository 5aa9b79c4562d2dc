# Windows on x86-64: clang 16 with the headers and libraries of Debian's g++-mingw-w64-x86-64-posix. What is
# built needs no other DLL than Windows' own. prepare.sh brings the rest.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(triple x86_64-w64-mingw32)
set(CMAKE_C_COMPILER clang-16)
set(CMAKE_CXX_COMPILER clang++-16)
set(CMAKE_C_COMPILER_TARGET ${triple})
set(CMAKE_CXX_COMPILER_TARGET ${triple})
set(CMAKE_RC_COMPILER ${triple}-windres)

# clang looks for no GCC called "12-posix"; its thread-local data must be that of GCC's C++ library.
set(gcc /usr/lib/gcc/${triple}/12-posix)
set(flags "-femulated-tls -Wno-unused-command-line-argument -B${gcc} -L${gcc} -L/usr/${triple}/lib")
set(CMAKE_C_FLAGS_INIT "${flags}")
set(CMAKE_CXX_FLAGS_INIT "${flags} -nostdinc++ -isystem ${gcc}/include/c++ \
-isystem ${gcc}/include/c++/${triple} -isystem ${gcc}/include/c++/backward")
foreach(kind EXE SHARED)
  set(CMAKE_${kind}_LINKER_FLAGS_INIT "-static -s")  # -s: without names
endforeach()
set(libraries "-Wl,--start-group -lstdc++ -lgcc_eh -lpthread -lgcc -lmingwex -lmsvcrt -lkernel32 -lmoldname \
-ladvapi32 -lshell32 -luser32 -lmingw32 -Wl,--end-group")
set(CMAKE_CXX_STANDARD_LIBRARIES "${libraries}" CACHE STRING "")

cmake_path(SET cross NORMALIZE ${CMAKE_CURRENT_LIST_DIR}/../../build-cross)
set(CMAKE_FIND_ROOT_PATH ${cross}/windows-libraries ${cross}/headers/usr /usr/${triple})
foreach(kind LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_${kind} ONLY)
endforeach()
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_CROSSCOMPILING_EMULATOR wine64)
