# PROGRAM --quick into FOLDER, in pieces: the chapter takes its place in a page that has others, says what it lacks, and
# gathers its pieces' figures from runs of their own.
cmake_minimum_required(VERSION 3.22)
file(REMOVE_RECURSE ${FOLDER})
file(WRITE ${FOLDER}/page.md "# Page\n\n## First\n\none\n\n## Sweeping volumes\n\nstale\n\n### Stale\n\n## Last\n\nthree\n")

function(measure pieces)
  execute_process(COMMAND ${PROGRAM} --quick --output ${FOLDER}/page.md --figures ${FOLDER}/figures.json --only ${pieces}
                  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "dfield_volumes --only ${pieces} ended with ${result}:\n${output}")
  endif()
endfunction()
function(require_match pattern why)
  file(READ ${FOLDER}/page.md page)
  if(NOT page MATCHES "${pattern}")
    message(FATAL_ERROR "${why}:\n${page}")
  endif()
endfunction()

measure(table2)
require_match("not measured" "missing figures are not said to be missing")
require_match("one\n\n## Sweeping volumes\n\n.*\n\n## Last\n\nthree\n$" "the chapter is not where it was")
measure(sphere,accuracy,memory,figure9)
require_match("Table 2" "the second run lost the first one's figures")

file(READ ${FOLDER}/page.md page)
string(REGEX MATCHALL "## Sweeping volumes" chapters "${page}")
list(LENGTH chapters count)
if(NOT count EQUAL 1 OR page MATCHES "[Ss]tale")
  message(FATAL_ERROR "the chapter was not replaced:\n${page}")
endif()
if(NOT EXISTS ${FOLDER}/page/volume_figure9.png)
  message(FATAL_ERROR "the picture of figure 9 was not written")
endif()

file(READ ${FOLDER}/figures.json json)
function(require_between low high)
  string(JSON value GET "${json}" ${ARGN})
  if(NOT value GREATER ${low} OR NOT value LESS ${high})
    message(FATAL_ERROR "${ARGN} is ${value}, not between ${low} and ${high}")
  endif()
endfunction()
require_between(0 10 table2 rows 0 seconds distance)
require_between(0.05 0.6 accuracy floor forms paper rms)
require_between(0 0.15 accuracy floor forms improved rms)
require_between(0 0.5 sphere rms) # of a radius of four voxels, its middle included
require_between(12 100 memory octants_bytes_a_voxel)

execute_process(COMMAND ${PROGRAM} --quick --output ${FOLDER}/page.md --only nonsense RESULT_VARIABLE result
                ERROR_VARIABLE output)
if(result EQUAL 0 OR NOT output MATCHES "nonsense")
  message(FATAL_ERROR "a piece of no such name was taken: ${result} ${output}")
endif()
