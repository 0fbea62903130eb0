# Install rules, the CMake package dfield (target dfield::dfield) and dfield.pc.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/dfield)
install(TARGETS dfield EXPORT dfield-targets
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT development
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY runtime/include/dfield DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
        FILES_MATCHING PATTERN *.h PATTERN *.hpp)
install(FILES LICENSE format/FORMAT.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)
if(TARGET dfield_cli)
  # The command finds libdfield.so beside itself wherever the prefix is moved.
  file(RELATIVE_PATH bin_to_lib ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
  set_target_properties(dfield_cli PROPERTIES INSTALL_RPATH "$ORIGIN/${bin_to_lib}")
  install(TARGETS dfield_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
endif()

install(EXPORT dfield-targets NAMESPACE dfield:: DESTINATION ${package_folder} COMPONENT development)
configure_package_config_file(runtime/cmake/dfieldConfig.cmake.in ${PROJECT_BINARY_DIR}/dfieldConfig.cmake
                              INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
# Before 1.0 every minor version may change the ABI.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/dfieldConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/dfieldConfig.cmake ${PROJECT_BINARY_DIR}/dfieldConfigVersion.cmake
              scripts/cmake/dfield-libraries.cmake
        DESTINATION ${package_folder} COMPONENT development)

# Whoever links the static library needs zstd, Highway and the C++ library too, the C programmer above all.
set(pc_requires "")
set(pc_libs "-L\${libdir} -ldfield")
set(pc_cflags "-I\${includedir}")
if(NOT DFIELD_BUILD_SHARED)
  set(pc_requires "libzstd libhwy")
  foreach(library IN LISTS CMAKE_CXX_IMPLICIT_LINK_LIBRARIES)
    if(library MATCHES "^(stdc\\+\\+|c\\+\\+|m)$")
      string(APPEND pc_libs " -l${library}")
    endif()
  endforeach()
  string(APPEND pc_cflags " -DDFIELD_STATIC")
endif()
file(RELATIVE_PATH pc_prefix ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" pc_prefix "${pc_prefix}")
configure_file(runtime/cmake/dfield.pc.in ${PROJECT_BINARY_DIR}/dfield.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/dfield.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
