# Debian packages by CPack: `./dev package`. Each folder names the component that its files belong to.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the authors of lobe <lobe@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENTS_ALL programs development c mesher cholmod python)
if(LOBE_PETSC)
  list(APPEND CPACK_COMPONENTS_ALL petsc)
endif()

function(lobe_package component name section licence summary)  # further variables of CPack and their values…
  install(FILES ${licence} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} RENAME copyright COMPONENT ${component})
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_COMPONENT_${key}_DESCRIPTION ${summary} PARENT_SCOPE)
  while(ARGN)
    list(POP_FRONT ARGN variable value)
    set(CPACK_DEBIAN_${key}_PACKAGE_${variable} ${value} PARENT_SCOPE)
  endwhile()
endfunction()
lobe_package(programs lobe science LICENSE "Organs simulated in real time: programs, page and pictures"
  RECOMMENDS "lobe-mesh, xvfb")
lobe_package(development liblobe-dev libdevel LICENSE "Organs simulated in real time: C++ library"
  DEPENDS "liblobe-c1 (= ${PROJECT_VERSION}), libeigen3-dev, libtbb-dev, libmetis-dev, libpugixml-dev, zlib1g-dev")
lobe_package(c liblobe-c1 libs LICENSE "Organs simulated in real time: library for engines, in C")
lobe_package(mesher lobe-mesh science meshing/LICENSE "Organs simulated in real time: from a surface to tetrahedra (GPL-3+)")
lobe_package(cholmod lobe-cholmod science cholmod/LICENSE "Organs simulated in real time: with CHOLMOD as sparse solver (GPL-2+)")
lobe_package(petsc lobe-petsc science LICENSE "Organs simulated in real time: static solutions in parts (PETSc, MPI)"
  RECOMMENDS "openmpi-bin")
lobe_package(python python3-lobe python LICENSE "Organs simulated in real time: Python package"
  DEPENDS "python3 (>= 3.11), python3 (<< 3.12), python3-numpy" RECOMMENDS "lobe, lobe-mesh")
include(CPack)
