# Libraries that have no CMake file, or none that can be relied on. The package's config file looks for them
# in the same way, so that no path of the machine it was built on is in it.

# lobe_find_library(METIS metis.h metis): the target METIS::METIS and METIS_FOUND, unless header or library is
# missing. What follows are folders in which the header may stand.
macro(lobe_find_library name header library)
  find_path(LOBE_${name}_INCLUDE_DIR ${header} PATH_SUFFIXES ${ARGN})
  find_library(LOBE_${name}_LIBRARY ${library})
  mark_as_advanced(LOBE_${name}_INCLUDE_DIR LOBE_${name}_LIBRARY)
  set(${name}_FOUND FALSE)
  if(LOBE_${name}_INCLUDE_DIR AND LOBE_${name}_LIBRARY)
    set(${name}_FOUND TRUE)
  endif()
  if(${name}_FOUND AND NOT TARGET ${name}::${name})
    add_library(${name}::${name} UNKNOWN IMPORTED)
    set_target_properties(${name}::${name} PROPERTIES
      IMPORTED_LOCATION ${LOBE_${name}_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${LOBE_${name}_INCLUDE_DIR})
  endif()
endmacro()
# What a static library of that kind needs as well, where it is to be found: METIS 5.2 is split into METIS and
# GKlib.
macro(lobe_also_link name library)
  find_library(LOBE_${library}_LIBRARY ${library})
  mark_as_advanced(LOBE_${library}_LIBRARY)
  if(TARGET ${name}::${name} AND LOBE_${library}_LIBRARY)
    set_target_properties(${name}::${name} PROPERTIES INTERFACE_LINK_LIBRARIES ${LOBE_${library}_LIBRARY})
  endif()
endmacro()
