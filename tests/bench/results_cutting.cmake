# PROGRAM --chapter cutting --quick into FOLDER, in pieces: figures that make sense, identities that hold, pictures.
include(${CMAKE_CURRENT_LIST_DIR}/page_checks.cmake)
file(REMOVE_RECURSE ${FOLDER})
set(page ${FOLDER}/page.md)
set(figures ${FOLDER}/figures.json)
file(WRITE ${page} "# Page\n")

set(chapter --chapter cutting --quick --models ${MODELS} --output ${page} --figures ${figures})
measure(${chapter} --only haze,engine)
measure(${chapter} --only skeleton,moving,approximate,accuracy,jitter,surfaces,figure9)

require_whole_page(${page} 3)
foreach(part "Table 2" "Table 3" "Table 4" "Figure 10" "Tables 5 and 6" "jitter" "common mistakes" "left out: beetle")
  require_match(${page} "${part}" "the page lacks '${part}'")
endforeach()
require_no_match(${page} "differ\\.\\*\\*" "contextual and local ambient occlusion differ")
foreach(picture surfaces figure9 figure12)
  require_match(${page} "cutting_${picture}\\.png" "the picture of ${picture} is not on the page")
endforeach()

require_on(${figures} engine identical)
require_on(${figures} skeleton identical)
require_on(${figures} moving vessels identical)
require_between(${figures} 0 100 engine rays 54 recomputed)
require_between(${figures} 14.9 15 engine dilated) # as large as dilates the paper's share
require_between(${figures} 2 200 engine memory) # a small volume weighs less than its borders and the mesh
require_between(${figures} 0 0.01 approximate skeleton rms)
require_between(${figures} 0 0.05 accuracy worst 54)
require_between(${figures} 0.002 0.5 accuracy worst 6)
