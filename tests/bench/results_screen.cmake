# PROGRAM --only screen --quick into FOLDER: the chapter takes its place in a page that has others, every link leads to
# a picture, and no figure is missing.
include(${CMAKE_CURRENT_LIST_DIR}/page_checks.cmake)
file(REMOVE_RECURSE ${FOLDER})
set(page ${FOLDER}/page.md)
file(WRITE ${page} "# Page\n\n## First\n\none\n\n## Screen space\n\nstale\n\n## Last\n\nthree\n")
measure(--quick --only screen --output ${page} --models ${MODELS})

foreach(pattern IN ITEMS "one\n\n## Screen space\n\n.*\n\n## Last\n\nthree\n$" "\\| screen space \\| asked \\|"
        "### Error against samples" "\\| disk \\|" "### With displacement fields")
  require_match(${page} "${pattern}" "the page lacks '${pattern}'")
endforeach()
require_no_match(${page} "stale" "the chapter was not replaced")
require_whole_page(${page} 7)
