# PROGRAM --quick into FOLDER, in pieces: the chapter takes its place in a page that has others, says what it lacks, and
# gathers its pieces' figures from runs of their own.
include(${CMAKE_CURRENT_LIST_DIR}/page_checks.cmake)
file(REMOVE_RECURSE ${FOLDER})
set(page ${FOLDER}/page.md)
set(figures ${FOLDER}/figures.json)
file(WRITE ${page} "# Page\n\n## First\n\none\n\n## Sweeping volumes\n\nstale\n\n### Stale\n\n## Last\n\nthree\n")

set(chapter --quick --output ${page} --figures ${figures})
measure(${chapter} --only table2)
require_match(${page} "not measured" "missing figures are not said to be missing")
require_match(${page} "one\n\n## Sweeping volumes\n\n.*\n\n## Last\n\nthree\n$" "the chapter is not where it was")
measure(${chapter} --only sphere,accuracy,memory,figure9)
require_match(${page} "Table 2" "the second run lost the first one's figures")
require_no_match(${page} "[Ss]tale|## Sweeping volumes.*## Sweeping volumes" "the chapter was not replaced")
require_match(${page} "volume_figure9\\.png" "the picture of figure 9 is not on the page")
require_whole_page(${page} 1)

require_between(${figures} 0 10 table2 rows 0 seconds distance)
require_between(${figures} 0.05 0.6 accuracy floor forms paper rms)
require_between(${figures} 0 0.15 accuracy floor forms improved rms)
require_between(${figures} 0 0.5 sphere rms) # of a radius of four voxels, its middle included
require_between(${figures} 12 100 memory octants_bytes_a_voxel)

execute_process(COMMAND ${PROGRAM} ${chapter} --only nonsense RESULT_VARIABLE result ERROR_VARIABLE output)
if(result EQUAL 0 OR NOT output MATCHES "nonsense")
  message(FATAL_ERROR "a piece of no such name was taken: ${result} ${output}")
endif()
