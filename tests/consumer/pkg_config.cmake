# cmake -DPKG_CONFIG=… -DCOMPILER=… -DFLAGS=list -DPREFIX=… -DLIBDIR=… -DSOURCE=main.c -DSCENE=… -DFOLDER=…
# -P pkg_config.cmake: a compiler and pkg-config alone build a client of the installed lobe_c, also after the
# prefix was moved.
cmake_minimum_required(VERSION 3.25)
set(moved ${FOLDER}/moved)
file(REMOVE_RECURSE ${moved})
file(COPY ${PREFIX}/ DESTINATION ${moved} PATTERN "*.a" EXCLUDE PATTERN "bin" EXCLUDE PATTERN "share" EXCLUDE)
set(ENV{PKG_CONFIG_PATH} ${moved}/${LIBDIR}/pkgconfig)
function(ask)  # argument of pkg-config…
  execute_process(COMMAND ${PKG_CONFIG} ${ARGN} lobe_c OUTPUT_VARIABLE answer OUTPUT_STRIP_TRAILING_WHITESPACE
    COMMAND_ERROR_IS_FATAL ANY)
  set(answer ${answer} PARENT_SCOPE)
endfunction()
ask(--variable=libdir)
set(libraries ${answer})
ask(--cflags --libs)
separate_arguments(flags UNIX_COMMAND "${answer}")
execute_process(COMMAND ${COMPILER} -std=c99 ${SOURCE} ${FLAGS} ${flags} -Wl,-rpath,${libraries} -o ${FOLDER}/client
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${FOLDER}/client ${SCENE} COMMAND_ERROR_IS_FATAL ANY)
