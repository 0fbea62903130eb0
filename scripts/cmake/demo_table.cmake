# Writes FOLDER/NAME.md, the demo's figures as a table, from the JSON reports there, and prints it.
file(READ ${FOLDER}/${NAME}-bake.json bake)
set(table "")

function(row what json key unit)
  # The report's own digits: string(JSON) would print 17 of them.
  if(NOT ${json} MATCHES "\"${key}\": *([-+.0-9e]+)")
    message(FATAL_ERROR "no ${key} in the report ${json}")
  endif()
  set(table "${table}| ${what} | ${CMAKE_MATCH_1}${unit} |\n" PARENT_SCOPE)
endfunction()

row("triangles" bake triangles "")
row("positional samples" bake positions "")
row("rays baked" bake rays "")
row("bake" bake seconds " s")
row("bake speed" bake mrays_per_s " Mray/s")
row("file" bake file_bytes " bytes")
foreach(scene IN ITEMS corner corner-contact)
  file(READ ${FOLDER}/${NAME}-${scene}.json compare)
  row("${scene}: RMS error against ray casting" compare rms_grey " of 255 greys")
  row("${scene}: lookup" compare lookup_mrays_per_s " Mray/s")
  row("${scene}: Embree" compare embree_mrays_per_s " Mray/s")
  row("${scene}: lookup against Embree" compare speedup " times")
endforeach()
set(table "| ${NAME} | |\n|---|---|\n${table}")
file(WRITE ${FOLDER}/${NAME}.md "${table}")
message("\n${table}\nIn ${FOLDER}/: ${NAME}.dfield, ${NAME}.md, ${NAME}-corner.png, ${NAME}-corner-contact.png"
        " (ray casting, lookup, difference x5)")
