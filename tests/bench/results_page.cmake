# PROGRAM --quick on the models in MODELS, into FOLDER: limits, figures 2 and 4 to 8, and the paper's lookup; a picture
# for each figure but 4, and for several objects.
include(${CMAKE_CURRENT_LIST_DIR}/page_checks.cmake)
file(REMOVE_RECURSE ${FOLDER})
set(page ${FOLDER}/page.md)
measure(--quick --models ${MODELS} --output ${page})
require_whole_page(${page} 6)
file(STRINGS ${page} headings REGEX "^## " ENCODING UTF-8)
file(STRINGS ${page} rows REGEX "^\\|" ENCODING UTF-8)
list(LENGTH headings heading_count)
list(LENGTH rows row_count)
if(heading_count LESS 8 OR row_count LESS 50)
  message(FATAL_ERROR "the page has ${heading_count} chapters and ${row_count} rows only")
endif()
