# Linux on ARM64: clang 16 with Debian's C and C++ libraries for it, which prepare.sh brings
# with the rest; linked by LLVM's linker.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER clang-16)
set(CMAKE_CXX_COMPILER clang++-16)
set(CMAKE_C_COMPILER_TARGET aarch64-linux-gnu)
set(CMAKE_CXX_COMPILER_TARGET aarch64-linux-gnu)

cmake_path(SET cross NORMALIZE ${CMAKE_CURRENT_LIST_DIR}/../../build-cross)
set(CMAKE_SYSROOT ${cross}/arm64)
foreach(kind EXE SHARED)  # -s: without names
  set(CMAKE_${kind}_LINKER_FLAGS_INIT "-fuse-ld=lld -static-libstdc++ -static-libgcc -s")
endforeach()
set(CMAKE_FIND_ROOT_PATH ${cross}/arm64-libraries ${cross}/headers/usr ${CMAKE_SYSROOT})
foreach(kind LIBRARY INCLUDE PACKAGE)
  set(CMAKE_FIND_ROOT_PATH_MODE_${kind} ONLY)
endforeach()
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L ${CMAKE_SYSROOT})
