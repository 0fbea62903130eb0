# The imported targets dfield::zstd and dfield::hwy (Highway). Used by the build and, installed beside dfieldConfig.cmake,
# by whoever links the static library. The libraries' own CMake packages are missing on many systems, so headers and
# libraries are searched for.
function(dfield_imported_library name header)
  if(TARGET dfield::${name})
    return()
  endif()
  string(TOUPPER DFIELD_${name} variable)
  find_path(${variable}_INCLUDE ${header} DOC "Folder of ${header}")
  find_library(${variable}_LIBRARY NAMES ${ARGN} DOC "The ${name} library")
  mark_as_advanced(${variable}_INCLUDE ${variable}_LIBRARY)
  if(${variable}_INCLUDE AND ${variable}_LIBRARY)
    add_library(dfield::${name} UNKNOWN IMPORTED)
    set_target_properties(dfield::${name} PROPERTIES IMPORTED_LOCATION "${${variable}_LIBRARY}"
                          INTERFACE_INCLUDE_DIRECTORIES "${${variable}_INCLUDE}")
  endif()
endfunction()
dfield_imported_library(zstd zstd.h zstd zstd_static)
dfield_imported_library(hwy hwy/highway.h hwy)
