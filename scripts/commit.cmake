# Writes FILE with the commit of SOURCE, or none; leaves it alone where it says so already, so that nothing is compiled anew.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty=+ --abbrev=10 --exclude=* OUTPUT_VARIABLE commit RESULT_VARIABLE status
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT status EQUAL 0 OR NOT EXISTS ${SOURCE}/.git)
  set(commit "")
endif()
set(text "namespace fissure::app {\nextern char const* const commit;\nchar const* const commit = \"${commit}\";\n}\n")
if(EXISTS ${FILE})
  file(READ ${FILE} before)
endif()
if(NOT text STREQUAL "${before}")
  file(WRITE ${FILE} "${text}")
endif()
