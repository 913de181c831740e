# Links of installed documents, run at installation with folder (of the documents) and data (share/stribeck), both behind DESTDIR: what is
# installed elsewhere is linked there, and a link to the sources, which are not installed, becomes its text.
file(GLOB_RECURSE documents "${folder}/*.md")
foreach(document IN LISTS documents)
  get_filename_component(here "${document}" DIRECTORY)
  file(RELATIVE_PATH to_data "${here}" "${data}")
  file(READ "${document}" text)
  foreach(behind "/[^)]*" "")
    string(REGEX REPLACE "\\]\\((\\.\\./)*((examples|machines|controllers)${behind})\\)" "](${to_data}/\\2)" text "${text}")
    string(REGEX REPLACE "\\[([^][]*)\\]\\((\\.\\./)*(src|tests|apps|tools|bench|hal|capi|python|cmake|\\.ci)${behind}\\)" "\\1" text "${text}")
  endforeach()
  string(REGEX REPLACE "\\[([^][]*)\\]\\((\\.\\./)*(CONTRIBUTING|LICENSE)[^)]*\\)" "\\1" text "${text}")
  file(WRITE "${document}" "${text}")
endforeach()
