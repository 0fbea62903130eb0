# The imported target dfield::zstd. Used by the build and, installed beside dfieldConfig.cmake, by whoever links the
# static library. zstd's own CMake package is missing on many systems, so header and library are searched for.
if(NOT TARGET dfield::zstd)
  find_path(DFIELD_ZSTD_INCLUDE zstd.h DOC "Folder of zstd.h")
  find_library(DFIELD_ZSTD_LIBRARY NAMES zstd zstd_static DOC "The zstd library")
  mark_as_advanced(DFIELD_ZSTD_INCLUDE DFIELD_ZSTD_LIBRARY)
  if(DFIELD_ZSTD_INCLUDE AND DFIELD_ZSTD_LIBRARY)
    add_library(dfield::zstd UNKNOWN IMPORTED)
    set_target_properties(dfield::zstd PROPERTIES IMPORTED_LOCATION "${DFIELD_ZSTD_LIBRARY}"
                          INTERFACE_INCLUDE_DIRECTORIES "${DFIELD_ZSTD_INCLUDE}")
  endif()
endif()
