# An overlay port of this source tree: vcpkg install lobe --overlay-ports=packaging/vcpkg
cmake_path(SET SOURCE_PATH NORMALIZE "${CMAKE_CURRENT_LIST_DIR}/../../..")
vcpkg_check_features(OUT_FEATURE_OPTIONS features
  FEATURES
    metis LOBE_METIS
    tbb LOBE_TBB)
vcpkg_cmake_configure(SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    ${features}
    -DLOBE_BENCHMARKS=OFF
    -DLOBE_C=OFF
    -DLOBE_CHOLMOD=OFF
    -DLOBE_EXAMPLES=OFF
    -DLOBE_MESHING=OFF
    -DLOBE_PETSC=OFF
    -DLOBE_PICTURES=OFF
    -DLOBE_PYTHON=OFF
    -DLOBE_TESTS=OFF
    -DLOBE_VIEW=OFF
    -DCMAKE_COMPILE_WARNING_AS_ERROR=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/lobe)
vcpkg_copy_tools(TOOL_NAMES lobe AUTO_CLEAN)
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
